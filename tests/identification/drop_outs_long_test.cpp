/// Records with drop-outs: bias and coverage over many seeds.

#include <gtest/gtest.h>

#include "gapped.hpp"

namespace hydrapod::identification {
namespace {

void expect_honest(const char* name, const DropOuts& d) {
  const auto result = gapped_score(d, 60);
  const auto& score = result.score;
  test::print_class(name, "hydrapod", score);
  std::printf("  bias: frequency %.4f %% (%.1f standard errors), damping %.2f %% (%.1f)\n",
              100.0 * result.frequency_bias, result.frequency_bias_in_deviations,
              100.0 * result.damping_bias_relative, result.damping_bias);
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  EXPECT_LT(result.frequency_bias, 0.003);
  // 300 intervals that hold the truth 95 % of the time: 91.2 % is three standard errors below
  EXPECT_GT(score.frequency_coverage(), 0.912);
  EXPECT_GT(score.damping_coverage(), 0.912);
  // of five modes the largest: beyond 3.7 once in a thousand
  EXPECT_LT(result.damping_bias, 3.7);
}

TEST(DropOutsLong, Without) { expect_honest("no drop-outs", {}); }
TEST(DropOutsLong, SamplesLostAtRandom) { expect_honest("2 % at random", {.share = 0.02}); }
TEST(DropOutsLong, ManyShortGaps) { expect_honest("200 gaps of 0.1 s", {.gaps = 200}); }
TEST(DropOutsLong, BothAtOnce) { expect_honest("both", {.share = 0.02, .gaps = 200}); }
TEST(DropOutsLong, EachChannelLosesItsOwn) {
  expect_honest("each channel its own", {.share = 0.02, .gaps = 60, .channels_separately = true});
}

}  // namespace
}  // namespace hydrapod::identification
