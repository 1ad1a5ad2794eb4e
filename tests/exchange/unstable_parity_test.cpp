/// What is exported of a machine whose legs buckle says so.

#include <gtest/gtest.h>

#include <algorithm>

#include "hydrapod/exchange/exchange.hpp"
#include "support/loop_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

bool tells(const Parity& parity, std::string_view what) {
  return std::ranges::any_of(parity, [&](const ParityLine& line) { return line.what == what; });
}
bool is_told_unstable(const Parity& parity) { return tells(parity, "UNSTABLE at this pose"); }

bool is_told_unstable(const model::Machine& machine, SystemKind system) {
  const auto made = fmu(machine, machine.poses.front(),
                        {.hydraulics = system != SystemKind::mechanics,
                         .controlled = system == SystemKind::loop,
                         .object = "object",
                         .notices = "none"},
                        {.title = machine.name});
  return is_told_unstable(made.parity);
}

TEST(Parity, TellsThatSmallMotionsGrow) {
  for (const bool buckles : {false, true}) {
    auto machine = test::symmetric_machine(9.81);
    for (auto& leg : machine.legs)
      if (buckles) leg.guide_sleeve.stiffness = 1e5;
    const auto& pose = machine.neutral();
    const auto guide = dynamics::ModelKind::guide;
    const auto system = state_space(machine, pose, {.kind = guide});
    EXPECT_EQ(is_told_unstable(state_space_parity(system)), buckles);
    EXPECT_EQ(is_told_unstable(state_space_parity(discretised(system, 1e-3))), buckles);
    const auto element = superelement(machine, pose, {.kind = guide});
    EXPECT_EQ(is_told_unstable(superelement_parity(machine, element, false)), buckles);
  }
}

/// Valves that leak let the platform sink in minutes, as `modes --open-loop` says: no fault.
TEST(Parity, ADriftIsNoInstability) {
  const auto machine = simulation::machine_of("heavy-platform");
  const auto told = [&](SystemKind system, std::string_view what) {
    return tells(state_space_parity(state_space(machine, machine.neutral(), {.system = system})),
                 what);
  };
  EXPECT_TRUE(told(SystemKind::plant, "drift at this pose"));
  EXPECT_FALSE(told(SystemKind::plant, "UNSTABLE at this pose"));
  EXPECT_FALSE(told(SystemKind::loop, "drift at this pose"));
  EXPECT_FALSE(told(SystemKind::loop, "UNSTABLE at this pose"));
}

/// 18 t are more than the seals hold; a gain of 40 1/s is more than the loop does.
TEST(Parity, FmusTellThatTheirMachineDoesNotStay) {
  const auto sound = simulation::machine_of("heavy-platform");
  const auto heavy = simulation::machine_of("heavy-platform", {"platform.mass=\"18 t\""});
  const auto fast = simulation::machine_of("heavy-platform", {"controller.gain=40"});
  for (const auto system : {SystemKind::mechanics, SystemKind::plant, SystemKind::loop}) {
    EXPECT_FALSE(is_told_unstable(sound, system)) << static_cast<int>(system);
    EXPECT_TRUE(is_told_unstable(heavy, system)) << static_cast<int>(system);
    EXPECT_EQ(is_told_unstable(fast, system), system == SystemKind::loop);
  }
}

}  // namespace
}  // namespace hydrapod::exchange
