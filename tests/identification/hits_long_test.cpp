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

}  // namespace
}  // namespace hydrapod::identification
