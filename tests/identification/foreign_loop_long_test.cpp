/// Modes inside a loop that this project did not make: rows of docs/validation/identification.md.

#include "foreign_loop.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hydrapod::identification {
namespace {

void judge(const char* name, ForeignLoop loop) {
  constexpr std::uint64_t seeds = 60;
  const auto plant = foreign_plant();
  test::ClassScore ours, plain;
  int with_tones = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    loop.seed = seed;
    const auto m = foreign_measurement(plant, loop);
    with_tones += m.responses.harmonics.empty() ? 0 : 1;
    add_modes(plant, m.responses, ours);
    add_modes(plant, textbook(m), plain);
  }
  const auto row = fmt::format("closed loop, {}", name);
  test::print_class(row, "hydrapod", ours);
  test::print_class(row, "S_yr S_ur⁻¹, same pole fit", plain);
  EXPECT_EQ(with_tones, 0);
  EXPECT_LE(ours.false_per_seed(), 0.1);
  EXPECT_LT(ours.median_frequency_error(), 1e-3);
  EXPECT_GE(ours.frequency_coverage(), 0.92);
  EXPECT_GE(ours.damping_coverage(), 0.9);
  EXPECT_GE(ours.shape_coverage(), 0.9);
  if (loop.duration < 200.0) {
    EXPECT_GE(ours.found_share(), 0.99);
    return;
  }
  EXPECT_EQ(ours.found, ours.wanted);
  EXPECT_LT(ours.largest_frequency_error(), 1e-3);
  EXPECT_LT(ours.largest_damping_error(), 0.05);
}

TEST(Foreign, LoopWithWhiteNoise) { judge("white noise", {.excitation = Excitation::white}); }
TEST(Foreign, LoopWithNoiseInABand) { judge("noise in a band", {.excitation = Excitation::noise}); }
TEST(Foreign, LoopWithSweeps) { judge("sweeps", {.excitation = Excitation::sweep}); }
TEST(Foreign, LoopWithMultisines) { judge("multisines", {.excitation = Excitation::multisine}); }
TEST(Foreign, LoopWithNoiseAtTheDrive) {
  judge("noise at the drive", {.excitation = Excitation::drive});
}
TEST(Foreign, ShortLoopWithWhiteNoise) {
  judge("white noise, 40 s", {.excitation = Excitation::white, .duration = 40.0});
}
TEST(Foreign, ShortLoopWithNoiseInABand) {
  judge("noise in a band, 40 s", {.excitation = Excitation::noise, .duration = 40.0});
}
TEST(Foreign, LoopAt80PercentOfItsGainLimit) {
  judge("white noise, 80 % of the gain limit, 150 s",
        {.excitation = Excitation::white, .integral = 3.37, .duration = 150.0});
}
TEST(Foreign, LoopAt95PercentOfItsGainLimit) {
  judge("white noise, 95 % of the gain limit, 150 s",
        {.excitation = Excitation::white, .integral = 4.0, .duration = 150.0});
}
TEST(Foreign, LoopInABandAt95PercentOfItsGainLimit) {
  judge("noise in a band, 95 % of the gain limit, 300 s",
        {.excitation = Excitation::noise, .integral = 4.0, .duration = 300.0});
}

}  // namespace
}  // namespace hydrapod::identification
