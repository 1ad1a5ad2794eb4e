/// Hammer tests over many seeds: what is found, and how often the 95 % intervals hold the truth.

#include "hammer.hpp"

namespace hydrapod::identification {
namespace {

void expect_honest(const char* name, const std::vector<HammerTest>& hammers) {
  const auto score = hammer_score(hammers, 60);
  test::print_class(name, "hydrapod", score);
  test::expect_honest(score);
}

TEST(HitsLong, One) { expect_honest("one hit, 0.03 % noise", {{}}); }

/// What is assumed of errors at least is 0.1 % of the response: here noise is more than that.
TEST(HitsLong, Noisy) { expect_honest("one hit, 1 % noise", {{.noise = 1e-2}}); }

TEST(HitsLong, Rebound) {
  expect_honest("one hit, 60 % rebound after 57 ms, 1 % noise",
                {{.at = {0.113, 0.113 + 117.0 / hammer_rate}, .size = {1.0, 0.6}, .noise = 1e-2}});
}

TEST(HitsLong, Double) {
  expect_honest("two equal hits 13 ms apart, 1 % noise",
                {{.at = {0.113, 0.113 + 27.0 / hammer_rate}, .size = {1.0, 0.98}, .noise = 1e-2}});
}

TEST(HitsLong, LateLast) {
  expect_honest("four hits, the last 0.2 s before the end, 1 % noise",
                {{.seconds = 12.7, .at = {0.713, 4.731, 8.617, 12.491}, .noise = 1e-2}});
}

TEST(HitsLong, UnequalTails) {
  expect_honest("four records of 4 s, hit after 0.1, 0.4, 1.1 and 3.8 s, 1 % noise",
                {{.at = {0.113}, .noise = 1e-2},
                 {.at = {0.417}, .noise = 1e-2},
                 {.at = {1.083}, .noise = 1e-2},
                 {.at = {3.791}, .noise = 1e-2}});
}

TEST(HitsLong, Several) {
  expect_honest("five hits in 8 s that have not rung down, 1 % noise",
                {{.seconds = 8.13,
                  .at = {0.713, 1.648, 2.931, 4.442, 5.617},
                  .size = {0.93, 1.21, 0.77, 1.04, 0.89},
                  .noise = 1e-2}});
}

}  // namespace
}  // namespace hydrapod::identification
