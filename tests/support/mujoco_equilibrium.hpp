#pragma once
/// Static equilibrium and stiffness of a loaded hexapod from MuJoCo's kinematics and gravity.
///
/// The platform's pose is given; leg coordinates, oil forces and constraint forces follow by Newton
/// on the whole mechanism at once. The seal is a frictionless lateral spring in the plane of the
/// guide sleeve, fixed to the case: the offset d_s of the rod's axis in that plane gives a force
/// −k_s d_s across, and with it whatever is needed along the case to stay normal to the rod. A
/// guide ring adds k_c (|d_s| − gap) along d_s beyond its gap.

#include "support/mujoco_hexapod.hpp"

namespace hydrapod::test {

using spatial::Vector6;

/// Generalised forces of gravity, seals and oil, where the oil pulls each leg with `oil_force`.
VectorXd applied_force(const MujocoHexapod& hexapod, const Vector6& oil_force);

struct MujocoEquilibrium {
  MujocoHexapod hexapod;  ///< stands at the equilibrium
  Vector6 oil_force{};    ///< [N], positive when the leg is pulled
  double residual{};      ///< largest unbalanced generalised force, relative to the weight
  int iterations{};
};

/// The equilibrium of `machine` with its platform at `X_BP`, sought from straight legs. For
/// FlexibleAxes::gimbal the axes at the piston are parallel to those at the base in the
/// equilibrium.
MujocoEquilibrium mujoco_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind);

/// dof × dof, for the coordinates of MujocoHexapod::allowed_motions: differences of fourth order of
/// the generalised force along the constraint manifold, valves closed. `h`: their step [m] and
/// [rad]; their error is h⁴ times the fifth derivative, that of rounding ε/h. The hexapod is moved
/// and put back.
MatrixXd stiffness_at(MujocoEquilibrium& equilibrium, double h = 3e-4);
MatrixXd mass_at(const MujocoEquilibrium& equilibrium);
MatrixXd damping_at(const MujocoEquilibrium& equilibrium);

}  // namespace hydrapod::test
