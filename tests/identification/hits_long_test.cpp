/// Hammer tests over many seeds: what is found, and how often the 95 % intervals hold the truth.

#include "hammer.hpp"

namespace hydrapod::identification {
namespace {

void expect_honest(const char* name, const HammerTest& hammer) {
  const auto score = hammer_score(hammer, 60);
  test::print_class(name, "hydrapod", score);
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  // 180 intervals that hold the truth 95 % of the time: 90 % is three standard errors below
  EXPECT_GE(score.frequency_coverage(), 0.9);
  EXPECT_GE(score.damping_coverage(), 0.9);
}

TEST(HitsLong, One) { expect_honest("one hit, 0.03 % noise", {}); }
TEST(HitsLong, OneWithNoise) { expect_honest("one hit, 0.5 % noise", {.noise = 5e-3}); }
TEST(HitsLong, OneLate) {
  expect_honest("one hit at 4.2 s of 7.3 s", {.seconds = 7.31, .at = {4.217}, .noise = 2e-3});
}
TEST(HitsLong, Five) {
  expect_honest("five hits, none rung down", {.seconds = 8.13,
                                              .at = {0.713, 1.648, 2.931, 4.442, 5.617},
                                              .size = {0.93, 1.21, 0.77, 1.04, 0.89},
                                              .noise = 2e-3});
}
TEST(HitsLong, ThreeRungDown) {
  expect_honest(
      "three hits, rung down",
      {.seconds = 13.1, .at = {0.713, 4.931, 9.217}, .size = {0.93, 1.21, 0.77}, .noise = 2e-3});
}

}  // namespace
}  // namespace hydrapod::identification
