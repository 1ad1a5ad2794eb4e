/// What is exported of a machine whose legs buckle says so.

#include <gtest/gtest.h>

#include <algorithm>

#include "hydrapod/exchange/exchange.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

bool is_told_unstable(const Parity& parity) {
  return std::ranges::any_of(
      parity, [](const ParityLine& line) { return line.what == "UNSTABLE at this pose"; });
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

}  // namespace
}  // namespace hydrapod::exchange
