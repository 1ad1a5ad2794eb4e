/// A million machines in SIMD lanes against one at a time.

#include <cstdio>

#include "lane_comparison.hpp"
#include "support/kinds.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

class MillionLaneDesigns : public testing::TestWithParam<AxesAndKind> {};

/// 167 000 machines for each kind of axes and model: random ones without gravity, with, and with it
/// in any direction; and machines of nearly equal legs.
TEST_P(MillionLaneDesigns, AreTheSame) {
  const auto [axes, kind] = GetParam();
  Random random(2104);
  LaneComparison comparison;
  std::vector<LaneDesign> designs(study::most_lanes);
  while (comparison.designs < 167'000) {
    const int turn = comparison.designs / study::most_lanes % 4;
    const auto spread = turn == 3 ? std::optional(random.log_uniform(1e-9, 1e-1)) : std::nullopt;
    for (auto& design : designs)
      design = lane_design(random, axes, kind, turn == 3 ? Gravity::none : Gravity{turn}, spread);
    comparison.add(study::usable_kernels().front(), designs);
  }
  std::printf(
      "%d designs, %d alone, %d buckled; frequencies differ by %.1e, M by %.1e, K by %.1e\n",
      comparison.designs, comparison.alone, comparison.buckled, comparison.frequency,
      comparison.mass, comparison.stiffness);
  EXPECT_LE(comparison.frequency, 1e-12);
  EXPECT_LE(comparison.alone, comparison.designs / 10'000);
}

INSTANTIATE_TEST_SUITE_P(, MillionLaneDesigns,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
