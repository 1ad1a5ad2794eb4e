#pragma once
/// Machine files with ugly numbers to calibrate, and the modes they have.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

/// A machine of equal legs and an unround platform, every number drawn anew.
inline std::string random_machine_text(Random& random, bool gravity) {
  const double size = random.log_uniform(0.7, 2.9);
  const double mass = random.log_uniform(300.0, 5000.0) * size;
  const double height = random.uniform(1.25, 1.55) * size;
  const double radius = random.uniform(0.55, 0.75) * size, gyration = 0.5 * radius;
  const double I = mass * gyration * gyration;
  const double rod = 0.55 * height, sleeve = 0.85 * height;
  const double leg_mass = 0.012 * mass;
  return fmt::format(
      R"(name = "random"
[environment]
gravity = {}
[base.joints]
circle = {{ radius = {}, spacing = {} }}
[platform.joints]
circle = {{ radius = {}, spacing = {} }}
[platform]
mass = {}
mass_center = [0, 0, {}]
inertia = {{ xx = {}, yy = {}, zz = {} }}
[legs]
added_axial_inertia = {}
[legs.case]
mass = {}
mass_center = {}
transverse_inertia = {}
[legs.rod]
length = {}
mass = {}
mass_center = {}
transverse_inertia = {}
[legs.guide_sleeve]
position = {}
stiffness = {}
damping = {}
[legs.oil_spring]
stiffness = {}
damping = {}
[poses.neutral]
position = [0, 0, {}]
[poses.shifted]
position = [{}, {}, {}]
rotation = [{}, {}, {}]
)",
      gravity ? 9.80665 : 0.0, random.uniform(0.85, 1.05) * size, random.uniform(0.2, 0.3) * size,
      radius, random.uniform(0.2, 0.3) * radius, mass, random.uniform(-0.2, 0.2) * size,
      I * random.uniform(0.8, 1.0), I * random.uniform(1.05, 1.3), I * random.uniform(1.3, 1.7),
      0.3 * leg_mass, leg_mass, random.uniform(0.3, 0.4) * height,
      0.08 * leg_mass * height * height, rod, 0.6 * leg_mass, random.uniform(0.4, 0.55) * rod,
      0.03 * leg_mass * height * height, sleeve, random.log_uniform(150.0, 900.0) * mass,
      0.3 * mass, random.log_uniform(3e3, 9e3) * mass, 1.7 * mass, height, 0.08 * size,
      -0.06 * size, height * 1.03, random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
      random.uniform(-0.2, 0.2));
}

inline model::MachineFile machine_file(const std::string& text,
                                       const std::vector<std::string>& overrides = {}) {
  return model::parse_machine(text, "test.toml", overrides, kinematics::check_machine);
}

/// Targets at one of its poses: all modes of the machine, those that mainly move the platform with
/// their direction.
inline std::vector<observation::ModeTarget> modes_of(const model::MachineFile& file,
                                                     const std::string& pose_name,
                                                     dynamics::ModelKind kind,
                                                     double relative_deviation = 1e-3) {
  std::vector<observation::ModeTarget> targets;
  for (const auto& pose : file.machine.poses) {
    if (pose.name != pose_name) continue;
    const auto model = dynamics::linear_model(file.machine, pose.X_BP, kind);
    const auto modes = modal::normal_modes(model);
    const auto shares = modal::energy_shares(model, modes.shapes);
    for (int k = 0; k < modes.size(); ++k) {
      observation::ModeTarget target{.name = fmt::format("{} {}", pose_name, k + 1),
                                     .pose = pose_name,
                                     .omega = modes.omega(k),
                                     .deviation = relative_deviation * modes.omega(k)};
      Eigen::Index direction = 0;
      const double largest = shares[static_cast<std::size_t>(k)].platform.maxCoeff(&direction);
      if (largest > 0.6) target.direction = static_cast<int>(direction);
      targets.push_back(target);
    }
  }
  return targets;
}

/// Free parameters at these paths, starting from the values in the file.
/// The machine of a file with the numbers at these paths to vary, one by one.
inline calibration::VariedMachine varied(const model::MachineFile& file,
                                         const std::vector<std::string>& paths) {
  calibration::VariedMachine machine{.machine = file.machine};
  for (const auto& path : paths) machine.parameters.push_back({find_number(file, path).value().id});
  return machine;
}

inline std::vector<calibration::FreeParameter> free_paths(const std::vector<std::string>& paths) {
  std::vector<calibration::FreeParameter> free;
  for (const auto& path : paths) free.push_back({.paths = {path}});
  return free;
}

/// Standard normal, by Box and Muller.
inline double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
         std::cos(2.0 * std::numbers::pi * random.uniform());
}

}  // namespace hydrapod::test
