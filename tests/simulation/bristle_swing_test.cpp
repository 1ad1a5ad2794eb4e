/// Swings of the plant with bristles of the cylinders' seals, against the harmonic balance.

#include <gtest/gtest.h>

#include <algorithm>

#include "support/loop_machine.hpp"
#include "support/sustained_swing.hpp"
#include "support/vibrations.hpp"

namespace hydrapod::simulation {
namespace {

/// Bristles that stick for the most part, slide at the turns, and slide for long. Valves are shut,
/// so that the oil is a spring. The plant integrates the state of the bristles; the harmonic
/// balance, which was not made from it, integrates a period of the law.
TEST(SwingsOfBristles, HaveFrequencyAndLossOfTheHarmonicBalance) {
  auto machine = machine_of("zhang-jiang-2021", {"damping.modal_ratio=0"});
  test::block_cylinders(machine);
  for (auto& leg : machine.legs) {
    leg.oil_spring.damping = 0.0;
    leg.hydraulics.friction = {.coulomb = 210.0,
                               .breakaway = 260.0,
                               .viscous = 0.0,
                               .bristles = model::LuGreBristles{.stiffness = 7.3e6}};
  }
  constexpr auto kind = ModelKind::rigid;
  const auto balance = [&](const std::vector<double>& at) {
    return modal::modes_at_amplitudes(machine, machine.neutral(), kind, at).front();
  };
  double lowest = 1e9, highest = 0.0;
  for (const auto& point : balance({1.3e-5, 9e-5, 7e-4}).points) {
    ASSERT_TRUE(point.converged);
    SustainedSwing sustained(machine, kind, point, true, 2.0);
    const auto found = sustained.swing(2.0, 40, 1.2e-4);
    EXPECT_NEAR(found.amplitude, point.amplitude, 0.01 * point.amplitude);
    const auto there = balance({found.amplitude}).points.front();
    ASSERT_TRUE(there.converged);
    // the higher harmonics that the balance leaves out grow with the loss
    const double zeta = there.damping_ratio;
    EXPECT_NEAR(found.omega, there.omega, 0.07 * zeta * there.omega) << found.amplitude;
    EXPECT_NEAR(found.damping_ratio, zeta, 0.08 * zeta) << found.amplitude;
    lowest = std::min(lowest, found.omega);
    highest = std::max(highest, found.omega);
  }
  EXPECT_GT(highest, 1.5 * lowest);  // from springs beside the oil to none
}

}  // namespace
}  // namespace hydrapod::simulation
