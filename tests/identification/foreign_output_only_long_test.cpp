/// Modes from outputs alone, on systems that neither the test rig nor its models made: one table
/// row per class for the default method, one for the textbook's.

#include <gtest/gtest.h>

#include "output_only.hpp"

namespace hydrapod::test {
namespace {

constexpr int output_only_seeds = 60;

struct OutputScores {
  ClassScore ours{}, textbook{};
};

/// Of all seeds; look(found) at each result.
template <class Look>
OutputScores scores_of(OutputClass data, const Look& look) {
  OutputScores scores;
  const auto truth = true_modes(data.system);
  for (int seed = 1; seed <= output_only_seeds; ++seed) {
    data.experiment.seed = static_cast<std::uint64_t>(1000 + seed);
    const auto record = outputs_of(data.system, data.experiment);
    const auto found = identified_outputs(record, data.block);
    scores.ours.add(truth, found_modes(found));
    scores.textbook.add(truth, textbook_output_modes(record));
    look(found);
  }
  print_class(data.name, "hydrapod", scores.ours);
  print_class(data.name, "textbook SSI-COV", scores.textbook);
  return scores;
}

void judge(const OutputClass& data) {
  const auto ours = scores_of(data, [](const auto&) {}).ours;
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
  const auto data = sharp_chain();
  const double sharp = std::abs(true_modes(data.system)[0].pole) / (2.0 * std::numbers::pi);
  int named = 0;
  const auto ours = scores_of(data, [&](const identification::Identification& found) {
                      for (const auto& harmonic : found.responses.harmonics)
                        if (std::abs(harmonic.frequency / sharp - 1.0) < 0.01) ++named;
                    }).ours;
  EXPECT_EQ(ours.found + named, ours.wanted);
  EXPECT_LE(named, output_only_seeds / 4);
  EXPECT_LE(ours.false_per_seed(), 0.1);
  EXPECT_GE(ours.frequency_coverage(), 0.93);
  EXPECT_GE(ours.damping_coverage(), 0.93);
}

}  // namespace
}  // namespace hydrapod::test
