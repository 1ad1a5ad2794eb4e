/// Modes from outputs alone, on systems that neither the test rig nor its models made: one table
/// row per class for the default method, one for the textbook's.

#include <gtest/gtest.h>

#include "output_only.hpp"

namespace hydrapod::test {
namespace {

constexpr int seeds = 60;

void judge(OutputClass data) {
  ClassScore ours, textbook;
  const auto truth = true_modes(data.system);
  for (int seed = 1; seed <= seeds; ++seed) {
    data.experiment.seed = static_cast<std::uint64_t>(1000 + seed);
    const auto record = outputs_of(data.system, data.experiment);
    const auto found = identified_outputs(record, data.block);
    ours.add(truth, found_modes(found));
    textbook.add(truth, textbook_output_modes(record));
  }
  print_class(data.name, "hydrapod", ours);
  print_class(data.name, "textbook SSI-COV", textbook);
  EXPECT_EQ(ours.found, ours.wanted);
  EXPECT_LE(ours.false_per_seed(), 0.1);
  EXPECT_NEAR(ours.frequency_coverage(), 0.95, 0.02);
  EXPECT_NEAR(ours.damping_coverage(), 0.95, 0.02);
}

TEST(Foreign, OutputsOfUnequalMasses) { judge(unequal_chain()); }
TEST(Foreign, OutputsWithClosePairs) { judge(close_pairs()); }
TEST(Foreign, OutputsWithTones) { judge(chain_with_tones()); }

/// Each mode is found, or, where it is too sharp for its blocks, named as a harmonic.
TEST(Foreign, OutputsWithASharpMode) {
  auto data = sharp_chain();
  const auto truth = true_modes(data.system);
  ClassScore ours, textbook;
  int named = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    data.experiment.seed = static_cast<std::uint64_t>(1000 + seed);
    const auto record = outputs_of(data.system, data.experiment);
    const auto found = identified_outputs(record, data.block);
    ours.add(truth, found_modes(found));
    textbook.add(truth, textbook_output_modes(record));
    for (const auto& harmonic : found.responses.harmonics)
      if (std::abs(2.0 * std::numbers::pi * harmonic.frequency / std::abs(truth[0].pole) - 1.0) <
          0.01)
        ++named;
  }
  print_class(data.name, "hydrapod", ours);
  print_class(data.name, "textbook SSI-COV", textbook);
  EXPECT_EQ(ours.found + named, ours.wanted);
  EXPECT_LE(named, seeds / 4);
  EXPECT_LE(ours.false_per_seed(), 0.1);
  EXPECT_GE(ours.frequency_coverage(), 0.93);
  EXPECT_GE(ours.damping_coverage(), 0.93);
}

}  // namespace
}  // namespace hydrapod::test
