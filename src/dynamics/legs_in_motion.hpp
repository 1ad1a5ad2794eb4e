#pragma once
/// All legs side by side, for the equations of NonlinearModel. Private to it.

#include <new>

#include "hydrapod/dynamics/nonlinear.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "leg_beams.hpp"
#include "payload_motion.hpp"

namespace hydrapod::dynamics {

using numerics::gather;
using numerics::Lanes;
using numerics::Matrix3L;
using numerics::Vector2L;
using numerics::Vector3L;
using numerics::Vector4L;
static_assert(Lanes::used == model::leg_count);

/// All legs in motion, for the equations. Vectors marked L are in the frame of the case.
struct LegsInMotion {
  Vector3L arm;   ///< platform joint from C, in B [m]
  Matrix3L R_BL;  ///< frame of the case: t, a2, n
  Vector4L flexible, flexible_rate;
  Lanes length, length_rate, s, s_rate;
  Lanes cosine, sine;    ///< the frame's first axis in L is (cosine, 0, sine)
  Lanes alpha, beta;     ///< rotation rates of the case about a1 and a2 [rad/s]
  Vector3L omega;        ///< angular velocity of the frame, L
  Vector3L P;            ///< joint from the base joint, L [m]
  Vector3L e, e_1, e_2;  ///< rod's direction, ∂e/∂φ1, ∂e/∂φ2, L
  Vector3L e_bending;    ///< ė that L sees
  Vector3L e_curvature;  ///< ë that L sees at constant rates of φ
  Vector3L e_rate;       ///< ė in B, components in L
  Vector3L g, g_rate;    ///< rod's mass centre from the base joint, L; its velocity in B, in L
  Vector2L sleeve_offset, sleeve_offset_rate;  ///< d_s, and its rate as the case sees it
  Vector2L ring_offset_rate;                   ///< u̇ as the case sees it
  Eigen::Matrix<Lanes, 2, 3> sleeve_slopes;    ///< ∂d_s/∂(s, φ1, φ2)

  // Of legs that bend; where none does, nothing below is set. d_s above is that of the chords.
  Vector2L seal_offset, seal_offset_rate;      ///< δ, and its rate as the case sees it
  Vector2L bending_force;                      ///< F [N]
  Eigen::Matrix<Lanes, 2, 2> seal_per_offset;  ///< ∂δ/∂d_s, symmetric
  Lanes bending, bending_slope;                ///< f [m/N] and f'(s)
  Vector3L bow;                                ///< b = F of the reference, linearised in d_s, L [N]
  Vector3L bow_rate;                           ///< ḃ in B, components in L
  Vector3L bow_curvature;                      ///< b°° that L sees at constant rates of the chart
};

/// What the equations need to know of the legs; letters as in docs/notation.md.
struct LegConstants {
  Vector3L b, axis, arm, piston_axis;  ///< arm: platform joint from C, in P
  Lanes l_mn, c_g, L_g, m_t_r_b, I_b, I_ta, I_c, m_g, I_r, I_ra, m_a, k_s, c_s, k_g, c_ring;
  Lanes gap, k_c;        ///< of the guide ring; the gap is infinite where a leg has none
  bool guide_contact{};  ///< has any leg one?
  bool bends{};          ///< does any leg?
  std::array<LegBeams, model::leg_count> beams;      ///< rods and cases as beams
  std::array<double, model::leg_count> compression;  ///< P [N]
  /// What the mass of the bow is, kept from the reference: b = bow_rest + bow_slope d_s.
  Vector2L bow_rest;
  Eigen::Matrix<Lanes, 2, 2> bow_slope;
  Lanes bow_piston, bow_tilt, bow_case, bow_self, bow_moment;  ///< BowMass
  Lanes joint_viscous, joint_coulomb, joint_smoothing;
  Lanes real;  ///< 1 for legs, 0 for the lanes that are none
  PayloadConstants payload;
};

/// Rods and cases as beams. Their compression and the mass of their bows are kept as they are in
/// the static equilibrium at the reference pose; straight legs stand in where there is none.
void add_beams(const model::Machine& machine, ModelKind kind, const spatial::Pose& X_reference,
               const kinematics::LegGeometries& geometry, LegConstants& to);

/// The legs side by side that `motion` has room for.
inline LegsInMotion& side_by_side(Motion& motion) {
  static_assert(sizeof(LegsInMotion) == sizeof(motion.side_by_side));
  return *std::launder(reinterpret_cast<LegsInMotion*>(motion.side_by_side.data()));
}
inline const LegsInMotion& side_by_side(const Motion& motion) {
  return *std::launder(reinterpret_cast<const LegsInMotion*>(motion.side_by_side.data()));
}

}  // namespace hydrapod::dynamics
