/// Balances sought at an amplitude, against the branches that lead there.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "hydrapod/modal/damped_modes.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

model::Machine heavy_with(const std::vector<std::string>& overrides) {
  return machine_file(read_text(source_file("models/heavy-platform.toml")), overrides).machine;
}

const std::vector<std::string> seals_that_soften{
    "legs.guide_sleeve.elastomer.dynamic_ratio=1.73",
    "legs.guide_sleeve.elastomer.loss_factor=0.17", "legs.guide_sleeve.elastomer.frequency=7.3 Hz",
    "legs.guide_sleeve.elastomer.softening=0.41",
    "legs.guide_sleeve.elastomer.softening_amplitude=0.13 mm"};
const std::vector<std::string> seals_that_stick{"legs.friction.coulomb=310 N",
                                                "legs.friction.bristles.stiffness=23 kN/mm"};

/// Steps along the branch and steps of the amplitude end at the same balance where the branch has
/// not turned and the mode is still like the linear one. Once it is another solution of the same
/// amplitude.
TEST(BalancesAt, AreThoseOfTheBranches) {
  const std::array amplitudes{4.1e-5, 2.3e-4, 1.3e-3};
  int compared = 0, alike = 0;
  for (const auto& overrides : {seals_that_soften, seals_that_stick}) {
    const auto machine = heavy_with(overrides);
    const auto pose = machine.poses.at(2).X_BP;
    const auto linear = dynamics::linear_model(machine, pose, ModelKind::guide);
    const auto modes = modal::normal_modes(linear);
    for (const auto& curve :
         modal::modes_at_amplitudes(machine, pose, ModelKind::guide, amplitudes)) {
      if (curve.from_long_swings) continue;
      for (const auto& point : curve.points) {
        if (!point.converged || point.turns > 0 || point.mac < 0.9) continue;
        const modal::SwingStart start{point.amplitude, -3.7 * modes.shapes.col(curve.mode)};
        const auto found =
            modal::balances_at(machine, pose, ModelKind::guide, std::array{start}).front();
        ++compared;
        if (!found.converged || std::abs(found.shape.dot(linear.M * point.shape)) < 0.99) continue;
        ++alike;
        EXPECT_NEAR(found.omega, point.omega, 1e-9 * point.omega);
        EXPECT_NEAR(found.damping_ratio, point.damping_ratio, 1e-8);
        EXPECT_NEAR(std::abs(found.shape.dot(linear.M * point.shape)), 1.0, 1e-8);
        EXPECT_NEAR(found.mac, point.mac, 1e-6);
        EXPECT_EQ(found.amplitude, point.amplitude);
      }
    }
  }
  EXPECT_GE(compared, 16);
  EXPECT_GE(alike, compared - 1);
}

/// What does not depend on the amplitude is the linear mode, at once.
TEST(BalancesAt, OfALinearMachineAreItsModes) {
  const auto machine = heavy_with({"legs.friction.coulomb=0 N", "legs.friction.breakaway=0 N"});
  const auto pose = machine.poses.at(2).X_BP;
  const auto modes = modal::normal_modes(dynamics::linear_model(machine, pose, ModelKind::guide));
  std::vector<modal::SwingStart> starts;
  for (int k = 0; k < 6; ++k) starts.push_back({0.017, modes.shapes.col(k)});
  const auto found = modal::balances_at(machine, pose, ModelKind::guide, starts);
  ASSERT_EQ(found.size(), 6U);
  for (int k = 0; k < 6; ++k) {
    ASSERT_TRUE(found[static_cast<std::size_t>(k)].converged);
    EXPECT_NEAR(found[static_cast<std::size_t>(k)].omega, modes.omega(k), 1e-10 * modes.omega(k));
  }
}

}  // namespace
}  // namespace hydrapod::test
