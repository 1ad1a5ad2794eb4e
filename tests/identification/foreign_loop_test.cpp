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

/// 20 s for each axis: blocks of 16 s cut the sweeps into pieces.
TEST(ShortForeignLoop, NoModeOfAFastSweepIsCertain) {
  using Kind = data::ResponseWarning::Kind;
  const auto m = foreign_measurement(
      foreign_plant(), {.excitation = Excitation::sweep, .duration = 60.0, .seed = 11});
  const auto at =
      std::ranges::find(m.responses.warnings, Kind::cut_sweep, &data::ResponseWarning::kind);
  ASSERT_NE(at, m.responses.warnings.end());
  EXPECT_LT(at->count, at->total);
  const auto found = identify_modes(m.responses, foreign_band);
  ASSERT_FALSE(found.modes.empty());
  for (const auto& mode : found.modes) EXPECT_LE(mode.quality(), 0.3);
}

/// A resonance of the loop at 6.38 Hz decays by 0.064 1/s: to a third in a block of 16 s. What it
/// leaves over is in the intervals, and no mode.
TEST(ForeignLoop, At95PercentOfItsGainLimitGivesTheModesOfThePlant) {
  const auto plant = foreign_plant();
  for (auto loop :
       {ForeignLoop{.excitation = Excitation::white, .integral = 4.0, .duration = 150.0},
        ForeignLoop{.excitation = Excitation::noise, .integral = 4.0, .duration = 300.0}})
    for (loop.seed = 1; loop.seed <= 4; ++loop.seed) {
      const auto found = identify_modes(foreign_measurement(plant, loop).responses, foreign_band);
      ASSERT_EQ(found.modes.size(), plant.modes.size()) << loop.seed;
      for (std::size_t r = 0; r < plant.modes.size(); ++r) {
        const auto& fit = found.modes[r].fit;
        const auto exact = plant.modes[r].pole;
        EXPECT_NEAR(fit.omega(), std::abs(exact), 4.0 * fit.omega_deviation) << loop.seed;
        EXPECT_NEAR(fit.damping_ratio(), -exact.real() / std::abs(exact),
                    4.0 * fit.damping_deviation)
            << loop.seed;
        EXPECT_LT(fit.omega_deviation, 1e-3 * fit.omega()) << loop.seed;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Excitations, ForeignLoops,
                         testing::Values(Excitation::white, Excitation::noise, Excitation::sweep,
                                         Excitation::multisine, Excitation::drive));

}  // namespace
}  // namespace hydrapod::identification
