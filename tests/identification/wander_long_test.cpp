/// How often modes that wander are named, and how often such as stay.

#include <gtest/gtest.h>

#include "wandering.hpp"

namespace hydrapod::identification {
namespace {

int records_with_wandering(const Drift& d, int seeds) {
  const auto system = five_masses();
  int named = 0;
  TimeTaken time;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto record = drifting_record(system, d, static_cast<std::uint64_t>(seed));
    named += !wandering_in(tested_for_wandering(record, &time)).empty();
  }
  std::printf("%.3f s per record, and %.3f s for the test of wandering\n", time.all_else / seeds,
              time.test / seeds);
  return named;
}

TEST(WanderingLong, StationaryRecordsAreNotNamed) {
  int all = 0;
  for (const double duration : {300.0, 100.0}) {
    const int named = records_with_wandering({.duration = duration}, 100);
    std::printf("stationary, %.0f s: %d of 100 records\n", duration, named);
    all += named;
  }
  EXPECT_LE(all, 2);  // 1 %
}

TEST(WanderingLong, DriftsOfTwoPercentAreNamed) {
  int all = 0;
  for (int mode = 0; mode < 5; ++mode) {
    const int named = records_with_wandering({.mode = mode}, 20);
    std::printf("mode %d drifts by 2 %%: %d of 20 records\n", mode + 1, named);
    EXPECT_GE(named, 17);
    all += named;
  }
  EXPECT_GE(all, 95);
}

}  // namespace
}  // namespace hydrapod::identification
