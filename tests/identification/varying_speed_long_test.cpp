/// Modes from outputs alone beside a machine whose speed varies by 0.1 to 1 %: one table row per
/// spread of the speed.

#include <gtest/gtest.h>

#include "varying_speed.hpp"

namespace hydrapod::test {
namespace {

constexpr int seeds = 20;

struct SpeedCase {
  const char* name{};
  double spread{}, slow{};
};

class VaryingSpeedLong : public ::testing::TestWithParam<SpeedCase> {};

TEST_P(VaryingSpeedLong, HidesNoModesAndMakesNone) {
  const auto& [name, spread, slow] = GetParam();
  auto data = floor_with_machine(spread);
  data.machine.slow = slow;
  ClassScore score;
  int sure = 0;  // false modes that the result trusts
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    data.experiment.seed = 400 + seed;
    const auto found = identified_as_asked(
        with_machine(outputs_of(data.system, data.experiment), data.machine, 900 + seed));
    const auto truth = true_modes(data.system);
    score.add(truth, found_modes(found));
    for (const auto& mode : found.modes)
      if (mode.quality() >= 0.5 && std::ranges::none_of(truth, [&](const TrueMode& t) {
            return std::abs(mode.fit.omega() / std::abs(t.pole) - 1.0) < 0.02;
          }))
        ++sure;
  }
  print_class(name, "hydrapod", score);
  EXPECT_GE(score.found, score.wanted - 2);
  EXPECT_LE(score.false_per_seed(), 0.1);
  EXPECT_LE(sure, 1);
  EXPECT_GE(score.frequency_coverage(), 0.9);
  EXPECT_GE(score.damping_coverage(), 0.9);
}

INSTANTIATE_TEST_SUITE_P(
    Foreign, VaryingSpeedLong,
    ::testing::Values(SpeedCase{"output only: a machine, speed ± 0.1 %, slow", 0.001, 0.01},
                      SpeedCase{"output only: a machine, speed ± 0.1 %", 0.001, 0.05},
                      SpeedCase{"output only: a machine, speed ± 0.3 %", 0.003, 0.05},
                      SpeedCase{"output only: a machine, speed ± 1 %", 0.01, 0.05}));

}  // namespace
}  // namespace hydrapod::test
