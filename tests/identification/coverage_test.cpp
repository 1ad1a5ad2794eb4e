/// The 95 % intervals in short; coverage_long_test.cpp has 200 seeds.

#include "identification/coverage.hpp"

namespace hydrapod::identification {
namespace {

TEST(Coverage, IntervalsHoldTheTruthAsOftenAsPromised) {
  const auto c = coverage_of(20, 0.3, 0.03);
  EXPECT_EQ(c.all_found, c.runs);
  // 60 intervals: 95 % less three deviations
  EXPECT_GE(c.frequency, 0.86);
  EXPECT_GE(c.damping, 0.86);
  // 120 squares of normal numbers have a mean of 1 with a deviation of 0.13. These have 0.60: the
  // intervals are a quarter wider than the errors ask for, and shall not become half as wide again
  EXPECT_GT(c.square, 0.45);
  EXPECT_LT(c.square, 1.0 + 3.0 * 0.13);
}

}  // namespace
}  // namespace hydrapod::identification
