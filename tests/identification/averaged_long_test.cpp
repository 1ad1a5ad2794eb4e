/// Responses of analysers over many seeds: what is found, and how often the 95 % intervals hold the
/// truth.

#include <gtest/gtest.h>

#include "averaged.hpp"

namespace hydrapod::identification {
namespace {

void expect_honest_averages(const char* name, const Averaged& how) {
  const auto score = averaged_score(how, 60);
  test::print_class(name, "hydrapod", score);
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
  expect_honest_averages("the same, one input, 4 s", {.inputs = 1, .block = 1024});
}

}  // namespace
}  // namespace hydrapod::identification
