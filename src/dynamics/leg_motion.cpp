#include "leg_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "guide_contact.hpp"
#include "leg_equations.hpp"

namespace hydrapod::dynamics {

namespace {

/// Direction of the rod, its slopes, and how it moves in the frame of the case.
void bend(LegsInMotion& at) {
  Lanes s1, c1, s2, c2;
  sine_cosine(at.flexible[0], s1, c1);
  sine_cosine(at.flexible[1], s2, c2);
  at.e << s2, -s1 * c2, c1 * c2;
  at.e_1 << Lanes(0.0), -c1 * c2, -s1 * c2;
  at.e_2 << c2, s1 * s2, -c1 * s2;
  const Lanes r1 = at.flexible_rate[0], r2 = at.flexible_rate[1];
  at.e_bending = r1 * at.e_1 + r2 * at.e_2;
  const Lanes mixed = 2.0 * r1 * r2, squares = r1 * r1 + r2 * r2;
  at.e_curvature << -s2 * r2 * r2, squares * s1 * c2 + mixed * c1 * s2,
      mixed * s1 * s2 - squares * c1 * c2;
}

void stay_straight(LegsInMotion& at) {
  at.e << Lanes(0.0), Lanes(0.0), Lanes(1.0);
  at.e_1 << Lanes(0.0), Lanes(-1.0), Lanes(0.0);
  at.e_2 << Lanes(1.0), Lanes(0.0), Lanes(0.0);
  at.e_bending.setConstant(Lanes(0.0));
  at.e_curvature.setConstant(Lanes(0.0));
}

/// Extension, gimbal angles and frame from the joint at `L` from the base joint.
Lanes close_legs(const LegConstants& legs, const Vector3L& L, LegsInMotion& at) {
  at.P = legs.l_mn * at.e;
  at.P[0] += at.flexible[2];
  at.P[1] += at.flexible[3];
  const Lanes square_L = L.dot(L);
  const Lanes z2 = square_L - at.P[0] * at.P[0] - at.P[1] * at.P[1];
  const Lanes P_z = sqrt(z2);
  at.s = P_z - at.P[2];
  at.P[2] = P_z;

  const Vector3L& a1 = legs.axis;
  const Lanes h = a1.dot(L);
  const Lanes square = at.P[0] * at.P[0] + z2;
  const Lanes k2 = square - h * h;
  const Lanes k = sqrt(k2);  // distance of the joint from the plane of a1 and a2
  const Lanes per_square = 1.0 / square;
  at.cosine = (k * P_z + h * at.P[0]) * per_square;
  at.sine = (h * P_z - k * at.P[0]) * per_square;
  const Vector3L L_normal = L - h * a1;
  const Vector3L across = a1.cross(L_normal);
  const Lanes per_normal = 1.0 / (square_L - h * h);
  const Vector3L a2 = (at.P[1] * per_normal) * L_normal - (k * per_normal) * across;
  const Vector3L w = a1.cross(a2);
  at.R_BL.col(0) = at.cosine * a1 - at.sine * w;
  at.R_BL.col(1) = a2;
  at.R_BL.col(2) = at.sine * a1 + at.cosine * w;
  Lanes exist(0.0);
  for (int i = 0; i < Lanes::size; ++i) exist.set(i, z2[i] > 0.0 && k2[i] > 0.0 ? 1.0 : 0.0);
  return exist;
}

/// Rates of the chart from the joint's velocity.
void turn_and_extend(const LegConstants& legs, const Vector3L& v_a, LegsInMotion& at) {
  Vector3L v = at.R_BL.transpose() * v_a - legs.l_mn * at.e_bending;
  v[0] -= at.flexible_rate[2];
  v[1] -= at.flexible_rate[3];
  const Vector3L& P = at.P;
  at.alpha = -v[1] / (at.cosine * P[2] - at.sine * P[0]);
  at.beta = (v[0] + at.sine * P[1] * at.alpha) / P[2];
  at.s_rate = v[2] - at.cosine * P[1] * at.alpha + P[0] * at.beta;
  at.omega << at.cosine * at.alpha, at.beta, at.sine * at.alpha;
}

void place_points(const LegConstants& legs, LegsInMotion& at) {
  at.e_rate = at.omega.cross(at.e) + at.e_bending;
  const Vector3L piston(at.flexible[2], at.flexible[3], at.s);
  const Vector3L piston_rate(at.flexible_rate[2], at.flexible_rate[3], at.s_rate);
  at.g = piston + legs.c_g * at.e;
  at.g_rate = at.omega.cross(at.g) + piston_rate + legs.c_g * at.e_bending;
}

/// The motion at the seals. With transverse axes the case does not spin with its frame, so lateral
/// vectors turn in it.
void deflect_seals(const LegConstants& legs, bool spinning, LegsInMotion& at) {
  const Lanes h = legs.L_g - at.s, per_q = 1.0 / at.e[2], scale = h * per_q;
  const Vector2L u(at.flexible[2], at.flexible[3]);
  const Vector2L u_rate(at.flexible_rate[2], at.flexible_rate[3]);
  const Vector2L slope(at.e[0] * per_q, at.e[1] * per_q);
  at.sleeve_offset = u + h * slope;
  at.sleeve_slopes.col(0) = -slope;
  at.sleeve_slopes.col(1) =
      scale * Vector2L(at.e_1[0] - slope[0] * at.e_1[2], at.e_1[1] - slope[1] * at.e_1[2]);
  at.sleeve_slopes.col(2) =
      scale * Vector2L(at.e_2[0] - slope[0] * at.e_2[2], at.e_2[1] - slope[1] * at.e_2[2]);
  at.ring_offset_rate = u_rate;
  at.sleeve_offset_rate = u_rate + at.s_rate * at.sleeve_slopes.col(0) +
                          at.flexible_rate[0] * at.sleeve_slopes.col(1) +
                          at.flexible_rate[1] * at.sleeve_slopes.col(2);
  if (spinning) return;
  const auto turned = [&](const Vector2L& v) {
    return Vector2L(-at.omega[2] * v[1], at.omega[2] * v[0]);
  };
  at.ring_offset_rate += turned(u);
  at.sleeve_offset_rate += turned(at.sleeve_offset);
}

/// Seal, guide ring and beams in series between the chords: δ, F and ∂δ/∂d_s.
void share_offset(const LegConstants& legs, LegsInMotion& at) {
  const Lanes size = sqrt(at.sleeve_offset.dot(at.sleeve_offset));
  Lanes secant(0.0), along(1.0), across(1.0);
  at.bending = at.bending_slope = Lanes(0.0);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto leg = static_cast<std::size_t>(i);
    const auto compliance = legs.beams[leg].compliance(at.s[i], legs.compression[leg]);
    const double f = compliance.f, k_s = legs.k_s[i], gap = legs.gap[i], k_c = legs.k_c[i];
    const double delta = seal_offset(size[i], f, k_s, gap, k_c);
    const auto contact = guide_contact(delta, gap, k_c);
    at.bending.set(i, f);
    at.bending_slope.set(i, compliance.f_s);
    secant.set(i, k_s + contact.secant);
    across.set(i, 1.0 / (1.0 + f * (k_s + contact.secant)));
    along.set(i, 1.0 / (1.0 + f * (k_s + std::max(contact.tangent, contact.secant))));
  }
  at.seal_offset = across * at.sleeve_offset;
  at.bending_force = secant * at.seal_offset;
  const Lanes tiny(1e-300), per_square = (along - across) / (size * size + tiny);
  const Vector2L& d = at.sleeve_offset;
  at.seal_per_offset << across + per_square * d[0] * d[0], per_square * d[0] * d[1],
      per_square * d[0] * d[1], across + per_square * d[1] * d[1];
}

/// Rate of δ, and how the bow moves.
void bend_beams(const LegConstants& legs, bool spinning, LegsInMotion& at) {
  share_offset(legs, at);
  const Lanes r1 = at.flexible_rate[0], r2 = at.flexible_rate[1];
  const Vector2L u_rate(at.flexible_rate[2], at.flexible_rate[3]);
  const Vector2L slope = -at.sleeve_slopes.col(0);  // τ = e⊥/e_n
  const Vector2L tilting = r1 * at.sleeve_slopes.col(1) + r2 * at.sleeve_slopes.col(2);  // h τ°
  const Vector2L rate = u_rate - at.s_rate * slope + tilting;  // d_s° in L
  at.seal_offset_rate =
      at.seal_per_offset * Vector2L(rate - (at.bending_slope * at.s_rate) * at.bending_force);
  if (!spinning)
    at.seal_offset_rate +=
        Vector2L(-at.omega[2] * at.seal_offset[1], at.omega[2] * at.seal_offset[0]);

  // d_s°° = h τ°° − 2 ṡ τ°,  τ°° = (e⊥°° − τ e_n°° − 2 τ° e_n°)/e_n
  const Lanes h = legs.L_g - at.s, per_q = 1.0 / at.e[2];
  const Vector2L slope_rate = per_q * Vector2L(at.e_bending[0] - slope[0] * at.e_bending[2],
                                               at.e_bending[1] - slope[1] * at.e_bending[2]);
  Vector2L curvature;
  for (int k = 0; k < 2; ++k)
    curvature[k] = h * per_q *
                       (at.e_curvature[k] - slope[k] * at.e_curvature[2] -
                        2.0 * slope_rate[k] * at.e_bending[2]) -
                   2.0 * at.s_rate * slope_rate[k];
  const auto lateral = [](const Vector2L& v) { return Vector3L(v[0], v[1], Lanes(0.0)); };
  at.bow = lateral(legs.bow_rest + legs.bow_slope * at.sleeve_offset);
  at.bow_rate = at.omega.cross(at.bow) + lateral(legs.bow_slope * rate);
  at.bow_curvature = lateral(legs.bow_slope * curvature);
}

}  // namespace

Lanes move_legs(const LegConstants& legs, const Vector3L& L, const Vector3L& v_a, bool spinning,
                bool flexible, LegsInMotion& at) {
  if (flexible)
    bend(at);
  else
    stay_straight(at);
  at.length = sqrt(L.dot(L));
  at.length_rate = L.dot(v_a) / at.length;
  const Lanes exist = close_legs(legs, L, at);
  turn_and_extend(legs, v_a, at);
  place_points(legs, at);
  deflect_seals(legs, spinning, at);
  if (flexible && legs.bends) bend_beams(legs, spinning, at);
  return exist;
}

Vector6 frame_spins(const NonlinearModel& model, const Motion& motion) {
  if (model.machine().flexible_axes == model::FlexibleAxes::gimbal) return Vector6::Zero();
  Vector6 spins;
  for (int i = 0; i < model::leg_count; ++i) spins[i] = side_by_side(motion).omega[2][i];
  return spins;
}

LegJoints leg_joints(const NonlinearModel& model, const Motion& motion) {
  const auto& at = side_by_side(motion);
  const Vector3L against_rod =
      in_cases(at, motion.twist.tail<3>()) - at.e.cross(at.e_rate);  // across it
  const AcrossRod across(at);
  Matrix3L rod;
  rod << across.first, across.second, at.e;
  const Matrix3L rod_B = at.R_BL * rod;
  const Vector3L rates = rod.transpose() * against_rod;
  const bool spins = model.machine().flexible_axes == model::FlexibleAxes::transverse;
  // The rod's directions turn with φ1 about the first axis of the case.
  const Lanes rod_spin = at.omega.dot(at.e) + at.flexible_rate[0] * at.e[0];
  LegJoints joints;
  joints.base_spin = frame_spins(model, motion);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto leg = static_cast<std::size_t>(i);
    for (int k = 0; k < 9; ++k) {
      joints.case_axes[leg](k % 3, k / 3) = at.R_BL(k % 3, k / 3)[i];
      joints.rod_axes[leg](k % 3, k / 3) = rod_B(k % 3, k / 3)[i];
    }
    joints.base[leg] << at.omega[1][i], -at.omega[0][i];
    joints.platform[leg] << rates[0][i], rates[1][i];
    if (spins) joints.platform_spin[i] = rod_spin[i];
  }
  return joints;
}

}  // namespace hydrapod::dynamics
