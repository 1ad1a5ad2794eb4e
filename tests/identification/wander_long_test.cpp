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
  for (const double duration : {300.0, 100.0}) {
    const int named = records_with_wandering({.duration = duration}, 100);
    std::printf("stationary, %.0f s: %d of 100 records\n", duration, named);
    EXPECT_LE(named, 1);
  }
}

TEST(WanderingLong, DriftsOfTwoPercentAreNamed) {
  for (int mode = 0; mode < 5; ++mode) {
    const int named = records_with_wandering({.mode = mode}, 20);
    std::printf("mode %d drifts by 2 %%: %d of 20 records\n", mode + 1, named);
    EXPECT_GE(named, 19);
  }
}

/// Excitation of any kind around a closed loop: no mode wanders.
TEST(WanderingLong, ClosedLoopsAreNotNamed) {
  const auto plant = foreign_plant();
  for (const auto excitation : {Excitation::white, Excitation::noise, Excitation::sweep}) {
    int named = 0;
    for (int seed = 1; seed <= 30; ++seed)
      named +=
          !wandering_in(
               tested_for_wandering(foreign_loop_record(
                   plant, {.excitation = excitation, .seed = static_cast<std::uint64_t>(seed)})))
               .empty();
    std::printf("closed loop, excitation %d: %d of 30 records\n", static_cast<int>(excitation),
                named);
    EXPECT_LE(named, 1);
  }
}

}  // namespace
}  // namespace hydrapod::identification
