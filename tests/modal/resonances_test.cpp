/// What a pose comes down to in maps: against the definitions with Eigen's dense solver, which the
/// library's modes do not use.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Dense {
  MatrixXd M{}, shapes{};
  VectorXd omega{};
  explicit Dense(const dynamics::LinearModel& model) : M(model.M) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(model.K), M);
    shapes = solver.eigenvectors();
    omega = solver.eigenvalues().cwiseSqrt();
  }
  /// (M⁻¹)_dd.
  [[nodiscard]] double all(int d) const { return MatrixXd(M.inverse())(d, d); }
  [[nodiscard]] double residue(int d, Eigen::Index k) const { return shapes(d, k) * shapes(d, k); }
  /// Lowest mode with `share` of (M⁻¹)_dd in its residue.
  [[nodiscard]] Eigen::Index first(int d, double share) const {
    for (Eigen::Index k = 0; k < omega.size(); ++k)
      if (residue(d, k) >= share * all(d)) return k;
    return -1;
  }
  /// |direct receptance| at ω_k of a mode with the damping ratio ζ, the mode alone.
  [[nodiscard]] double peak(int d, Eigen::Index k, double zeta) const {
    return residue(d, k) / (2.0 * zeta * omega[k] * omega[k]);
  }
};

class Resonances : public testing::TestWithParam<ModelKind> {};

TEST_P(Resonances, AreThoseOfTheirDefinitions) {
  Random random(4711);
  for (int n = 0; n < 20; ++n) {
    const auto machine =
        random_machine(random, {.gravity = n % 2 == 0 ? Gravity::none : Gravity::down});
    const auto& X_BP = machine.poses[1].X_BP;
    const auto flexible = dynamics::linear_model(machine, X_BP, GetParam());
    const auto rigid = dynamics::linear_model(machine, X_BP, ModelKind::rigid);
    const double share = random.uniform(0.03, 0.4);
    const auto found = modal::resonances(flexible, modal::normal_modes(flexible),
                                         modal::normal_modes(rigid), share);
    const Dense all(flexible), stiff(rigid);
    for (int d = 0; d < 6; ++d) {
      const auto k = all.first(d, share), r = stiff.first(d, share);
      if (k < 0 || r < 0) {  // no mode holds so much of it
        for (const auto* none : {&found.first, &found.drops, &found.shares, &found.peaks})
          EXPECT_TRUE(std::isnan((*none)[d])) << n << ' ' << d;
        continue;
      }
      const double first = all.omega[k], peak = all.peak(d, k, 0.017) / stiff.peak(d, r, 0.017);
      EXPECT_NEAR(found.first[d], first, 1e-9 * first) << n << ' ' << d;
      EXPECT_NEAR(found.drops[d], 1.0 - first / stiff.omega[r], 1e-9) << n << ' ' << d;
      EXPECT_NEAR(found.shares[d], all.residue(d, k) / all.all(d), 1e-9) << n << ' ' << d;
      EXPECT_NEAR(found.peaks[d], peak, 1e-8 * peak) << n << ' ' << d;
    }
    // the lowest mode of a random machine moves the platform
    EXPECT_NEAR(found.lowest, all.omega[0], 1e-9 * found.lowest);
    const VectorXd phi = all.shapes.col(0).head<6>();
    Eigen::Index main = 0;
    phi.cwiseProduct(flexible.platform_mass * phi).maxCoeff(&main);
    EXPECT_EQ(found.direction, main);
    const VectorXd momentum = all.M.topRows<6>() * all.shapes.col(0);
    Eigen::Index like = 0;
    (stiff.shapes.transpose() * momentum).cwiseAbs().maxCoeff(&like);
    EXPECT_NEAR(found.drop, 1.0 - all.omega[0] / stiff.omega[like], 1e-9);
    const double mac = std::pow(stiff.shapes.col(like).dot(momentum), 2);
    EXPECT_NEAR(found.share, mac, 1e-9);
    EXPECT_NEAR(found.peak, mac * std::pow(stiff.omega[like] / all.omega[0], 2), 1e-8 * found.peak);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Resonances, testing::Values(ModelKind::guide, ModelKind::full));

TEST(Stroke, ThatIsLeftIsTheLeastOfAllLegsInBothSenses) {
  Random random(12);
  auto machine = random_machine(random);
  const auto& X_BP = machine.poses[1].X_BP;
  EXPECT_TRUE(std::isnan(kinematics::stroke_left(
      [&] {
        auto without = machine;
        for (auto& leg : without.legs) leg.stroke.reset();
        return without;
      }(),
      X_BP)));
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[static_cast<std::size_t>(i)];
    const double extended = (X_BP * leg.platform_joint - leg.base_joint).norm() - leg.rod.length;
    // 31 mm from one end, much farther from the other
    leg.stroke = model::Stroke{.retracted = extended - 0.031 - 0.01 * i, .length = 0.4};
  }
  EXPECT_NEAR(kinematics::stroke_left(machine, X_BP), 0.031, 1e-12);
  auto& fourth = *machine.legs[3].stroke;
  fourth.retracted -= 0.4 - 0.061 - 0.023;  // now 23 mm from the other end
  EXPECT_NEAR(kinematics::stroke_left(machine, X_BP), 0.023, 1e-12);
}

}  // namespace
}  // namespace hydrapod::test
