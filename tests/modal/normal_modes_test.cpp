/// Undamped modes: against LAPACK, against closed forms, and the canonical basis.

#include "hydrapod/modal/normal_modes.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lapacke.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "exact/symmetric_hexapod.hpp"
#include "hydrapod/base/error.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"
#include "support/transformed_machine.hpp"

/// OpenBLAS, where LAPACK is that, would spread such small matrices over threads that spin.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using modal::NormalModes;
using model::FlexibleAxes;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

dynamics::LinearModel linear(const model::Machine& machine, ModelKind kind) {
  return dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
}

Eigen::VectorXd lapack_omega2(const dynamics::LinearModel& model) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
  Eigen::MatrixXd K = model.K, M = model.M;
  const int n = model.dof();
  Eigen::VectorXd omega2(n);
  const int info =
      LAPACKE_dsygvd(LAPACK_COL_MAJOR, 1, 'V', 'U', n, K.data(), n, M.data(), n, omega2.data());
  EXPECT_EQ(info, 0);
  return omega2;
}

class RandomMachines : public testing::TestWithParam<AxesAndKind> {
 protected:
  template <class Claim>
  void for_each(int count, const Claim& claim) {
    const auto [axes, kind] = GetParam();
    for (int i = 0; i < count; ++i) {
      SCOPED_TRACE(fmt::format("machine {}", i));
      const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::down;
      claim(linear(random_machine(random_, {.axes = axes, .gravity = gravity}), kind));
    }
  }
  Random random_{1604};
};

/// Both solvers are backward stable: ω² to some epsilons of the largest one.
TEST_P(RandomMachines, HaveTheFrequenciesOfLapack) {
  constexpr double rounding = 500 * epsilon;
  double worst = 0.0;
  for_each(40, [&](const auto& model) {
    const auto modes = modal::normal_modes(model);
    const Eigen::VectorXd expected = lapack_omega2(model);
    const double error = (modes.omega2 - expected).cwiseAbs().maxCoeff() / expected.maxCoeff();
    EXPECT_LE(error, rounding);
    worst = std::max(worst, error);
  });
  RecordProperty("worst_in_epsilon", fmt::format("{:.1f}", worst / epsilon));
}

/// In coordinates weighted with the roots of the masses, where metres and radians compare.
TEST_P(RandomMachines, ModesSolveTheEquationOfMotion) {
  constexpr double rounding = 500 * epsilon;
  double worst = 0.0, worst_of_own = 0.0;
  for_each(40, [&](const auto& model) {
    const auto modes = modal::normal_modes(model);
    const auto weight = model.M.diagonal().cwiseSqrt().cwiseInverse().eval();
    for (int k = 0; k < modes.size(); ++k) {
      const auto phi = modes.shapes.col(k);
      const dynamics::ModelVector force = weight.cwiseProduct(model.K * phi);
      const dynamics::ModelVector left =
          force - modes.omega2[k] * weight.cwiseProduct(model.M * phi);
      EXPECT_LE(left.norm(), rounding * modes.omega2.cwiseAbs().maxCoeff());
      worst = std::max(worst, left.norm() / modes.omega2.cwiseAbs().maxCoeff());
      worst_of_own = std::max(worst_of_own, left.norm() / force.norm());
      constexpr double small = 1e-9;
      EXPECT_LE(left.norm(), small * force.norm()) << "mode " << k;
    }
  });
  RecordProperty("worst_in_epsilon", fmt::format("{:.1f}", worst / epsilon));
  RecordProperty("worst_against_K_phi", fmt::format("{:.1e}", worst_of_own));
}

TEST_P(RandomMachines, ShapesAreOrthonormalInMAndDiagonaliseK) {
  constexpr double rounding = 500 * epsilon;
  double worst = 0.0;
  for_each(40, [&](const auto& model) {
    const auto modes = modal::normal_modes(model);
    const int n = modes.size();
    const Eigen::MatrixXd mass = modes.shapes.transpose() * model.M * modes.shapes;
    const double error = (mass - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff();
    EXPECT_LE(error, rounding);
    worst = std::max(worst, error);
    Eigen::MatrixXd K = modes.shapes.transpose() * model.K * modes.shapes;
    K.diagonal() -= modes.omega2;
    EXPECT_LE(K.cwiseAbs().maxCoeff(), rounding * modes.omega2.cwiseAbs().maxCoeff());
    EXPECT_TRUE(std::is_sorted(modes.omega2.begin(), modes.omega2.end()));
  });
  RecordProperty("worst_in_epsilon", fmt::format("{:.1f}", worst / epsilon));
}

INSTANTIATE_TEST_SUITE_P(, RandomMachines,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// ω² of the mode whose platform moves most in `direction` with respect to `total` of it.
std::vector<double> modes_in(const NormalModes& modes, int direction) {
  std::vector<double> found;
  for (int k = 0; k < modes.size(); ++k) {
    const spatial::Vector6 q = modes.shapes.col(k).head<6>();
    if (std::abs(q[direction]) > 0.99 * q.norm() && q.norm() > 1e-6)
      found.push_back(modes.omega2[k]);
  }
  return found;
}

TEST(SymmetricHexapod, HeaveAndYawAreThoseOfTheClosedForm) {
  Random random(7);
  constexpr double rounding = 1e-12;  // some epsilons times ω²_max / ω²
  for (int i = 0; i < 50; ++i) {
    auto machine = symmetric_machine();
    const double k_s = random.log_uniform(1e4, 1e7), m_t = random.log_uniform(1.0, 100.0);
    for (auto& leg : machine.legs) {
      leg.guide_sleeve.stiffness = k_s;
      leg.cylinder_case.mass = m_t;
      leg.added_axial_inertia = 0.3 * m_t;
    }
    const SymmetricHexapod exact(machine);
    const auto rigid = modal::normal_modes(linear(machine, ModelKind::rigid));
    EXPECT_NEAR(modes_in(rigid, 2).at(0) / exact.heave_rigid(), 1.0, rounding);
    EXPECT_NEAR(modes_in(rigid, 5).at(0) / exact.yaw_rigid(), 1.0, rounding);
    const auto guide = modal::normal_modes(linear(machine, ModelKind::guide));
    const auto heave = modes_in(guide, 2), yaw = modes_in(guide, 5);
    ASSERT_EQ(heave.size(), 2U);
    ASSERT_EQ(yaw.size(), 2U);
    for (size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(heave[k] / exact.heave()[k], 1.0, rounding);
      EXPECT_NEAR(yaw[k] / exact.yaw()[k], 1.0, rounding);
    }
  }
}

TEST(SymmetricHexapod, SixKneesStayWhereTheyAreBetweenFixedJoints) {
  const auto machine = symmetric_machine();
  const SymmetricHexapod exact(machine);
  const auto modes = modal::normal_modes(linear(machine, ModelKind::guide));
  const double knee = exact.knee_stiffness() / exact.knee_mass();
  int found = 0;
  for (int k = 0; k < modes.size(); ++k) {
    if (std::abs(modes.omega2[k] / knee - 1.0) > 1e-12) continue;
    ++found;
    EXPECT_LE(modes.shapes.col(k).head<6>().norm(), 1e-9) << "the platform rests";
  }
  EXPECT_EQ(found, 6);
}

class CanonicalBasis : public testing::TestWithParam<ModelKind> {
 protected:
  model::Machine machine_ = symmetric_machine();
};

/// Shapes to half the digits: the basis of a group is as good as its separation from the others.
constexpr double same_shape = 1e-7;

TEST_P(CanonicalBasis, IsFoundFromAnyMixOfARepeatedGroup) {
  const auto model = linear(machine_, GetParam());
  const auto modes = modal::normal_modes(model);
  Random random(11);
  for (int trial = 0; trial < 20; ++trial) {
    NormalModes mixed = modes;
    for (int first = 0; first < modes.size();) {
      int size = 1;
      while (first + size < modes.size() && modes.group[first + size] == modes.group[first]) ++size;
      Eigen::MatrixXd any(size, size);
      for (auto& value : any.reshaped()) value = random.uniform(-1.0, 1.0);
      const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ();
      mixed.shapes.middleCols(first, size) = (mixed.shapes.middleCols(first, size) * Q).eval();
      first += size;
    }
    modal::make_canonical(model.M.diagonal(), mixed);
    const auto weight = model.M.diagonal().cwiseSqrt();
    EXPECT_LE((weight.asDiagonal() * (mixed.shapes - modes.shapes)).cwiseAbs().maxCoeff(),
              same_shape);
    EXPECT_EQ(mixed.group, modes.group);
  }
}

TEST_P(CanonicalBasis, DoesNotDependOnHowTheMachineIsTurned) {
  const auto modes = modal::normal_modes(linear(machine_, GetParam()));
  Random random(12);
  for (int trial = 0; trial < 10; ++trial) {
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    const auto R = spatial::rotation_from_vector({0.0, 0.0, angle});
    // turned bodily, and the platform frame turned back, so that its motion is told in B as before
    const auto turned_modes = modal::normal_modes(linear(turned(machine_, R), GetParam()));
    EXPECT_LE((turned_modes.shapes.topRows<6>() - modes.shapes.topRows<6>()).cwiseAbs().maxCoeff(),
              same_shape);
  }
}

TEST_P(CanonicalBasis, DoesNotDependOnTheNumbersOfTheLegs) {
  const auto modes = modal::normal_modes(linear(machine_, GetParam()));
  auto renumbered = machine_;
  std::rotate(renumbered.legs.begin(), renumbered.legs.begin() + 2, renumbered.legs.end());
  const auto other = modal::normal_modes(linear(renumbered, GetParam()));
  EXPECT_LE((other.shapes.topRows<6>() - modes.shapes.topRows<6>()).cwiseAbs().maxCoeff(),
            same_shape);
}

TEST_P(CanonicalBasis, HasXBeforeYAndPositiveSigns) {
  const auto model = linear(machine_, GetParam());
  const auto modes = modal::normal_modes(model);
  int pairs = 0;
  for (int k = 0; k + 1 < modes.size(); ++k) {
    const bool begins = k == 0 || modes.group[k - 1] != modes.group[k];
    const spatial::Vector6 first = modes.shapes.col(k).head<6>();
    const spatial::Vector6 second = modes.shapes.col(k + 1).head<6>();
    if (!begins || modes.group[k + 1] != modes.group[k] || std::abs(first[0]) < 1e-6) continue;
    ++pairs;
    EXPECT_NEAR(first[1], 0.0, same_shape);
    EXPECT_NEAR(second[0], 0.0, same_shape);
    EXPECT_GT(std::abs(second[1]), 1e-6);
  }
  EXPECT_GE(pairs, 2);
  for (int k = 0; k < modes.size(); ++k) {
    const dynamics::ModelVector weighted =
        model.M.diagonal().cwiseSqrt().cwiseProduct(modes.shapes.col(k));
    const bool platform = weighted.head<6>().cwiseAbs().maxCoeff() > 1e-4;
    const auto part = platform ? weighted.head(6) : weighted.head(weighted.size());
    EXPECT_NEAR(part.maxCoeff(), part.cwiseAbs().maxCoeff(), 1e-5) << "mode " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(, CanonicalBasis,
                         testing::Values(ModelKind::rigid, ModelKind::guide, ModelKind::full),
                         [](const auto& test) { return dynamics::name(test.param); });

TEST(NormalModes, SayWhatIsMissingWhenALegHasNoMass) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) {
    leg.cylinder_case = {};
    leg.rod.mass = leg.rod.transverse_inertia = leg.rod.axial_inertia = 0.0;
  }
  EXPECT_NO_THROW(modal::normal_modes(linear(machine, ModelKind::rigid)));
  try {
    modal::normal_modes(linear(machine, ModelKind::guide));
    FAIL() << "nothing thrown";
  } catch (const base::ComputationError& error) {
    EXPECT_STREQ(
        error.what(),
        "the mass matrix is not positive definite: do the platform and every leg have mass "
        "and inertia?");
  }
}

}  // namespace
}  // namespace hydrapod::test
