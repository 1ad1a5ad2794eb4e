/// What the frequencies must not depend on, and what symmetry demands of them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/published_machine.hpp"
#include "support/random_machine.hpp"
#include "support/transformed_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using model::FlexibleAxes;
using spatial::Matrix3;
using spatial::Vector3;

Eigen::VectorXd lambda_of(const model::Machine& machine, ModelKind kind, std::size_t pose = 0) {
  const auto model = dynamics::linear_model(machine, machine.poses[pose].X_BP, kind);
  return omega_squared(model.M, model.K);
}

/// With gravity both descriptions find their equilibrium to about 1e-11 of the weight.
double tolerance(const model::Machine& machine) { return machine.gravity.isZero() ? 1e-13 : 1e-10; }

class Invariance : public testing::TestWithParam<AxesAndKind> {
 protected:
  /// Frequencies of random machines must survive `change(machine)`.
  template <class Change>
  void expect_unchanged_by(const Change& change) {
    const auto [axes, kind] = GetParam();
    double worst = 0.0, worst_under_gravity = 0.0;
    for (int i = 0; i < 40; ++i) {
      const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::anywhere;
      const auto machine = random_machine(random_, {.axes = axes, .gravity = gravity});
      const auto changed = change(machine);
      const double error =
          worst_frequency_error(lambda_of(changed, kind, 1), lambda_of(machine, kind, 1));
      EXPECT_LE(error, tolerance(machine)) << "machine " << i;
      auto& seen = gravity == Gravity::none ? worst : worst_under_gravity;
      seen = std::max(seen, error);
    }
    RecordProperty("worst",
                   fmt::format("{:.1e}, under gravity {:.1e}", worst, worst_under_gravity));
  }
  Random random_{1815};
};

TEST_P(Invariance, TurningTheWholeMachineAboutZChangesNothing) {
  expect_unchanged_by([&](const model::Machine& machine) {
    const double angle = random_.uniform(-std::numbers::pi, std::numbers::pi);
    return turned(machine, spatial::rotation_from_vector({0.0, 0.0, angle}));
  });
}

TEST_P(Invariance, TurningTheWholeMachineAnyWayChangesNothing) {
  expect_unchanged_by(
      [&](const model::Machine& machine) { return turned(machine, random_.rotation()); });
}

TEST_P(Invariance, ThePlatformFrameMayBeAnywhere) {
  expect_unchanged_by([&](const model::Machine& machine) {
    return with_other_platform_frame(machine, random_.vector(0.5), random_.rotation());
  });
}

TEST_P(Invariance, TheOrderOfTheLegsDoesNotMatter) {
  expect_unchanged_by([&](model::Machine machine) {
    std::rotate(machine.legs.begin(), machine.legs.begin() + 2, machine.legs.end());
    std::swap(machine.legs[0], machine.legs[3]);
    return machine;
  });
}

TEST_P(Invariance, TransverseAxesDoNotSeeTheGimbals) {
  const auto axes = std::get<0>(GetParam());
  expect_unchanged_by([&](model::Machine machine) {
    if (axes == FlexibleAxes::gimbal) return machine;
    const auto legs = kinematics::inverse_kinematics(machine, machine.poses[1].X_BP);
    for (int i = 0; i < model::leg_count; ++i)
      machine.legs[i].gimbal_axis = i < 2 ? legs[i].n : random_.direction();
    return machine;
  });
}

INSTANTIATE_TEST_SUITE_P(, Invariance,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// The published machine with equal piston rings: threefold symmetry with mirror planes.
model::Machine symmetric_machine(double gravity) {
  auto machine = published_machine();
  machine.flexible_axes = FlexibleAxes::transverse;
  machine.gravity = {0.0, 0.0, -gravity};
  for (auto& leg : machine.legs) leg.piston_ring = model::PistonRing{.stiffness = 5e5};
  return machine;
}

/// Number of neighbours in the sorted list that agree to `tolerance`.
int count_repeated(const Eigen::VectorXd& lambda, double tolerance) {
  int repeated = 0;
  for (Eigen::Index i = 1; i < lambda.size(); ++i)
    repeated += std::abs(lambda[i] / lambda[i - 1] - 1.0) < tolerance;
  return repeated;
}

TEST(SymmetricMachine, HasRepeatedPairs) {
  // 6 platform coordinates and 12 tilts (and 12 offsets) split into one-dimensional symmetry
  // classes and pairs: 2 pairs of the platform, 4 of the tilts, 4 of the offsets. Besides, a leg
  // that bends out of its vertical plane pushes its platform joint horizontally; six such forces in
  // one plane have rank three, so three combinations (a pair and a single one) are not felt by the
  // platform and keep together.
  constexpr double same = 1e-11;
  EXPECT_EQ(count_repeated(lambda_of(symmetric_machine(9.81), ModelKind::rigid), same), 2);
  EXPECT_EQ(count_repeated(lambda_of(symmetric_machine(9.81), ModelKind::guide), same), 6 + 1);
  EXPECT_EQ(count_repeated(lambda_of(symmetric_machine(9.81), ModelKind::full), same), 10 + 2);
}

TEST(SymmetricMachine, HasSixSealModesThatThePlatformCannotFeel) {
  // Without gravity, they stay exactly at the frequency of a knee between fixed joints.
  const auto machine = symmetric_machine(0.0);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto& leg = model.legs[0];
  const double alone = leg.K(3, 3) / leg.M(3, 3);
  const Eigen::VectorXd lambda = omega_squared(model.M, model.K);
  EXPECT_EQ(((lambda.array() / alone - 1.0).abs() < 1e-12).count(), 6);
}

}  // namespace
}  // namespace hydrapod::test
