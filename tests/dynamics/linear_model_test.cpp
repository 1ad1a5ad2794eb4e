/// The assembled models: what is in them, what they are called, what they refuse.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/kinds.hpp"
#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using testing::ElementsAre;

TEST(LinearModel, NamesItsCoordinates) {
  EXPECT_THAT(dynamics::coordinate_names(ModelKind::rigid),
              ElementsAre("x", "y", "z", "rx", "ry", "rz"));
  const auto guide = dynamics::coordinate_names(ModelKind::guide);
  ASSERT_EQ(guide.size(), 18U);
  EXPECT_EQ(guide[6], "leg1.phi1");
  EXPECT_EQ(guide[17], "leg6.phi2");
  const auto full = dynamics::coordinate_names(ModelKind::full);
  ASSERT_EQ(full.size(), 30U);
  EXPECT_EQ(full[9], "leg1.u2");
  EXPECT_EQ(full[26], "leg6.phi1");
  EXPECT_STREQ(dynamics::name(ModelKind::rigid), "rigid");
  EXPECT_STREQ(dynamics::name(ModelKind::guide), "guide");
  EXPECT_STREQ(dynamics::name(ModelKind::full), "full");
}

TEST(LinearModel, FullNeedsEveryPistonRing) {
  auto machine = published_machine();
  for (auto& leg : machine.legs) leg.piston_ring = model::PistonRing{.stiffness = 1e6};
  EXPECT_NO_THROW(dynamics::linear_model(machine, machine.neutral(), ModelKind::full));
  machine.legs[2].piston_ring.reset();
  EXPECT_NO_THROW(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
  try {
    dynamics::linear_model(machine, machine.neutral(), ModelKind::full);
    FAIL() << "nothing thrown";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "the full model needs legs.piston_ring.stiffness; leg 3 has none");
  }
}

class LinearModels : public testing::TestWithParam<AxesAndKind> {};

TEST_P(LinearModels, AreSymmetricAndSoftOnlyWhereSpringsAre) {
  const auto [axes, kind] = GetParam();
  Random random(12);
  for (int i = 0; i < 20; ++i) {
    const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::anywhere;
    const auto machine = random_machine(random, {.axes = axes, .gravity = gravity});
    const auto model = dynamics::linear_model(machine, machine.poses[1].X_BP, kind);
    constexpr double rounding = 1e-14;
    for (const auto* A : {&model.M, &model.K, &model.C}) {
      ASSERT_EQ(A->rows(), dynamics::degrees_of_freedom(kind));
      EXPECT_LE((*A - A->transpose()).norm(), rounding * A->norm());
      // Legs know of each other only through the platform.
      const int n = dynamics::flexible_per_leg(kind);
      EXPECT_TRUE(
          A->block(model.first_of_leg(0), model.first_of_leg(n > 0 ? 4 : 0), n, n).isZero(0.0));
    }
  }
}

TEST_P(LinearModels, RayleighDampingAddsToTheDampers) {
  const auto [axes, kind] = GetParam();
  Random random(13);
  auto machine = random_machine(random, {.axes = axes});
  const auto dampers = dynamics::linear_model(machine, machine.neutral(), kind);
  machine.damping.rayleigh_mass = 0.3;
  machine.damping.rayleigh_stiffness = 2e-4;
  machine.damping.modal_ratio = 0.05;  // not in C
  const auto both = dynamics::linear_model(machine, machine.neutral(), kind);
  const dynamics::ModelMatrix expected = dampers.C + 0.3 * both.M + 2e-4 * both.K;
  EXPECT_LE((both.C - expected).norm(), 1e-15 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(, LinearModels,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
