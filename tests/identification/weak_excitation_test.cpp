/// Excitation that moves the inputs of a loop less than what else moves them: where, it is said.

#include "weak_excitation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydrapod::identification {
namespace {

TEST(WeakExcitation, IsSaidWhereItIsAndCostsQuality) {
  const auto plant = foreign_plant();
  WeakScore score;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) add_weak_loop(plant, 3.1e-6, seed, score);
  EXPECT_EQ(score.records_with_bands, 3);
  EXPECT_GE(score.weak_modes, 5);
  EXPECT_LE(score.most_bands, 4);
  EXPECT_EQ(score.false_and_good, 0);
  EXPECT_LE(score.best_weak_quality, 1.0 + 1e-12);
}

/// At 12.35 Hz the inputs are moved some forty times as much by the excitation as at 5.48 Hz.
TEST(WeakExcitation, StrongPartsOfTheBandAreNotNamed) {
  const auto plant = foreign_plant();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto m = foreign_measurement(plant, weak_loop(9.7e-6, seed));
    const auto bands = weak_bands(m.responses);
    ASSERT_FALSE(bands.empty());
    EXPECT_TRUE(is_weak(bands, plant.modes[0].pole));
    EXPECT_FALSE(is_weak(bands, plant.modes[2].pole));
    for (const auto& band : bands) {
      EXPECT_LE(band.lowest, band.highest);
      EXPECT_NEAR(band.share, band.value / 5.0, 1e-12);
      EXPECT_GT(band.value, 0.0);
      EXPECT_LT(band.share, 1.0);
    }
    const auto found = identify_modes(m.responses, foreign_band);
    for (const auto& mode : found.modes) {
      const bool weak = is_weak(bands, mode.fit.pole);
      EXPECT_EQ(weak, mode.explained < 1.0) << mode.fit.omega();
    }
  }
}

TEST(WeakExcitation, GoodRecordsHaveNone) {
  const auto plant = foreign_plant();
  for (const auto excitation :
       {Excitation::white, Excitation::noise, Excitation::sweep, Excitation::drive})
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
      EXPECT_TRUE(
          weak_bands(foreign_measurement(plant, {.excitation = excitation, .seed = seed}).responses)
              .empty())
          << static_cast<int>(excitation);
}

}  // namespace
}  // namespace hydrapod::identification
