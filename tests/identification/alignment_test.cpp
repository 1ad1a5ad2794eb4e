/// Outputs that are late against each other by a few samples.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foreign_loop.hpp"
#include "hammer.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;
using Eigen::Index;

std::vector<data::ResponseWarning> delays_of(const FrequencyResponses& r) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : r.warnings)
    if (warning.kind == Kind::delayed) found.push_back(warning);
  return found;
}

data::Record shaken(std::uint64_t seed) {
  return test::record_of(beam(), {.sample_rate = hammer_rate,
                                  .samples = 82000,
                                  .output_noise = Eigen::Vector3d(1e-6, 2e-6, 1e-6),
                                  .seed = seed});
}

void delay(Index channel, Index samples, data::Record& record) {
  auto x = record.samples.col(channel);
  for (Index t = x.size() - 1; t >= samples; --t) x[t] = x[t - samples];
}

/// Without the beginning, where late channels have no samples.
data::Record from_later(const data::Record& record) {
  data::Record rest{.header = record.header, .samples = {}};
  rest.samples = record.samples.bottomRows(record.samples.rows() - 64);
  return rest;
}

TEST(Alignment, OutputsThatAreLateAreBroughtTogether) {
  for (std::uint64_t seed = 3; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    auto record = shaken(seed);
    delay(2, 9, record);
    delay(3, 5, record);
    const auto r = measured({from_later(record)}).responses;
    const auto delays = delays_of(r);
    ASSERT_EQ(delays.size(), 2U);
    EXPECT_EQ(delays[0].channel, "y2");
    EXPECT_EQ(delays[0].other, "y1");
    EXPECT_NEAR(delays[0].value * hammer_rate, 9.0, 0.1);
    EXPECT_NEAR(delays[1].value * hammer_rate, 5.0, 0.1);
    const auto found = identify_modes(r);
    const auto truth = beam();
    ASSERT_EQ(found.modes.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(found.modes[k].fit.omega() / std::abs(truth.modes[k].pole), 1.0, 1e-3);
      EXPECT_GT(mac(found.modes[k].fit.shape, truth.modes[k].shape), 0.995);
    }
  }
}

TEST(Alignment, ARecordOfHitsToo) {
  auto record = hammer_record({.noise = 1e-4}, 7);
  delay(1, 6, record);
  const auto r = measured({record}).responses;
  const auto delays = delays_of(r);
  ASSERT_EQ(delays.size(), 1U);
  EXPECT_EQ(delays[0].channel, "y1");
  EXPECT_NEAR(delays[0].value * hammer_rate, 6.0, 0.2);
}

/// Neither a structure, nor complex modes in a loop, nor an output that is turned.
TEST(Alignment, NothingIsMovedThatIsNotLate) {
  auto turned = shaken(11);
  turned.samples.col(2) *= -3.7;
  for (const auto& record : {shaken(13), turned, hammer_record({}, 17)})
    EXPECT_THAT(delays_of(measured({record}).responses), testing::IsEmpty());
  const auto plant = foreign_plant();
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    EXPECT_THAT(delays_of(measured({foreign_loop_record(plant, {.seed = seed})}).responses),
                testing::IsEmpty());
}

}  // namespace
}  // namespace hydrapod::identification
