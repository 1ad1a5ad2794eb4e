/// Modes inside a loop that this project did not make, with excitation of every kind: a few seeds.

#include "foreign_loop.hpp"

#include <gtest/gtest.h>

namespace hydrapod::identification {
namespace {

class ForeignLoops : public testing::TestWithParam<Excitation> {};

TEST_P(ForeignLoops, GivesTheModesOfThePlant) {
  const auto plant = foreign_plant();
  test::ClassScore score;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto m = foreign_measurement(plant, {.excitation = GetParam(), .seed = seed});
    EXPECT_TRUE(m.responses.harmonics.empty());
    add_modes(plant, m.responses, score);
  }
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  EXPECT_LT(score.largest_frequency_error(), 1e-3);
  EXPECT_LT(score.largest_damping_error(), 0.05);
}

/// 40 s: some nine blocks that reach over each other, as long as the sharpest mode needs.
TEST(ShortForeignLoop, GivesTheModesOfThePlant) {
  const auto plant = foreign_plant();
  test::ClassScore score;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto m = foreign_measurement(
        plant, {.excitation = Excitation::noise, .duration = 40.0, .seed = seed});
    EXPECT_EQ(m.spectra.options.block_length, 2048);
    add_modes(plant, m.responses, score);
  }
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  EXPECT_LT(score.median_frequency_error(), 1e-3);
  EXPECT_LT(score.median_damping_error(), 0.05);
}

/// Too short for blocks that tell its modes apart: no mode of it is certain, as narrow or as wide
/// as it looks.
TEST(ShortForeignLoop, NoModeIsCertainWhereBlocksAreShorterThanMostNeed) {
  const auto plant = foreign_plant();
  for (const double duration : {14.0, 20.0}) {
    const auto m = foreign_measurement(
        plant, {.excitation = Excitation::noise, .duration = duration, .seed = 1});
    const auto found = identify_modes(m.responses, foreign_band);
    ASSERT_FALSE(found.modes.empty());
    const auto at =
        std::ranges::find(found.warnings, ModeWarning::Kind::short_blocks, &ModeWarning::kind);
    ASSERT_NE(at, found.warnings.end());
    ASSERT_GE(2 * at->count, at->total);
    for (const auto& mode : found.modes)
      EXPECT_LE(mode.quality(), at->value * at->to / 2.0 + 1e-12) << duration;
  }
}

INSTANTIATE_TEST_SUITE_P(Excitations, ForeignLoops,
                         testing::Values(Excitation::white, Excitation::noise, Excitation::sweep,
                                         Excitation::multisine, Excitation::drive));

}  // namespace
}  // namespace hydrapod::identification
