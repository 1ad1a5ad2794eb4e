// Responses that were averaged with a window which nobody names.
#include "averaged.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "found_pole.hpp"
#include "hydrapod/base/error.hpp"

namespace hydrapod::identification {
namespace {

std::string named_window(const Identification& found) {
  const auto at = std::ranges::find(found.warnings, ModeWarning::Kind::window, &ModeWarning::kind);
  return at == found.warnings.end() ? "" : at->window;
}

/// A fit without the window finds six to eight modes, with damping ratios up to twice too high.
TEST(AveragedResponses, HaveTheModesOfTheMachine) {
  for (const std::uint64_t seed : {3U, 4U}) {
    const auto found = identify_modes(averaged_responses({}, seed));
    EXPECT_EQ(named_window(found), "hann");
    const auto& warning = found.warnings.front();
    EXPECT_NEAR(warning.value, 2048.0 / averaged_rate, 1e-9);
    ASSERT_EQ(found.modes.size(), 5U);
    const auto system = frame(2);
    for (std::size_t r = 0; r < 5; ++r) {
      expect_within_deviations(found.modes[r].fit, TruePole(system.modes[r].pole));
      EXPECT_GT(found.modes[r].quality(), 0.5);
      EXPECT_LT(found.modes[r].fit.damping_deviation, 0.05 * found.modes[r].fit.damping_ratio());
    }
  }
}

/// Blocks without a window let in more from far away, and widen resonances in another way: they are
/// not taken for those of a Hann window, and what is not known is not called good.
TEST(AveragedResponses, OfBlocksWithoutWindowAreNoneOfAHannWindow) {
  const auto found = identify_modes(averaged_responses({.window = "box"}, 5));
  EXPECT_NE(named_window(found), "hann");
  const auto system = frame(2);
  for (const auto& mode : found.modes) {
    if (mode.quality() < 0.5) continue;
    const auto& nearest = *std::ranges::min_element(system.modes, {}, [&](const auto& m) {
      return std::abs(std::abs(m.pole) - mode.fit.omega());
    });
    expect_within_deviations(mode.fit, TruePole(nearest.pole), 1e-3, 0.05);
  }
}

void expect_right_where_good(const Identification& found, const test::ModalSystem& system) {
  for (const auto& mode : found.modes) {
    if (mode.quality() < 0.5) continue;
    const auto& nearest = *std::ranges::min_element(system.modes, {}, [&](const auto& m) {
      return std::abs(std::abs(m.pole) - mode.fit.omega());
    });
    expect_within_deviations(mode.fit, TruePole(nearest.pole), 2e-3, 0.1);
  }
}

/// A fit without the window, or with a Hann window, finds every mode twice.
TEST(AveragedResponses, OfAFlatTopWindowHaveTheModesOfTheMachine) {
  for (const std::uint64_t seed : {3U, 4U}) {
    const auto found = identify_modes(averaged_responses({.window = "flat-top"}, seed));
    if (seed == 3) EXPECT_EQ(named_window(found), "flat-top");  // else twins remain
    expect_right_where_good(found, frame(2));
  }
}

/// A fit without the window, or with another one, has damping ratios that are 14 % to 22 % too high.
TEST(AveragedResponses, OfOtherWindowsHaveTheModesOfTheMachine) {
  for (const char* window : {"blackman", "tukey"}) {
    const auto found = identify_modes(averaged_responses({.window = window}, 3));
    EXPECT_EQ(named_window(found), window);
    ASSERT_EQ(found.modes.size(), 5U) << window;
    const auto system = frame(2);
    for (std::size_t r = 0; r < 5; ++r) {
      SCOPED_TRACE(window);
      expect_within_deviations(found.modes[r].fit, TruePole(system.modes[r].pole));
    }
  }
}

/// One input, blocks side by side without a window: before all windows were tried, half of such
/// files had damping ratios up to 80 % too high with a quality of 1.
TEST(AveragedResponses, OfOneInputWithoutWindowAreRightWhereTheyAreGood) {
  int named = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto found =
        identify_modes(averaged_responses({.inputs = 1, .blocks = 101.0, .window = "box"}, seed));
    named += named_window(found) == "rectangular" ? 1 : 0;
    expect_right_where_good(found, frame(1));
  }
  EXPECT_GE(named, 4);
}

/// Without averages there is no window, however few lines a resonance has, and also where a mode
/// is missing from the model.
TEST(AveragedResponses, WithoutBlocksNoWindowIsNamed) {
  for (const double spacing : {0.0127, 0.0731, 0.119}) {
    const auto system = frame(2);
    test::Random random(17);
    FrequencyResponses r;
    const auto header = test::header_of(2, 4, 1.0);
    r.inputs.assign(header.channels.begin(), header.channels.begin() + 2);
    r.outputs.assign(header.channels.begin() + 2, header.channels.end());
    for (int k = 1; k * spacing < 31.0; ++k) {
      r.frequency.push_back(k * spacing);
      r.H.push_back(system.response(k * spacing));
      for (auto& h :
           r.H.back().reshaped())  // and a structure that is not linear, from line to line
        h *= 1.0 + 0.01 * std::complex<double>(test::normal(random), test::normal(random));
    }
    const auto found = identify_modes(r);
    EXPECT_EQ(named_window(found), "") << spacing;
    ASSERT_EQ(found.modes.size(), 5U) << spacing;
  }
}

/// Lines a third of a hertz apart, as a table of two digits has them.
TEST(AveragedResponses, MayBeRoundedToTheDigitsOfATable) {
  auto r = averaged_responses({.block = 742, .blocks = 211.0}, 7);
  for (double& f : r.frequency) f = std::round(100.0 * f) / 100.0;
  const auto found = identify_modes(r);
  EXPECT_EQ(named_window(found), "hann");
  EXPECT_EQ(found.modes.size(), 5U);
}

/// Frequencies of a list whose smallest distance has no meaning: a block of it would have a million
/// times as many lines.
TEST(AveragedResponses, AListOfFrequenciesHasNoBlocks) {
  const auto system = frame(2);
  test::Random random(29);
  FrequencyResponses r = averaged_responses({.block = 512, .blocks = 9.0}, 3);
  r.frequency = {5.000001, 5.000002};
  for (int k = 0; k < 211; ++k)
    r.frequency.push_back(1e-6 * std::round(2.17e6 * std::pow(13.7, k / 210.0)));
  std::ranges::sort(r.frequency);
  r.H.clear();
  for (const double f : r.frequency) {
    r.H.push_back(system.response(f));
    for (auto& h : r.H.back().reshaped())
      h *= 1.0 + 0.03 * std::complex<double>(test::normal(random), test::normal(random));
  }
  EXPECT_EQ(named_window(identify_modes(r)), "");
}

/// Also while windows are tried.
TEST(AveragedResponses, AreLeftWhenProgressStops) {
  const auto r = averaged_responses({.block = 1024}, 3);
  int calls = 0;
  const auto found = identify_modes(r, {}, [&](double) { ++calls; });
  ASSERT_NE(named_window(found), "");
  int left = calls;
  EXPECT_THROW(identify_modes(r, {},
                              [&](double) {
                                if (--left == 0) throw base::ComputationError("interrupted");
                              }),
               base::ComputationError);
}

}  // namespace
}  // namespace hydrapod::identification
