#pragma once
/// One hydraulic leg as an element: mass, damping and stiffness in its own small coordinates.
///
/// Local coordinates of a leg, seven of them, the first three shared with the platform:
///
///     x = (v_t, v_2, v_n | φ1, φ2 | u1, u2)
///
/// v_t, v_2, v_n: motion of the platform joint along the leg frame's axes t, a2, n [m]; φ1, φ2:
/// tilt of the rod about t and a2 through the piston [rad]; u1, u2: piston offset along t and a2
/// [m].
///
/// Leg frame. n along the cylinder case; a2 = (n × a1)/|n × a1| is the lower gimbal's second axis
/// and t = a2 × n, with a1 the base-fixed gimbal axis. For FlexibleAxes::transverse nothing depends
/// on a1; a leg (nearly) parallel to it gets another reference axis.
///
/// straight_leg is the theory of sections 1–7 of docs/theory/leg.md (Eqs. 1–15 of the paper): no
/// preload, φ = u = 0. bent_leg (bent_leg.hpp) is the same leg, exact, bent by gravity and preload.
///
/// The exact leg: large tilt and offset, gravity, preload. Derivation: docs/theory/leg.md, "The
/// bent leg".
///
/// In the case frame (t, a2, n) the platform joint stands at s n + u + l_mn e(φ), where s is the
/// piston's position along the case and e = Rot(t, φ1) Rot(a2, φ2) n the rod's direction. Given the
/// joint in B, s has a closed form and so have the gimbal's two angles, so (a, φ, u) are
/// coordinates of the leg without constraints. Its potential energy is
///
///     V = f s + ½ k_s |d_s|² + U_c(|d_s|) + ½ k_g |u|² − m_t g·p_t − m_g g·p_g
///     d_s = u + (L_g − s) e⊥ / (e·n)
///
/// with f the force of the oil on the piston (positive in tension) and U_c the energy of the guide
/// ring (guide_contact.hpp; zero without `guide_sleeve.gap`). First and second derivatives
/// are analytic: those in the chart (case angles, s, φ, u), where everything is elementary, brought
/// to (a, φ, u) with the joint force λ = ∂V/∂a:  K = Tᵀ [∂²V − λ·∂²a] T,  T = ∂(chart)/∂(a, φ, u).
///
/// Rods and cases that bend (model::LegBending::elastic; docs/theory/leg.md, "Rod and case that
/// bend"). φ and d_s then are those of the chords: of the rod from piston to platform joint, of the
/// case from base joint to piston. Beam theory gives the compliance f(s) between them at the
/// sleeve, in series with seal and guide ring: d_s = δ + f F, F = k_s δ + the guide ring's force,
/// and the energy ½ k_s |δ|² + U_c(|δ|) + ½ f |F|² stands in V. The rod's compression P makes f
/// larger. Inertia follows the field of the rod, chord plus bow, the bow being as large as F.

#include <Eigen/Core>
#include <optional>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::dynamics {

using spatial::Matrix3;
using spatial::Matrix6;
using spatial::Vector3;
using spatial::Vector6;

inline constexpr int leg_coordinates = 7;
using Vector7 = Eigen::Matrix<double, leg_coordinates, 1>;
using Matrix7 = Eigen::Matrix<double, leg_coordinates, leg_coordinates>;

/// Orthonormal, right-handed axes of a leg in B: columns t, a2, n.
struct LegFrame {
  Matrix3 R_BL{};
  double tan_gimbal{};  ///< (a1·n)/(a1·t), axial spin of the case per rotation about t
  double sec_gimbal{};  ///< 1/(a1·t), rotation of the gimbal's cross per rotation about t
};

/// The base-fixed axis a leg frame is built on: a1, or for FlexibleAxes::transverse with a leg
/// within 26° of a1 another base axis. `n`: direction of the straight leg.
Vector3 frame_axis(const Vector3& n, const Vector3& a1, model::FlexibleAxes axes);

/// The leg frame about the axis `n`. Throws std::invalid_argument for FlexibleAxes::gimbal with the
/// leg along its gimbal axis (gimbal lock, |a1·n| > 1 − 1e-9).
LegFrame leg_frame(const Vector3& n, const Vector3& a1, model::FlexibleAxes axes);

/// A leg linearised at a pose.
struct LegElement {
  LegFrame frame{};
  double l{};     ///< length [m]
  double l_m{};   ///< piston from the base joint, along the case [m]
  double l_mh{};  ///< guide sleeve from the piston, along the case [m]
  double k_h{};   ///< oil spring, gimbals in series, seals that stick beside them [N/m]
  double k_s{};   ///< guide sleeve [N/m]
  double k_g{};   ///< piston ring [N/m]

  /// Of the guide ring on which the rod lies, both zero where it does not: secant stiffness [N/m]
  /// in every direction, and along the offset r also γγᵀ, γ = √(k_tangent − k_secant) r [√(N/m)].
  double k_contact{};
  Eigen::Vector2d contact_root{Eigen::Vector2d::Zero()};
  /// Of the rod at the seal along t and a2 [m]: δ, which is d_s where rod and case do not bend.
  Eigen::Vector2d sleeve_offset{Eigen::Vector2d::Zero()};
  double bending{};  ///< f of rod and case [m/N], 0 where they do not bend
  /// F that bends them along t and a2 [N]; the bow at the sleeve is f F.
  Eigen::Vector2d bending_force{Eigen::Vector2d::Zero()};

  Matrix7 M{Matrix7::Zero()};
  Matrix7 K{Matrix7::Zero()};
  Matrix7 C{Matrix7::Zero()};  ///< viscous dampers of the leg only

  /// Extension rate of the piston in the case, ṡ = s_x ẋ.
  Vector7 s_x{Vector7::Zero()};
  /// Lateral offset of the rod at the seal of the guide sleeve along t and a2, δ̇ = d_x ẋ.
  Eigen::Matrix<double, 2, leg_coordinates> d_x{Eigen::Matrix<double, 2, leg_coordinates>::Zero()};
  /// Offset of the piston along t and a2 as the case sees it, u̇ = u_x ẋ.
  Eigen::Matrix<double, 2, leg_coordinates> u_x{Eigen::Matrix<double, 2, leg_coordinates>::Zero()};
  /// The force that bends rod and case, Ḟ = F_x ẋ; zero where they do not bend.
  Eigen::Matrix<double, 2, leg_coordinates> F_x{Eigen::Matrix<double, 2, leg_coordinates>::Zero()};
};

/// The leg without preload at the length and direction of `geometry`. Piston-ring coordinates are
/// filled in (k_g = 0 where the leg has none); who assembles a smaller model leaves them out.
LegElement straight_leg(const model::Leg& leg, const kinematics::LegGeometry& geometry,
                        model::FlexibleAxes axes);

using Vector2 = Eigen::Vector2d;
using Vector4 = Eigen::Vector4d;

/// Where the inner coordinates of a leg stand, and what the oil holds.
struct LegState {
  Vector4 flexible{Vector4::Zero()};  ///< (φ1, φ2 [rad], u1, u2 [m])
  double oil_force{};                 ///< f [N], positive when the leg is pulled
  /// P [N] that makes a bent rod softer; absent: −f.
  std::optional<double> rod_compression{};
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

/// One arm of a seal that is an elastomer: a spring κ [N/m] in series with a damper κ/λ, beside the
/// seal's own spring. k(iω) = k + Σ κ iω/(iω + λ).
struct SealArm {
  double stiffness{};  ///< κ [N/m]
  double rate{};       ///< λ [1/s]
};
inline constexpr std::size_t arms_per_seal = 3;
using SealArms = std::array<SealArm, arms_per_seal>;

/// Equally strong arms whose rates are a factor of 8 apart, fitted to k'(ω) and η at
/// elastomer.frequency. `stiffness`: k of slow motions [N/m].
SealArms seal_arms(double stiffness, const model::Elastomer& elastomer);

/// The guide ring under a rod that swings.
struct GuideEquivalent {
  /// Beside k_s: S = 1/π ∮ (∂f/∂d) sin² θ dθ, symmetric, S a = the part of the force at ω.
  Eigen::Matrix2d stiffness{Eigen::Matrix2d::Zero()};
  Vector2 mean{Vector2::Zero()};  ///< d̄ about which it swings [m]
  bool touches{};                 ///< somewhere in the period
};

/// `rest`: static offset, `amplitude`: a, both along t and a2 [m]. d̄ is where the mean force of
/// seal and guide ring is that at rest.
GuideEquivalent guide_equivalent(const model::GuideSleeve& sleeve, const Vector2& rest,
                                 const Vector2& amplitude);

/// What amplitudes leave of an elastomer's stiffness (Payne effect, after Kraus):
/// 1 − softening r/(1 + r), r = (A / softening_amplitude)^softening_exponent.
inline constexpr double softening_exponent = 1.2;  ///< 2m, m = 0.6, found for most filled rubbers
double softened(const model::Elastomer& elastomer, double amplitude);

/// A seal k with arms, in series with what bends: springs and arms once more, since k(p) / (1 + f
/// k(p)) falls from one real pole to the next. Returned are those arms that act on δ = d/(1 + f k)
/// of the slow motion: beside k/(1 + f k) of d they give the exact stiffness. `k` of slow motions
/// [N/m], `f` [m/N].
SealArms arms_in_series(const SealArms& arms, double k, double f);

/// Momentum and inertia of a leg in motions of its base, about the origin of B in its axes.
struct LegOnBase {
  /// Linear [kg m/s] and angular momentum [kg m²/s] per ẋ, in the leg's motion against the base.
  Eigen::Matrix<double, 6, leg_coordinates> momentum{
      Eigen::Matrix<double, 6, leg_coordinates>::Zero()};
  Matrix6 inertia{Matrix6::Zero()};  ///< case and rod (and gimbal's cross) locked together
};

/// `a`, `state` as for bent_leg; straight legs have the state zero.
LegOnBase leg_on_base(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                      const LegState& state);

/// The points of a leg that a picture of it needs: where they are, and how they move to first
/// order.
///
///     δp = p_x (δa; φ1, φ2; u1, u2)
///
/// δa is the motion of the platform joint relative to the base, in base axes; φ and u are the
/// flexible coordinates of LegElement. The rates are those of the chart (docs/theory/leg.md, "The
/// bent leg").
struct DrawnPoint {
  Vector3 p{Vector3::Zero()};  ///< [m] in B
  Eigen::Matrix<double, 3, leg_coordinates> p_x{Eigen::Matrix<double, 3, leg_coordinates>::Zero()};
};

struct DrawnLeg {
  DrawnPoint sleeve{};         ///< L_g from the base joint, on the axis of the case
  DrawnPoint piston{};         ///< with its offset
  DrawnPoint rod_at_sleeve{};  ///< l_mh from the piston, along the rod (its chord, where it bends)
};

/// `element`, `state`: the leg in a linear model; a straight leg has the state zero. The points of
/// a strut are its base joint.
DrawnLeg drawn_leg(const model::Leg& leg, const LegElement& element, model::FlexibleAxes axes,
                   const LegState& state);

}  // namespace hydrapod::dynamics
