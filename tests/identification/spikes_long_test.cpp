/// Spikes in many records: a row of docs/validation/identification.md, and no false alarm.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "spiky.hpp"

namespace hydrapod::identification {
namespace {

TEST(SpikesLong, ModesOfRecordsWithSpikes) {
  const auto system = five_masses();
  test::ClassScore score;
  int named = 0, wanted = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    auto record = quiet_record(seed);
    test::Random random(911 * seed);
    for (const Eigen::Index c : {1, 3, 6})
      add_spikes(c, 4, std::pow(10.0, 2.3 + 0.06 * seed), random, record);
    const auto m = gapped_measurement(record);
    for (const auto& warning : spike_warnings(m.responses))
      named += static_cast<int>(warning.count);
    wanted += 3 * (1 + 2 + 3 + 1);
    score.add(test::true_modes(system), test::found_modes(identify_modes(m.responses)));
  }
  test::print_class("12 spikes of 200 to 8·10⁵ times the RMS", "hydrapod", score);
  fmt::print("samples named: {} of {}\n", named, wanted);
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  EXPECT_GE(named, 0.97 * wanted);
  EXPECT_GE(score.frequency_coverage(), 0.93);
  EXPECT_GE(score.damping_coverage(), 0.93);
}

TEST(SpikesLong, NoneInCleanRecords) {
  for (int kind = 0; kind < static_cast<int>(CleanKind::count); ++kind) {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed)
      alarms += spikes_in(clean_record(static_cast<CleanKind>(kind), seed)).empty() ? 0 : 1;
    EXPECT_EQ(alarms, 0) << kind;
  }
}

}  // namespace
}  // namespace hydrapod::identification
