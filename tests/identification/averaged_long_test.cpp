/// Responses of analysers over many seeds: what is found, and how often the 95 % intervals hold the
/// truth.

#include <gtest/gtest.h>

#include <limits>

#include "averaged.hpp"

namespace hydrapod::identification {
namespace {

void expect_honest_averages(const char* name, const Averaged& how) {
  const auto score = averaged_score(how, 60);
  test::print_class(name, "hydrapod", score);
  IdentifyOptions as_they_are;
  as_they_are.window.evidence = std::numeric_limits<double>::infinity();
  test::print_class(name, "the same, no window", averaged_score(how, 60, as_they_are));
  test::expect_honest(score);
}

TEST(AveragedLong, HannBlocksOf8Seconds) {
  expect_honest_averages("averages with a Hann window, blocks of 8 s", {});
}
TEST(AveragedLong, HannBlocksOf16SecondsColoured) {
  expect_honest_averages("the same, 16 s, inputs that fall with frequency",
                         {.block = 4096, .blocks = 37.0, .colour = 0.7});
}
TEST(AveragedLong, HannOneInput) {
  expect_honest_averages("the same, one input, 8 s", {.inputs = 1});
}
/// Half a line in the width of a resonance: what blocks leave of it does not tell the modes. What
/// is called good must be right all the same.
TEST(AveragedLong, HannTooShortBlocks) {
  const Averaged how{.inputs = 1, .block = 1024};
  test::print_class("the same, 4 s", "hydrapod", averaged_score(how, 60));
  const auto good = averaged_score(how, 60, {}, 0.5);
  test::print_class("the same, 4 s", "hydrapod, quality 0.5 and more", good);
  EXPECT_EQ(good.false_modes, 0);
  EXPECT_GE(good.frequency_coverage(), 0.9);
  EXPECT_GE(good.damping_coverage(), 0.9);
}

}  // namespace
}  // namespace hydrapod::identification
