/// Hammer tests with hum of the mains in the force channel.

#include <gtest/gtest.h>

#include "hammer.hpp"

namespace hydrapod::identification {
namespace {

/// `share`: of the largest force; a third harmonic of a quarter of it beside.
data::Record with_hum(data::Record record, double share, double hertz) {
  const double size = share * record.samples.col(0).maxCoeff();
  for (Eigen::Index k = 0; k < record.samples.rows(); ++k) {
    const double turn =
        2.0 * std::numbers::pi * hertz * static_cast<double>(k) / hammer_rate + 0.83;
    record.samples(k, 0) += size * (std::sin(turn) + 0.25 * std::cos(3.0 * turn));
  }
  return record;
}

std::vector<data::ResponseWarning> hum_in(const Measurement& m) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : m.responses.warnings)
    if (warning.kind == data::ResponseWarning::Kind::hum) found.push_back(warning);
  return found;
}

TEST(Hum, OfTheForceIsTakenOut) {
  for (const double share : {0.004, 0.02, 0.05}) {
    test::ClassScore score;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto m = measured({with_hum(hammer_record({.seconds = 3.7}, seed), share, 49.971)});
      const auto said = hum_in(m);
      ASSERT_GE(said.size(), 1U) << share;
      EXPECT_NEAR(said[0].value, 49.971, 0.01) << share;
      EXPECT_NEAR(said[0].share, share, 0.1 * share) << share;
      ASSERT_GT(m.responses.shift, 0.0) << "no hammer test";
      score.add(test::true_modes(beam()), test::found_modes(identify_modes(m.responses)));
    }
    EXPECT_EQ(score.found, 15) << share;
    EXPECT_EQ(score.false_modes, 0) << share;
    EXPECT_LT(score.largest_frequency_error(), 2e-4) << share;
    EXPECT_LT(score.largest_damping_error(), 0.01) << share;
  }
}

TEST(Hum, IsNotSaidOfNoise) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    EXPECT_TRUE(hum_in(measured({hammer_record({}, seed)})).empty()) << seed;
}

/// Three hits that are apart: each is a block, as without hum.
TEST(Hum, DoesNotHideSeveralHits) {
  const HammerTest hits{.seconds = 9.0, .at = {0.31, 3.12, 6.3}, .size = {1.0, 0.7, 1.2}};
  const auto m = measured({with_hum(hammer_record(hits, 7), 0.03, 60.04)});
  ASSERT_EQ(hum_in(m).size(), 2U);
  const auto found = identify_modes(m.responses);
  EXPECT_EQ(found.modes.size(), 3U);
}

}  // namespace
}  // namespace hydrapod::identification
