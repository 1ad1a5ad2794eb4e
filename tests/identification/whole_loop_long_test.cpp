/// From the rig's record to modes, the sharp and weak ones too.

#include "whole_loop.hpp"

namespace hydrapod::identification {
namespace {

TEST(WholeLoopLong, PublishedMachineWithBothResonancesInXAndY) {
  const auto machine = simulation::machine_of("zhang-jiang-2021");
  const test::RigExperiment experiment{
      .X_BP = machine.neutral(), .duration = 3600.0, .level = 3e-4, .seed = 21};
  const auto found = test::identified_on_rig(machine, experiment);
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.004});
}

TEST(WholeLoopLong, HeavyPlatform) {
  const auto machine = simulation::machine_of("heavy-platform");
  const test::RigExperiment experiment{
      .X_BP = machine.neutral(), .duration = 600.0, .level = 1e-4, .seed = 22};
  const auto found = test::identified_on_rig(machine, experiment);
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.04});
}

}  // namespace
}  // namespace hydrapod::identification
