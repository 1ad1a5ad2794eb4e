/// Modes whose frequency drifts during the record are named, others are not. Many seeds are in
/// wander_long_test.cpp.

#include <gtest/gtest.h>

#include "foreign_loop.hpp"
#include "wandering.hpp"

namespace hydrapod::identification {
namespace {

TEST(Wandering, AModeThatDriftsIsNamed) {
  const auto system = five_masses();
  constexpr int drifting = 2;
  const auto found = tested_for_wandering(drifting_record(system, {.mode = drifting}, 3));
  ASSERT_EQ(found.modes.size(), 5U);
  const auto warnings = wandering_in(found);
  ASSERT_EQ(warnings.size(), 1U);
  const auto& pole = system.modes[drifting].pole;
  const double frequency = std::abs(pole) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(warnings[0].value, frequency, 0.005 * frequency);
  // halves of a linear drift of 2 % are 1 % apart
  EXPECT_EQ(warnings[0].count, 2);
  EXPECT_NEAR((warnings[0].to - warnings[0].from) / frequency, 0.01, 0.003);
  // what is said of the damping: higher than in the parts, and in truth too high
  const double damping = -pole.real() / std::abs(pole);
  const auto& mode = found.modes[drifting];
  EXPECT_GT(mode.fit.damping_ratio(), damping + 2.0 * mode.fit.damping_deviation);
  EXPECT_GT(warnings[0].share, 0.02);
  EXPECT_NEAR(mode.fit.damping_ratio() / (1.0 + warnings[0].share), damping, 0.1 * damping);
  for (int r = 0; r < 5; ++r) {
    const auto& other = found.modes[static_cast<std::size_t>(r)];
    if (r == drifting)
      EXPECT_LT(other.steadiness, 0.75);
    else
      EXPECT_EQ(other.steadiness, 1.0);
  }
}

TEST(Wandering, ModesThatStayAreNotNamed) {
  const auto system = five_masses();
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_TRUE(wandering_in(tested_for_wandering(drifting_record(system, {}, seed))).empty())
        << seed;
}

TEST(Wandering, InALoopTheModeThatDriftsIsNamed) {
  const auto plant = foreign_plant();
  for (int drifting = -1; drifting < 3; ++drifting) {
    const ForeignLoop loop{.excitation = Excitation::noise, .drifting = drifting, .seed = 71};
    const auto found = tested_for_wandering(foreign_loop_record(plant, loop));
    const auto warnings = wandering_in(found);
    ASSERT_EQ(warnings.size(), drifting < 0 ? 0U : 1U) << drifting;
    if (drifting < 0) continue;
    const double frequency =
        std::abs(plant.modes[static_cast<std::size_t>(drifting)].pole) / (2.0 * std::numbers::pi);
    EXPECT_NEAR(warnings[0].value, frequency, 0.005 * frequency);
    EXPECT_NEAR((warnings[0].to - warnings[0].from) / frequency, 0.01, 0.003);
  }
}

}  // namespace
}  // namespace hydrapod::identification
