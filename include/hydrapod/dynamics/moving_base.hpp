#pragma once
/// A base on springs under the nonlinear mechanics.
///
/// NonlinearModel stays in base coordinates: v is motion against the base. The base adds its own
/// small motion q_b = (x, y, z, rx, ry, rz) against the ground at the origin of B along its axes,
/// in the directions that have a spring. Kinetic energy, with rates v_b of q_b:
///
///     T = T_rel(v) + v_bᵀ P v + ½ v_bᵀ M_b v_b
///     M v̇ + h + Pᵀ a_b = F            M_b a_b + P v̇ + C_b v_b + K_b q_b = Tᵀ w
///
/// P v is the momentum of platform and legs about the origin of B in their motion against it, M_b
/// the inertia about it of base, platform and legs locked together, w a wrench on the platform and
/// T what brings it to the origin. P and M_b are taken where the machine rests at the reference
/// pose and kept: exact for small motions about it, and energy is kept in large ones too. Gravity
/// on a base that tilts is left out (as in the linear models), its weight is carried by what the
/// springs are compressed where q_b = 0.
///
/// Damping: 2 ζ √(k M_b,kk) beside each spring, ζ being `damping.modal_ratio` (2 % where the file
/// says none) as for seals, and Rayleigh's β k.
///
/// A base with next to no inertia would vibrate far above everything that matters and cost an
/// integrator its steps. Where the base, platform and ground held, would vibrate faster than
/// `fastest` times the machine's highest rigid frequency, its inertia in that motion is raised
/// until it does not. What this adds to the energy of a mode at ω is of the order (ω/ω_base)² times
/// the legs' stiffness over the mount's.

#include "hydrapod/dynamics/nonlinear.hpp"

namespace hydrapod::dynamics {

struct MovingBase {
  static constexpr double fastest = 20.0;  ///< times the highest rigid frequency on a still base

  std::array<int, 6> directions{};  ///< that give way, the first `count`
  int count{};
  BaseCoupling coupling{};             ///< P; M_b with the base's own inertia
  Vector6 stiffness{Vector6::Zero()};  ///< K_b [N/m, N m/rad], 0 where the base does not give way
  Vector6 damping{Vector6::Zero()};    ///< C_b [N s/m, N m s/rad]
  Matrix6 added_inertia{Matrix6::Zero()};  ///< the part of M_b that only keeps it slow

  /// ½ v_bᵀ M_b v_b + v_bᵀ P v [J].
  [[nodiscard]] double kinetic_energy(const Vector6& rates, const double* v) const;
  /// ½ q_bᵀ K_b q_b [J].
  [[nodiscard]] double elastic_energy(const Vector6& motion) const;
  /// a_b, zero where the base does not give way. `v_rate`: v̇ on a base that stands still,
  /// `per_base`: v̇ per a_b (NonlinearModel::accelerations), `wrench` on the platform about `p_BC`.
  [[nodiscard]] Vector6 acceleration(const Vector6& motion, const Vector6& rates,
                                     const double* v_rate, const BaseResponse& per_base,
                                     const Vector6& wrench, const Vector3& p_BC) const;
};

/// The base of `model`'s machine, which must have a `base_mount`, with the mechanism at rest at
/// `y`.
MovingBase moving_base(const NonlinearModel& model, const double* y);

/// Motion (or velocity, or acceleration) of a point at r from the origin of B, and rotation, that
/// such a one of the base gives it.
Vector6 carried(const Vector6& base, const Vector3& r);

}  // namespace hydrapod::dynamics
