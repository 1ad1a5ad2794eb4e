/// Modes in SIMD lanes are those of one design at a time; the long test has a million machines.

#include <stdexcept>

#include "lane_comparison.hpp"
#include "study/lane_solve.hpp"
#include "support/kinds.hpp"

namespace hydrapod::test {
namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;

/// ω² are Rayleigh quotients: their error is the square of that of the shapes.
constexpr double same_frequency = 1e-12;
/// Rounding of six by six matrices.
constexpr double same_sum = 1e-10;

class LaneModes : public testing::TestWithParam<AxesAndKind> {
 protected:
  /// Eleven designs: whole and partial lanes of every kernel.
  template <class Make>
  void expect_the_same(const Make& make, bool labels = true) {
    std::vector<std::unique_ptr<LinearModel>> models;
    for (int k = 0; k < 11; ++k) models.push_back(make());
    for (const auto& kernels : study::usable_kernels()) {
      SCOPED_TRACE(fmt::format("{} lanes", kernels.lanes));
      LaneComparison comparison;
      comparison.add(kernels, models);
      EXPECT_EQ(comparison.alone, 0);
      EXPECT_LE(comparison.frequency, same_frequency);
      EXPECT_LE(comparison.sum_of_mass, same_sum);
      if (labels) {
        EXPECT_EQ(comparison.labels, 0) << comparison.different;
      }
    }
  }
  Random random_{2101};
};

TEST_P(LaneModes, OfRandomMachinesAreTheSame) {
  const auto [axes, kind] = GetParam();
  for (int trial = 0; trial < 20; ++trial)
    expect_the_same([&] {
      return lane_model(random_, axes, kind, trial % 2 == 0 ? Gravity::none : Gravity::down);
    });
}

/// Equal legs on both sides of a plane of symmetry hold equal energies: which of them a label names
/// is left to rounding.
TEST_P(LaneModes, OfEqualLegsAreTheSame) {
  const auto [axes, kind] = GetParam();
  for (const double spread : {0.0, 1e-6, 1e-3})
    expect_the_same([&] { return lane_model(random_, axes, kind, Gravity::none, spread); },
                    spread > 0.0);
}

TEST_P(LaneModes, OfBuckledLegsAreNegativeToo) {
  const auto [axes, kind] = GetParam();
  if (kind == ModelKind::rigid) return;
  std::vector<std::unique_ptr<LinearModel>> models;
  for (int k = 0; k < 9; ++k) {
    models.push_back(lane_model(random_, axes, kind, Gravity::down));
    models.back()->K(6, 6) *= -1.0;  // a leg that folds
  }
  for (const auto& kernels : study::usable_kernels()) {
    LaneComparison comparison;
    comparison.add(kernels, models);
    EXPECT_EQ(comparison.buckled, 9);
  }
}

/// Bit for bit: a row of a study is the same whatever stands beside it.
TEST_P(LaneModes, DoNotDependOnTheDesignsBeside) {
  const auto [axes, kind] = GetParam();
  std::vector<std::unique_ptr<LinearModel>> models;
  for (int k = 0; k < 8; ++k)
    models.push_back(lane_model(random_, axes, kind, Gravity::none,
                                k % 3 == 0 ? std::optional(0.0) : std::nullopt));
  for (const auto& kernels : study::usable_kernels()) {
    std::vector<const LinearModel*> all;
    for (const auto& model : models) all.push_back(model.get());
    std::vector<modal::NormalModes> together(all.size()), alone(1);
    std::array<bool, 8> sound{};
    study::solve_in_lanes(kernels, all, together, sound);
    for (std::size_t k = 0; k < all.size(); ++k) {
      ASSERT_TRUE(sound[k]);
      study::solve_in_lanes(kernels, std::span(all).subspan(k, 1), alone,
                            std::span(sound).subspan(k, 1));
      EXPECT_EQ(together[k].omega2, alone[0].omega2);
      EXPECT_EQ(together[k].shapes, alone[0].shapes);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, LaneModes,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// A mass matrix that is not positive definite spoils its own lane alone.
TEST(LaneModesOfImpossibleMasses, AreLeftToOneAtATime) {
  Random random(3);
  std::vector<std::unique_ptr<LinearModel>> models;
  for (int k = 0; k < 8; ++k)
    models.push_back(
        lane_model(random, model::FlexibleAxes::transverse, ModelKind::guide, Gravity::none));
  models[3]->M(6, 6) = -1.0;
  for (const auto& kernels : study::usable_kernels()) {
    LaneComparison comparison;
    comparison.add(kernels, models);
    EXPECT_EQ(comparison.alone, 1);
    EXPECT_LE(comparison.frequency, same_frequency);
  }
}

TEST(LaneModesOfDifferentKinds, AreRefused) {
  Random random(4);
  const auto guide = lane_model(random, model::FlexibleAxes::transverse, ModelKind::guide,
                                Gravity::none),
             rigid = lane_model(random, model::FlexibleAxes::transverse, ModelKind::rigid,
                                Gravity::none);
  const std::array<const LinearModel*, 2> models{guide.get(), rigid.get()};
  std::vector<modal::NormalModes> modes(2);
  std::array<bool, 2> sound{};
  EXPECT_THROW(study::modes_in_lanes(models, modes, sound), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::test
