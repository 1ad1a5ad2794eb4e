/// Small motions of the machine that a multibody file holds, beside those of the machine itself.
///
/// Where a format has springs for single joints alone, the seals of a leg that is bent lose of
/// their Hessian H in q = (s, θ1, θ2) all but the stiffness of each hinge. With J = ∂q/∂y at rest
///
///     K_held = K − Σ Jᵀ (H − diag(0, k_θ1, k_θ2)) J
///
/// The hinges turn the rod's direction e as φ1, φ2 of the linear model do: E_θ θ̇ = E_φ φ̇.

#include <Eigen/Eigenvalues>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "measured.hpp"
#include "mechanism.hpp"

namespace hydrapod::exchange {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// What the format does not hold of bodies and joints is left out.
Machine held_of(Machine machine, bool joints_have_inertia) {
  machine.base_mount.reset();
  machine.payload_modes.clear();
  for (auto& leg : machine.legs) {
    if (joints_have_inertia) continue;
    leg.added_axial_inertia = leg.gimbal_cross_inertia = 0.0;
    if (auto& cylinder = leg.oil_spring.cylinder)
      cylinder->cap_line_length = cylinder->rod_line_length = 0.0;
  }
  return machine;
}

/// θ̇ per φ̇.
Eigen::Matrix2d hinges_per_tilt(const LegMechanism& leg, double phi1, double phi2) {
  const double c1 = std::cos(phi1), s1 = std::sin(phi1), c2 = std::cos(phi2), s2 = std::sin(phi2);
  MatrixXd of_hinges(3, 2), of_tilt(3, 2);
  of_hinges << leg.R_LR * leg.piston_axis.cross(Vector3::UnitZ()), leg.R_LR * Vector3::UnitX();
  of_tilt << 0.0, c2, -c1 * c2, s1 * s2, -s1 * c2, -c1 * s2;
  return numerics::least_squares(of_hinges, of_tilt);
}

/// What the seals of leg i lose of K.
MatrixXd lost(const dynamics::LinearModel& linear, const LegMechanism& leg, int i) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (const auto& [along, spring] : leg.coupled)
    H += spring.stiffness * along.head<3>() * along.head<3>().transpose();
  for (Index k = 0; k < 2; ++k) H(1 + k, 1 + k) -= leg.tilt_alone[static_cast<std::size_t>(k)];
  MatrixXd J = MatrixXd::Zero(3, linear.dof());
  const auto& state = linear.statics.legs[static_cast<std::size_t>(i)].flexible;
  J.row(0) =
      dynamics::per_coordinate(linear, i, linear.legs[static_cast<std::size_t>(i)].s_x).transpose();
  J.block<2, 2>(1, linear.first_of_leg(i)) = hinges_per_tilt(leg, state[0], state[1]);
  return J.transpose() * H * J;
}

}  // namespace

Parity measured_multibody(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind,
                          MultibodyFormat format) {
  const auto own =
      modal::modes_with_elastomers(machine, dynamics::linear_model(machine, X_BP, kind));
  const auto held = held_mechanism(machine, X_BP, kind, format);
  const auto linear =
      dynamics::linear_model(held_of(held.machine, held.coupled), X_BP, held.parts.kind);
  MatrixXd K = dynamics::slow_stiffness(linear);
  for (int i = 0; i < model::leg_count && !held.coupled; ++i)
    if (const auto& leg = held.parts.legs[static_cast<std::size_t>(i)]; !leg.coupled.empty())
      K -= lost(linear, leg, i);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K, MatrixXd(linear.M),
                                                                  Eigen::EigenvaluesOnly);
  constexpr Index lowest = 6;
  return {measured("six lowest frequencies, computed",
                   frequency_difference(own.omega2, solver.eigenvalues(), lowest),
                   "those of `modes`, undamped")};
}

}  // namespace hydrapod::exchange
