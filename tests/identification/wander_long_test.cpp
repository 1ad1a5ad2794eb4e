/// How often modes that wander are named, and how often such as stay.

#include <gtest/gtest.h>

#include "foreign_loop.hpp"
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

int loops_with_wandering(ForeignLoop loop, std::uint64_t seeds) {
  const auto plant = foreign_plant();
  int named = 0;
  for (loop.seed = 501; loop.seed <= 500 + seeds; ++loop.seed)
    named += wandering_in(tested_for_wandering(foreign_loop_record(plant, loop))).empty() ? 0 : 1;
  return named;
}

class WanderingLoops : public testing::TestWithParam<Excitation> {};

TEST_P(WanderingLoops, NameWhatDriftsAndNothingElse) {
  const int stationary = loops_with_wandering({.excitation = GetParam()}, 60);
  std::printf("loop %d, none drifts: %d of 60 records\n", static_cast<int>(GetParam()), stationary);
  EXPECT_LE(stationary, 1);
  int named = 0;
  for (int mode = 0; mode < 3; ++mode)
    named += loops_with_wandering({.excitation = GetParam(), .drifting = mode}, 20);
  std::printf("loop %d, one drifts by 2 %%: %d of 60 records\n", static_cast<int>(GetParam()),
              named);
  EXPECT_GE(named, 58);
}

INSTANTIATE_TEST_SUITE_P(Long, WanderingLoops,
                         testing::Values(Excitation::white, Excitation::noise, Excitation::drive));

}  // namespace
}  // namespace hydrapod::identification
