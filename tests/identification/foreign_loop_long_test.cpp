/// Modes inside a loop that this project did not make: rows of docs/validation/identification.md.

#include "foreign_loop.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hydrapod::identification {
namespace {

void judge(const char* name, Excitation excitation, double duration = 205.0) {
  constexpr std::uint64_t seeds = 60;
  const auto plant = foreign_plant();
  test::ClassScore ours, plain;
  int with_tones = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto m =
        foreign_measurement(plant, {.excitation = excitation, .duration = duration, .seed = seed});
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
  if (duration < 100.0) {
    EXPECT_GE(ours.found_share(), 0.99);
    return;
  }
  EXPECT_EQ(ours.found, ours.wanted);
  EXPECT_LT(ours.largest_frequency_error(), 1e-3);
  EXPECT_LT(ours.largest_damping_error(), 0.05);
}

TEST(Foreign, LoopWithWhiteNoise) { judge("white noise", Excitation::white); }
TEST(Foreign, LoopWithNoiseInABand) { judge("noise in a band", Excitation::noise); }
TEST(Foreign, LoopWithSweeps) { judge("sweeps", Excitation::sweep); }
TEST(Foreign, LoopWithMultisines) { judge("multisines", Excitation::multisine); }
TEST(Foreign, LoopWithNoiseAtTheDrive) { judge("noise at the drive", Excitation::drive); }
TEST(Foreign, ShortLoopWithWhiteNoise) { judge("white noise, 40 s", Excitation::white, 40.0); }
TEST(Foreign, ShortLoopWithNoiseInABand) {
  judge("noise in a band, 40 s", Excitation::noise, 40.0);
}

}  // namespace
}  // namespace hydrapod::identification
