#pragma once
/// The exact leg: large tilt and offset, gravity, preload. Derivation: docs/theory/leg.md, "The
/// bent leg".
///
/// In the case frame (t, a2, n) the platform joint stands at s n + u + l_mn e(φ), where s is the
/// piston's position along the case and e = Rot(t, φ1) Rot(a2, φ2) n the rod's direction. Given the
/// joint in B, s has a closed form and so have the gimbal's two angles, so (a, φ, u) are
/// coordinates of the leg without constraints. Its potential energy is
///
///     V = f s + ½ k_s |d_s|² + ½ k_g |u|² − m_t g·p_t − m_g g·p_g,   d_s = u + (L_g − s) e⊥ /
///     (e·n)
///
/// with f the force of the oil on the piston (positive in tension). First and second derivatives
/// are analytic: those in the chart (case angles, s, φ, u), where everything is elementary, brought
/// to (a, φ, u) with the joint force λ = ∂V/∂a:  K = Tᵀ [∂²V − λ·∂²a] T,  T = ∂(chart)/∂(a, φ, u).

#include "hydrapod/dynamics/leg_element.hpp"

namespace hydrapod::dynamics {

using Vector2 = Eigen::Vector2d;
using Vector4 = Eigen::Vector4d;

/// Where the inner coordinates of a leg stand, and what the oil holds.
struct LegState {
  Vector4 flexible{Vector4::Zero()};  ///< (φ1, φ2 [rad], u1, u2 [m])
  double oil_force{};                 ///< f [N], positive when the leg is pulled
};

/// The leg at a state that need not be an equilibrium.
struct BentLeg {
  LegElement
      element{};  ///< K holds the geometric terms of preload and gravity; frame: that of the case
  bool exists{true};  ///< false: no extension closes this leg (folded too far); nothing else is set
  Vector3 joint_force{Vector3::Zero()};  ///< λ = ∂V/∂a in B [N]: what the platform must bring
  Vector4 flexible_gradient{Vector4::Zero()};  ///< ∂V/∂(φ, u) at a fixed joint [N m, N]
  Matrix7 K_without_oil{Matrix7::Zero()};      ///< second derivative at constant oil force
};

/// `a`: platform joint in B [m]; `gravity` in B [m/s²].
BentLeg bent_leg(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                 const Vector3& gravity, const LegState& state);

}  // namespace hydrapod::dynamics
