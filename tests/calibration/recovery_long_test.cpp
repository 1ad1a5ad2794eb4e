/// Coverage over a hundred seeds of noise and ten machines, with and without gravity.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>

#include "recovery.hpp"

namespace hydrapod {
namespace {

TEST(RecoveryLong, IntervalsHoldTheTruthAsOftenAsTheyPromise) {
  for (const bool gravity : {false, true}) {
    test::Coverage coverage;
    for (std::uint64_t machine = 1; machine <= 10; ++machine)
      for (std::uint64_t noise = 1; noise <= (gravity ? 3U : 100U); ++noise)
        test::recover(machine, noise, gravity, coverage);
    EXPECT_THAT(coverage.wrongly, testing::IsEmpty());
    const double share = static_cast<double>(coverage.held) / coverage.determined;
    // numbers of one fit err together: 1000 (30) fits are some 1000 (30) independent trials, with
    // a standard deviation of 0.007 (0.040)
    EXPECT_GE(share, gravity ? 0.95 - 3 * 0.040 : 0.95 - 3 * 0.007)
        << coverage.held << " of " << coverage.determined;
    RecordProperty(gravity ? "coverage_with_gravity" : "coverage", std::to_string(share));
    std::cout << (gravity ? "with" : "without") << " gravity: " << coverage.held << " of "
              << coverage.determined << " intervals hold the truth, " << coverage.undetermined
              << " parameters not determined\n";
  }
}

}  // namespace
}  // namespace hydrapod
