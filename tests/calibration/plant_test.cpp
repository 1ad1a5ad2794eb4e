/// Numbers of a machine from the modes of its plant.

#include <gtest/gtest.h>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/observation/observation.hpp"
#include "support/calibration_machine.hpp"
#include "support/noisy_modes.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using namespace observation;
using dynamics::ModelKind;

model::MachineFile published(const std::vector<std::string>& overrides = {}) {
  return test::machine_file(test::read_text(test::source_file("models/zhang-jiang-2021.toml")),
                            overrides);
}

/// One number and one frequency: the number is known to the frequency's deviation over how much it
/// follows the number, which is differenced here with another step.
TEST(PlantCalibration, KnowsANumberAsWellAsTheFrequencyTellsIt) {
  const auto file = published();
  test::Random random(311);
  auto targets = test::noisy_plant_modes(file.machine, {"neutral"}, ModelKind::guide,
                                         {.frequency = 1e-9, .shape = 1e-9}, random);
  const auto of_z = std::ranges::find_if(targets.modes, [](const ModeTarget& mode) {
    return std::abs((*mode.shape)[2]) > 0.9 * mode.shape->norm();
  });
  ASSERT_NE(of_z, targets.modes.end());
  ModeTarget only = *of_z;
  only.shape.reset();
  only.complex_shape.reset();
  only.direction = 2;
  only.deviation = 0.013;
  targets.modes = {only};
  const auto fit =
      calibrate(file, targets,
                {.free = {{.paths = {"platform.mass"}, .start = "941"}}, .options = {.starts = 1}},
                ModelKind::guide)
          .best();
  ASSERT_EQ(fit.parameters.size(), 1U);
  const double mass = file.machine.platform.mass;
  EXPECT_NEAR(fit.parameters[0].value, mass, 1e-4 * mass);
  const auto omega_at = [&](double m) {
    auto machine = file.machine;
    machine.platform.mass = m;
    double nearest = 0.0;
    for (const auto& mode :
         observe(machine, machine.neutral(), ModelKind::guide, Observed::plant).modes)
      if (std::abs(mode.omega() - only.omega) < std::abs(nearest - only.omega))
        nearest = mode.omega();
    return nearest;
  };
  const double h = 4.7;
  const double slope = (omega_at(mass + h) - omega_at(mass - h)) / (2.0 * h);
  // the difference over h is off by (h/m)²; the fit counts in ln m
  EXPECT_NEAR(fit.parameters[0].deviation * std::abs(slope), 0.013, 1e-4 * 0.013);
}

/// Heavy dampers and leakage shift poles: undamped modes fitted to them miss the numbers that the
/// plant gives back.
TEST(PlantCalibration, RecoversSleevesWhoseKneeLiesBesideXAndY) {
  const double stiffness = 0.8 * 1.5732e5;
  const auto truth = published({fmt::format("legs.guide_sleeve.stiffness={}", stiffness)});
  test::Random random(97);
  auto targets = test::noisy_plant_modes(truth.machine, {"neutral"}, ModelKind::guide,
                                         {.frequency = 5e-4, .shape = 0.02}, random);
  const Plan plan{.free = {{.paths = {"legs.guide_sleeve.stiffness"}}}, .options = {.starts = 2}};
  const auto fit = calibrate(published(), targets, plan, ModelKind::guide).best();
  const auto& k_s = fit.parameters.at(0);
  EXPECT_NEAR(k_s.value, stiffness, 4.0 * k_s.deviation);
  EXPECT_LT(k_s.deviation, 0.005 * stiffness);
  EXPECT_LT(fit.misfit, 3.0 * static_cast<double>(targets.modes.size()));
  // the same taken for modes of mechanics
  targets.observed = Observed::mechanics;
  const auto other = calibrate(published(), targets, plan, ModelKind::guide).best();
  EXPECT_GT(other.misfit, 10.0 * fit.misfit);
}

}  // namespace
}  // namespace hydrapod::calibration
