/// Outputs of an FMU, and what they and the derivatives depend on.

#include "fmu_outputs.hpp"

#include <array>

#include "hydrapod/base/error.hpp"

namespace hydrapod::exchange {

namespace {

using model::leg_count;
using simulation::Plant;
using simulation::PlantOutput;

constexpr unsigned pose_parts = part::position | part::orientation;
constexpr unsigned leg_stretch = pose_parts | part::flexible;
constexpr unsigned leg_speed = leg_stretch | part::velocity | part::turning | part::flexible_rate;
constexpr unsigned accelerations = leg_speed | part::pressure | part::bristle | part::base |
                                   part::base_rate | part::axial | part::wrench | part::arms |
                                   part::payload | part::nut | part::nut_rate | part::joints;
constexpr unsigned motor_torque = part::nut_rate | part::torque_integral | part::valve;

double pose_coordinate(const PlantOutput& out, int k) {
  return k < 3 ? out.X_BP.p_BP[k] : spatial::rpy_from_rotation(out.X_BP.R_BP)[k - 3];
}

using Leg = simulation::LegOutput;
template <auto member>
double of_leg(const PlantOutput& out, int leg) {
  return out.legs[static_cast<std::size_t>(leg)].*member;
}

void add_platform(const Plant& plant, std::vector<FmuOutput>& all) {
  constexpr std::array<const char*, 6> units{"m", "m", "m", "rad", "rad", "rad"};
  constexpr std::array<const char*, 6> rates{"m/s^2",   "m/s^2",   "m/s^2",
                                             "rad/s^2", "rad/s^2", "rad/s^2"};
  const auto add = [&](const std::string& name, const char* unit, const std::string& description,
                       double nominal, auto get, int k, unsigned parts) {
    all.push_back(
        {name + '.' + spatial::direction_name(k), unit, description, nominal, get, k, -1, parts});
  };
  for (int k = 0; k < 6; ++k)
    add("pose", units[static_cast<std::size_t>(k)],
        k < 3 ? "position of the platform frame's origin in the base frame"
              : "rotation of the platform, R = Rz(rz) Ry(ry) Rx(rx)",
        k < 3 ? 1.0 : 0.1, pose_coordinate, k,
        k < 3 ? part::own_coordinate | part::orientation : unsigned{part::orientation});
  for (int k = 0; k < 6; ++k)
    add(
        "acceleration", rates[static_cast<std::size_t>(k)],
        k < 3 ? "acceleration of the platform's mass centre against the base"
              : "angular acceleration of the platform against the base",
        1.0, +[](const PlantOutput& out, int i) { return out.acceleration[i]; }, k, accelerations);
  for (int k = 0; k < 6 && plant.base().count > 0; ++k)
    add(
        "ground_acceleration", rates[static_cast<std::size_t>(k)],
        k < 3 ? "acceleration of the platform's mass centre against the ground"
              : "angular acceleration of the platform against the ground",
        1.0, +[](const PlantOutput& out, int i) { return out.ground_acceleration[i]; }, k,
        accelerations);
}

/// Those of the rig, without noise and filters.
void add_accelerometers(const Plant& plant, std::vector<FmuOutput>& all) {
  constexpr std::array<char, 3> axes{'x', 'y', 'z'};
  std::size_t axis = 0;
  for (const auto& one : rig::default_accelerometers(plant.machine())) {
    const auto leg = std::to_string(one.point);
    all.push_back({.name = "accelerometer" + leg + '.' + axes[axis++ % axes.size()],
                   .unit = "m/s^2",
                   .description = "accelerometer on the platform at the joint of leg " + leg +
                                  ", axes of the platform: acceleration against the ground less "
                                  "gravity, 0 at rest",
                   .nominal = 1.0,
                   .parts = accelerations,
                   .sensor = one});
  }
}

}  // namespace

std::vector<FmuOutput> fmu_output_table(const Plant& plant) {
  std::vector<FmuOutput> all;
  add_platform(plant, all);
  const bool drives = plant.layout().nuts >= 0, oil = plant.options().hydraulics && !drives;
  for (int leg = 0; leg < leg_count; ++leg) {
    const auto& on = plant.machine().legs[static_cast<std::size_t>(leg)];
    const auto add = [&](const char* name, const char* unit, const char* description,
                         double nominal, auto get, unsigned parts) {
      all.push_back({"leg" + std::to_string(leg + 1) + '.' + name, unit, description, nominal, get,
                     leg, leg, parts});
    };
    const bool gives = on.gimbal_stiffness.has_value();
    const unsigned force = !gives ? 0U : drives ? part::nut : oil ? part::pressure : part::axial;
    const unsigned force_rate = !gives   ? 0U
                                : drives ? part::nut_rate
                                : oil    ? part::pressure | part::inflow
                                         : 0U;
    add("length", "m", "between the joints", 1.0, of_leg<&Leg::length>, pose_parts);
    add("length_rate", "m/s", "rate of the length", 0.1, of_leg<&Leg::length_rate>,
        pose_parts | part::velocity | part::turning);
    add("piston", "m", "position of the piston from the base joint along the cylinder", 1.0,
        of_leg<&Leg::piston>, leg_stretch | force);
    add("piston_rate", "m/s",
        oil || drives
            ? "speed of the piston in the cylinder"
            : "speed of the piston in the cylinder, without the rate of the gimbals' stretch",
        0.1, of_leg<&Leg::piston_rate>, leg_speed | force_rate);
    add("stop_force", "N", "of the end stops on the piston, + pushes the leg out", 1e4,
        of_leg<&Leg::stop_force>, leg_speed);
    if (drives) {
      add("screw_force", "N", "of the screw on the rod, + pushes the leg out", 1e4,
          of_leg<&Leg::oil_force>, leg_speed | part::nut | part::nut_rate);
      add("motor_speed", "rad/s", "of the motor, + extends the leg", 100.0,
          of_leg<&Leg::motor_speed>, part::nut_rate);
      add("torque", "N m", "of the motor, + extends the leg", 10.0, of_leg<&Leg::torque>,
          motor_torque);
    }
    if (!oil) continue;
    add("oil_force", "N", "of the oil on the piston, + pushes the leg out", 1e4,
        of_leg<&Leg::oil_force>, part::pressure);
    add("friction_force", "N", "of the seals on the rod, + pushes the leg out", 1e3,
        of_leg<&Leg::friction_force>, leg_speed | part::bristle);
  }
  add_accelerometers(plant, all);
  return all;
}

std::vector<double> fmu_outputs(const Plant& plant, const double* x,
                                const simulation::PlantInput& input) {
  const auto out = plant.outputs(x, input);
  std::vector<double> values;
  const auto& machine = plant.machine();
  for (const auto& one : fmu_output_table(plant))
    values.push_back(one.sensor
                         ? rig::specific_force(*one.sensor, machine, machine.poses.back().X_BP, out)
                         : one.get(out, one.element));
  return values;
}

unsigned fmu_acceleration_parts() { return accelerations; }
unsigned fmu_torque_parts() { return motor_torque; }
unsigned fmu_speed_parts() { return leg_speed; }
unsigned fmu_stretch_parts() { return leg_stretch; }

}  // namespace hydrapod::exchange
