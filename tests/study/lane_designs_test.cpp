/// Designs in SIMD lanes are those of one design at a time; the long test has a million machines.

#include "lane_comparison.hpp"
#include "support/kinds.hpp"
#include "support/payload_modes.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

/// ω² are Rayleigh quotients: their error is the square of that of the shapes.
constexpr double same_frequency = 1e-12;
/// Rounding of six by six matrices.
constexpr double same_sum = 1e-10;
/// Rounding of sums over six legs; under gravity, what Newton's last step leaves.
constexpr double same_matrix = 1e-13, same_matrix_bent = 1e-11;

class LaneDesigns : public testing::TestWithParam<AxesAndKind> {
 protected:
  /// Eleven designs: whole and partial lanes of every kernel.
  template <class Make>
  void expect_the_same(const Make& make, bool labels = true) {
    std::vector<LaneDesign> designs;
    for (int k = 0; k < 11; ++k) designs.push_back(make());
    const bool bent = !designs.front().machine.gravity.isZero(0.0);
    for (const auto& kernels : study::usable_kernels()) {
      SCOPED_TRACE(fmt::format("{} lanes", kernels.lanes));
      LaneComparison comparison;
      comparison.add(kernels, designs);
      EXPECT_EQ(comparison.alone, 0);
      EXPECT_LE(comparison.mass, bent ? same_matrix_bent : same_matrix);
      EXPECT_LE(comparison.stiffness, bent ? same_matrix_bent : same_matrix);
      EXPECT_LE(comparison.frequency, same_frequency);
      EXPECT_LE(comparison.without_shapes, same_frequency);
      compared_ += comparison.designs - comparison.left;
      EXPECT_LE(comparison.sum_of_mass, same_sum);
      if (labels) {
        EXPECT_EQ(comparison.labels, 0) << comparison.different;
      }
    }
  }
  Random random_{2101};
  int compared_{};  ///< frequencies without shapes
};

TEST_P(LaneDesigns, OfRandomMachinesAreTheSame) {
  const auto [axes, kind] = GetParam();
  for (int trial = 0; trial < 30; ++trial)
    expect_the_same([&] { return lane_design(random_, axes, kind, Gravity{trial % 3}); });
  EXPECT_GE(compared_, kind == ModelKind::full ? 1 : 600);
}

/// Equal legs on both sides of a plane of symmetry hold equal energies: which of them a label names
/// is left to rounding.
TEST_P(LaneDesigns, OfEqualLegsAreTheSame) {
  const auto [axes, kind] = GetParam();
  for (const double spread : {0.0, 1e-6, 1e-3})
    expect_the_same([&] { return lane_design(random_, axes, kind, Gravity::none, spread); },
                    spread > 0.0);
}

TEST_P(LaneDesigns, OfBuckledLegsAreNegativeToo) {
  const auto [axes, kind] = GetParam();
  if (kind == ModelKind::rigid) return;
  std::vector<LaneDesign> designs;
  for (int k = 0; k < 9; ++k) {
    designs.push_back(lane_design(random_, axes, kind, Gravity::none));
    designs.back().machine.legs[0].guide_sleeve.stiffness *= -1.0;  // a leg that folds
  }
  for (const auto& kernels : study::usable_kernels()) {
    LaneComparison comparison;
    comparison.add(kernels, designs);
    EXPECT_EQ(comparison.buckled, 9);
  }
}

/// Seals so soft, and platforms so heavy, that legs buckle or fold.
TEST_P(LaneDesigns, WithoutEquilibriumAreLeftToOneAtATime) {
  const auto [axes, kind] = GetParam();
  if (kind == ModelKind::rigid) return;
  std::vector<LaneDesign> designs;
  for (int k = 0; k < 400; ++k) {
    designs.push_back(lane_design(random_, axes, kind, Gravity::down));
    const double softer = random_.log_uniform(1e-6, 1.0);
    for (auto& leg : designs.back().machine.legs) leg.guide_sleeve.stiffness *= softer;
    designs.back().machine.platform.mass *= random_.log_uniform(1.0, 30.0);
  }
  for (const auto& kernels : study::usable_kernels()) {
    LaneComparison comparison;
    comparison.add(kernels, designs);
    EXPECT_GE(comparison.impossible, 2);
    EXPECT_GE(comparison.buckled, 1);
    EXPECT_GE(comparison.alone, comparison.impossible);
    EXPECT_LE(comparison.alone - comparison.impossible, comparison.designs / 50);
    EXPECT_LE(comparison.frequency, same_frequency);
  }
}

/// Bit for bit: a row of a study is the same whatever stands beside it, in any lane and with every
/// instruction set.
TEST_P(LaneDesigns, DoNotDependOnTheDesignsBeside) {
  const auto [axes, kind] = GetParam();
  for (const auto gravity : {Gravity::none, Gravity::down}) {
    std::vector<LaneDesign> designs;
    for (int k = 0; k < study::most_lanes; ++k)
      designs.push_back(lane_design(random_, axes, kind, gravity,
                                    k % 3 == 0 ? std::optional(0.0) : std::nullopt));
    std::optional<dynamics::ModelVector> of_first;
    for (const auto& kernels : study::usable_kernels()) {
      auto together = lanes_for(kernels, designs.front()),
           alone = lanes_for(kernels, designs.front());
      for (int lane = 0; lane < kernels.lanes; ++lane) together.put(lane, designs[lane].numbers());
      together.solve(kernels.lanes);
      for (int lane = 0; lane < kernels.lanes; ++lane) {
        SCOPED_TRACE(fmt::format("lane {} of {}", lane, kernels.lanes));
        ASSERT_TRUE(together.sound(lane));
        for (int other = 0; other < kernels.lanes; ++other)
          alone.put(other, designs[lane].numbers());
        alone.solve(kernels.lanes);
        for (const int other : {lane, (lane + kernels.lanes / 2) % kernels.lanes}) {
          EXPECT_EQ(together.modes(lane).omega2, alone.modes(other).omega2);
          EXPECT_EQ(together.modes(lane).shapes, alone.modes(other).shapes);
          EXPECT_EQ(together.stiffness(lane), alone.stiffness(other));
        }
      }
      if (!of_first) of_first = together.modes(0).omega2;
      EXPECT_EQ(together.modes(0).omega2, *of_first);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, LaneDesigns,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// A mass matrix that is not positive definite spoils its own lane alone.
TEST(LaneDesignsOfImpossibleMasses, AreLeftToOneAtATime) {
  Random random(3);
  std::vector<LaneDesign> designs;
  for (int k = 0; k < 8; ++k)
    designs.push_back(
        lane_design(random, model::FlexibleAxes::transverse, ModelKind::guide, Gravity::none));
  for (const auto& kernels : study::usable_kernels()) {
    auto lanes = lanes_for(kernels, designs.front());
    for (int lane = 0; lane < kernels.lanes; ++lane) {
      auto numbers = designs[lane].numbers();
      if (lane == 1) numbers.legs[2].I_r = -1e3;
      lanes.put(lane, numbers);
    }
    lanes.solve(kernels.lanes);
    for (int lane = 0; lane < kernels.lanes; ++lane) EXPECT_EQ(lanes.sound(lane), lane != 1);
  }
}

/// Also the smallest share of what a kernel does not know.
TEST(LaneDesignsOfMachines, FitWhereTheKernelKnowsAllTheirParts) {
  Random random(4);
  const auto machine = random_machine(random);
  EXPECT_TRUE(study::fits_lanes(machine));
  auto other = machine;
  other.base_mount.emplace();
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.legs[5].stick_stiffness = 3e5;
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.legs[5].guide_sleeve.gap = 2e-4;
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.legs[2].bending = model::LegBending::elastic;
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  put_modes_on(other, 1, random);
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.legs[4].guide_sleeve.elastomer.emplace();
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.legs[1].piston_ring.emplace().elastomer.emplace();
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.damping.oil = model::OilDamping::chambers;
  EXPECT_FALSE(study::fits_lanes(other));
  other = machine;
  other.legs[3].oil_spring = {.cylinder = model::Cylinder{.rod_line_length = 0.7}};
  EXPECT_FALSE(study::fits_lanes(other));
}

}  // namespace
}  // namespace hydrapod::test
