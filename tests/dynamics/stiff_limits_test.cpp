/// The larger models end in the smaller ones: exactly in M, and as 1/k in the frequencies.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using model::FlexibleAxes;

class StiffLimits : public testing::TestWithParam<FlexibleAxes> {};

TEST_P(StiffLimits, UpperLeftOfTheMassMatrixIsTheSmallerModelsExactly) {
  Random random(1604);
  for (int i = 0; i < 100; ++i) {
    const auto machine = random_machine(random, {.axes = GetParam()});
    for (const auto& pose : machine.poses) {
      const auto rigid = dynamics::linear_model(machine, pose.X_BP, ModelKind::rigid);
      const auto guide = dynamics::linear_model(machine, pose.X_BP, ModelKind::guide);
      const auto full = dynamics::linear_model(machine, pose.X_BP, ModelKind::full);
      const spatial::Matrix6 M = rigid.M;
      EXPECT_EQ((guide.M.topLeftCorner<6, 6>()), M);  // to the bit
      EXPECT_EQ((full.M.topLeftCorner<6, 6>()), M);
      EXPECT_EQ(guide.J[3], full.J[3]);
    }
  }
}

/// Slope of log(error) over log(stiffness) by least squares.
double fitted_exponent(const std::vector<double>& stiffness, const std::vector<double>& error) {
  const auto n = static_cast<double>(error.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double u = std::log(stiffness[i]), v = std::log(error[i]);
    x += u / n, y += v / n, xx += u * u / n, xy += u * v / n;
  }
  return (xy - x * y) / (xx - x * x);
}

/// Root mean square relative error of the lowest frequencies.
double frequency_error(const LinearModel& model, const Eigen::VectorXd& limit) {
  const Eigen::VectorXd lambda = omega_squared(model.M, model.K).head(limit.size());
  return ((lambda.array() / limit.array()).sqrt() - 1.0).matrix().norm() /
         std::sqrt(static_cast<double>(limit.size()));
}

/// Stiffness factors over four decades, from where the stiffened modes lie 30 times above all
/// others.
const std::vector<double> factors{1.0, 10.0, 100.0, 1000.0, 10000.0};
constexpr double separation = 30.0 * 30.0;
/// The next order of the error is 1/separation of the first at the softest point.
constexpr double exponent_tolerance = 0.01;

TEST_P(StiffLimits, RigidModesAreReachedAsOneOverTheGuideSleevesStiffness) {
  Random random(17);
  double worst = 0.0;
  for (int i = 0; i < 20; ++i) {
    auto machine = random_machine(random, {.axes = GetParam()});
    const auto& pose = machine.poses[1].X_BP;
    const auto rigid = dynamics::linear_model(machine, pose, ModelKind::rigid);
    const Eigen::VectorXd limit = omega_squared(rigid.M, rigid.K);
    std::array<double, model::leg_count> start;
    for (int leg = 0; leg < model::leg_count; ++leg) {
      const auto element = dynamics::straight_leg(
          machine.legs[leg], kinematics::inverse_kinematics(machine, pose)[leg], GetParam());
      start[leg] = separation * limit[5] * element.M(3, 3) / (element.l_mh * element.l_mh);
    }
    std::vector<double> errors;
    for (double factor : factors) {
      for (int leg = 0; leg < model::leg_count; ++leg)
        machine.legs[leg].guide_sleeve.stiffness = factor * start[leg];
      errors.push_back(
          frequency_error(dynamics::linear_model(machine, pose, ModelKind::guide), limit));
    }
    EXPECT_NEAR(fitted_exponent(factors, errors), -1.0, exponent_tolerance) << "machine " << i;
    worst = std::max(worst, std::abs(fitted_exponent(factors, errors) + 1.0));
  }
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

TEST_P(StiffLimits, GuideSleeveModesAreReachedAsOneOverThePistonRingsStiffness) {
  Random random(11);
  double worst = 0.0;
  for (int i = 0; i < 20; ++i) {
    auto machine = random_machine(random, {.axes = GetParam()});
    const auto& pose = machine.poses[1].X_BP;
    const auto guide = dynamics::linear_model(machine, pose, ModelKind::guide);
    const Eigen::VectorXd limit = omega_squared(guide.M, guide.K);
    std::vector<double> errors;
    for (double factor : factors) {
      for (int leg = 0; leg < model::leg_count; ++leg)
        machine.legs[leg].piston_ring->stiffness =
            factor * separation *
            (limit[17] * guide.legs[leg].M(5, 5) + machine.legs[leg].guide_sleeve.stiffness);
      errors.push_back(
          frequency_error(dynamics::linear_model(machine, pose, ModelKind::full), limit));
    }
    EXPECT_NEAR(fitted_exponent(factors, errors), -1.0, exponent_tolerance) << "machine " << i;
    worst = std::max(worst, std::abs(fitted_exponent(factors, errors) + 1.0));
  }
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

/// M scaled to a unit diagonal, so that its smallest eigenvalue says how far it is from indefinite.
double smallest_scaled_eigenvalue(const dynamics::ModelMatrix& M) {
  const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

TEST_P(StiffLimits, MassMatrixIsPositiveDefiniteAtAThousandPoses) {
  Random random(9);
  double smallest = 1.0;
  for (int i = 0; i < 500; ++i) {
    const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::anywhere;
    const auto machine = random_machine(random, {.axes = GetParam(), .gravity = gravity});
    for (const auto& pose : machine.poses)
      for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
        const auto model = dynamics::linear_model(machine, pose.X_BP, kind);
        EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(model.M).info(), Eigen::Success);
        EXPECT_TRUE(model.M.isApprox(model.M.transpose(), 1e-15));
        smallest = std::min(smallest, smallest_scaled_eigenvalue(model.M));
      }
  }
  EXPECT_GT(smallest, 1e-6);
  RecordProperty("smallest", fmt::format("{:.1e}", smallest));
}

INSTANTIATE_TEST_SUITE_P(, StiffLimits, both_axes(),
                         [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace hydrapod::test
