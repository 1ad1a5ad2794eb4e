/// The 95 % intervals over 200 seeds, from little noise to as much as signal.

#include "identification/coverage.hpp"

namespace hydrapod::identification {
namespace {

class Coverages : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(Coverages, IntervalsHoldTheTruthAsOftenAsPromised) {
  const auto [noise, damping] = GetParam();
  const auto c = coverage_of(200, noise, damping);
  RecordProperty("frequency", std::to_string(c.frequency));
  RecordProperty("damping", std::to_string(c.damping));
  EXPECT_GE(c.all_found, 198);
  // 600 intervals, those of one record not independent: 95 % less three deviations of 300
  EXPECT_GE(c.frequency, 0.912) << c.frequency;
  EXPECT_GE(c.damping, 0.912) << c.damping;
}

INSTANTIATE_TEST_SUITE_P(NoiseAndDamping, Coverages,
                         testing::Values(std::pair{0.01, 0.02}, std::pair{0.1, 0.03},
                                         std::pair{0.3, 0.03}, std::pair{0.1, 0.08}));

}  // namespace
}  // namespace hydrapod::identification
