/// Swings of the plant with bristles of the cylinders' seals, against the harmonic balance.

#include <gtest/gtest.h>

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
  const double ratio = swing_as_in_the_balance(
      machine, {1.3e-5, 9e-5, 7e-4}, {.amplitude = 0.01, .frequency = 0.07, .damping = 0.08});
  EXPECT_GT(ratio, 1.5);  // from springs beside the oil to none
}

}  // namespace
}  // namespace hydrapod::simulation
