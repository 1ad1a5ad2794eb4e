/// Electric cylinders on the rig: a record shows the modes of the linear model with its drives.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/other_legs.hpp"
#include "support/rig_record.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;

TEST(RigOnElectricCylinders, ShowsTheModesOfPlatformAndMotors) {
  auto machine = machine_of(screw_file);
  for (auto& leg : machine.legs) leg.screw->friction_torque = 0.0;
  const auto poles = simulation::system_poles(simulation::linear_system(
      machine, machine.neutral(), {.kind = dynamics::ModelKind::rigid, .closed = false}));
  const auto found = identified_on_rig(machine, {.kind = dynamics::ModelKind::rigid,
                                                 .X_BP = machine.neutral(),
                                                 .duration = 40.0,
                                                 .level = 4e-4,
                                                 .seed = 23,
                                                 .sensors = 0.05});
  int compared = 0;
  for (const auto& pole : poles.poles) {
    const double frequency = pole.omega / two_pi;
    if (!pole.oscillates() || pole.damping_ratio > 0.15 || frequency > 200.0) continue;
    if (frequency < 1e-3) continue;  // motors that turn freely, but for rounding
    ASSERT_FALSE(found.modes.empty());
    const auto mode = std::ranges::min_element(
        found.modes, {}, [&](const auto& one) { return std::abs(one.fit.omega() - pole.omega); });
    EXPECT_NEAR(mode->fit.omega(), pole.omega, 0.01 * pole.omega) << frequency;
    EXPECT_NEAR(mode->fit.damping_ratio(), pole.damping_ratio, 0.15 * pole.damping_ratio)
        << frequency;
    ++compared;
  }
  EXPECT_GE(compared, 2);
}

}  // namespace
}  // namespace hydrapod::test
