/// From the rig's record to modes, for records short enough for every day.

#include "whole_loop.hpp"

namespace hydrapod::identification {
namespace {

TEST(WholeLoop, PublishedMachine) {
  const auto machine = simulation::machine_of("zhang-jiang-2021");
  const test::RigExperiment experiment{
      .X_BP = machine.neutral(), .duration = 120.0, .level = 1.7e-4, .seed = 11};
  const auto found = test::identified_on_rig(machine, experiment);
  // the sharp seal modes need a longer record
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.1});
  EXPECT_EQ(found.modes[0].repeated, 2);
}

TEST(WholeLoop, HeavyPlatform) {
  const auto machine = simulation::machine_of("heavy-platform");
  const test::RigExperiment experiment{
      .X_BP = machine.neutral(), .duration = 120.0, .level = 2.3e-4, .seed = 12};
  const auto found = test::identified_on_rig(machine, experiment);
  // two minutes do not tell modes that are damped by 7 % to 0.3 %: the long test does
  expect_found(found, exact_poles(machine, experiment),
               {.least_share = 0.04, .frequency = 6e-3, .damping = 0.2});
}

}  // namespace
}  // namespace hydrapod::identification
