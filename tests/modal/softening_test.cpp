/// Elastomers that amplitudes soften, in machines whose seals carry a load at rest.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

constexpr double softening = 0.37;

/// `softening_amplitude` far below every motion: all that can soften has.
model::Machine heavy_machine(double softening_amplitude) {
  auto machine = symmetric_machine(9.81);
  machine.damping.modal_ratio = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    leg.guide_sleeve.stiffness *= 2.1 + 0.1 * static_cast<double>(i);
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.6,
                                  .loss_factor = 0.17,
                                  .frequency = 8.3,
                                  .softening = softening,
                                  .softening_amplitude = softening_amplitude};
    leg.piston_ring->elastomer = leg.guide_sleeve.elastomer;
  }
  return machine;
}

/// K at ω where every seal has 1 − softening of k'(ω): of its spring and of its arms.
Eigen::MatrixXd soft_stiffness(const dynamics::LinearModel& model, double omega) {
  Eigen::MatrixXd K = model.K;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = model.legs[static_cast<std::size_t>(i)];
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::VectorXd sleeve = dynamics::per_coordinate(model, i, leg.d_x.row(axis));
      const Eigen::VectorXd ring = dynamics::per_coordinate(model, i, leg.u_x.row(axis));
      K -= softening * (leg.k_s * sleeve * sleeve.transpose() + leg.k_g * ring * ring.transpose());
    }
  }
  for (const auto& arm : model.arms)
    K -= (1.0 - softening) * dynamics::softening_at(arm, omega) * arm.s_y * arm.s_y.transpose();
  return K;
}

/// The load bends the legs by 0.3 mm and more at rest. Amplitudes count from there, so that small
/// motions meet whole seals; K keeps what the load does to it.
TEST(Softening, CountsFromTheRestPositionUnderLoad) {
  const auto machine = heavy_machine(4e-5);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::full);
  EXPECT_GT(model.legs[0].sleeve_offset.norm(), 3e-4);
  auto ideal = machine;
  for (auto& leg : ideal.legs) {
    leg.guide_sleeve.elastomer->softening = 0.0;
    leg.piston_ring->elastomer->softening = 0.0;
  }
  const std::vector<double> small{1e-11};
  const auto& X_BP = machine.neutral();
  const auto found = modal::modes_at_amplitudes(machine, X_BP, ModelKind::full, small);
  const auto wanted = modal::modes_at_amplitudes(ideal, X_BP, ModelKind::full, small);
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    ASSERT_TRUE(found[k].points[0].converged);
    // (1e-11 / 4e-5)^1.2 of the softening is there
    EXPECT_NEAR(found[k].points[0].omega, wanted[k].points[0].omega,
                1e-7 * wanted[k].points[0].omega);
  }
}

TEST(Softening, OfLargeMotionsLeavesTheLoadsStiffness) {
  const auto machine = heavy_machine(1e-15);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::full);
  const std::vector<double> amplitudes{3.1e-3};
  const auto curves =
      modal::modes_at_amplitudes(machine, machine.neutral(), ModelKind::full, amplitudes);
  ASSERT_GE(curves.size(), 6U);
  for (const auto& curve : curves) {
    const auto& point = curve.points[0];
    ASSERT_TRUE(point.converged);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        soft_stiffness(model, point.omega), Eigen::MatrixXd(model.M), Eigen::EigenvaluesOnly);
    const double omega2 = point.omega * point.omega;
    const double nearest = (solver.eigenvalues().array() - omega2).abs().minCoeff();
    EXPECT_LT(nearest, 1e-8 * omega2) << point.omega;
  }
}

}  // namespace
}  // namespace hydrapod::test
