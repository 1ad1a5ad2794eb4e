#include "leg_motion.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace hydrapod::dynamics {

namespace {

/// Direction of the rod, its slopes, and how it moves in the frame of the case.
void bend(LegMotion& at) {
  const double s1 = std::sin(at.flexible[0]), c1 = std::cos(at.flexible[0]);
  const double s2 = std::sin(at.flexible[1]), c2 = std::cos(at.flexible[1]);
  at.e << s2, -s1 * c2, c1 * c2;
  at.e_1 << 0.0, -c1 * c2, -s1 * c2;
  at.e_2 << c2, s1 * s2, -c1 * s2;
  const double r1 = at.flexible_rate[0], r2 = at.flexible_rate[1];
  at.e_bending = r1 * at.e_1 + r2 * at.e_2;
  const double mixed = 2.0 * r1 * r2, squares = r1 * r1 + r2 * r2;
  at.e_curvature << -s2 * r2 * r2, squares * s1 * c2 + mixed * c1 * s2,
      -squares * c1 * c2 + mixed * s1 * s2;
}

/// Extension, gimbal angles and frame from the joint at `L` from the base joint.
bool close_leg(const model::Leg& leg, const Vector3& L, const Vector3& a1, LegMotion& at) {
  at.P = leg.rod.length * at.e;
  at.P.head<2>() += at.flexible.tail<2>();
  const double discriminant = L.squaredNorm() - at.P.head<2>().squaredNorm();
  if (!(discriminant > 0.0)) return false;
  const double P_z = std::sqrt(discriminant);
  at.s = P_z - at.P.z();
  at.P.z() = P_z;

  const double h = a1.dot(L);
  const double square = at.P.x() * at.P.x() + P_z * P_z;
  if (!(h * h < square)) return false;
  const double k = std::sqrt(square - h * h);  // distance of the joint from the plane of a1 and a2
  at.cosine = (k * P_z + h * at.P.x()) / square;
  at.sine = (h * P_z - k * at.P.x()) / square;
  const Vector3 L_normal = L - h * a1;
  const Vector3 a2 = (at.P.y() * L_normal - k * a1.cross(L_normal)) / L_normal.squaredNorm();
  const Vector3 w = a1.cross(a2);
  at.R_BL << at.cosine * a1 - at.sine * w, a2, at.sine * a1 + at.cosine * w;
  return true;
}

/// Rates of the chart from the joint's velocity.
void turn_and_extend(const model::Leg& leg, LegMotion& at) {
  Vector3 v = at.R_BL.transpose() * at.v_a - leg.rod.length * at.e_bending;
  v.head<2>() -= at.flexible_rate.tail<2>();
  const Vector3& P = at.P;
  const double alpha = -v.y() / (at.cosine * P.z() - at.sine * P.x());
  const double beta = (v.x() + at.sine * P.y() * alpha) / P.z();
  at.s_rate = v.z() - at.cosine * P.y() * alpha + P.x() * beta;
  at.case_rate << alpha, beta;
  at.omega << at.cosine * alpha, beta, at.sine * alpha;
}

void place_points(const model::Leg& leg, LegMotion& at) {
  at.e_rate = at.omega.cross(at.e) + at.e_bending;
  const Vector3 piston(at.flexible[2], at.flexible[3], at.s);
  const Vector3 piston_rate(at.flexible_rate[2], at.flexible_rate[3], at.s_rate);
  at.g = piston + leg.rod.mass_center * at.e;
  at.g_rate = at.omega.cross(at.g) + piston_rate + leg.rod.mass_center * at.e_bending;
}

/// What the seals feel. With transverse axes the case does not spin with its frame, so lateral
/// vectors turn in it.
void deflect_seals(const model::Leg& leg, bool spinning, LegMotion& at) {
  const double h = leg.guide_sleeve.position - at.s, q = at.e.z();
  const Vector2 slope = at.e.head<2>() / q;
  at.sleeve_offset = at.flexible.tail<2>() + h * slope;
  at.sleeve_slopes << -slope, h * (at.e_1.head<2>() - slope * at.e_1.z()) / q,
      h * (at.e_2.head<2>() - slope * at.e_2.z()) / q;
  const double spin = spinning ? 0.0 : at.omega.z();
  const auto turned = [&](const Vector2& v) { return Vector2(-spin * v.y(), spin * v.x()); };
  at.ring_offset_rate = at.flexible_rate.tail<2>() + turned(at.flexible.tail<2>());
  at.sleeve_offset_rate =
      at.flexible_rate.tail<2>() +
      at.sleeve_slopes * Vector3(at.s_rate, at.flexible_rate[0], at.flexible_rate[1]) +
      turned(at.sleeve_offset);
}

}  // namespace

void move_leg(const model::Leg& leg, const Vector3& axis, bool spinning, bool flexible,
              LegMotion& at) {
  if (flexible) {
    bend(at);
  } else {
    at.e = Vector3::UnitZ();
    at.e_1 << 0.0, -1.0, 0.0;
    at.e_2 << 1.0, 0.0, 0.0;
    at.e_bending.setZero();
    at.e_curvature.setZero();
  }
  const Vector3 L = at.a - leg.base_joint;
  at.length = L.norm();
  at.length_rate = L.dot(at.v_a) / at.length;
  at.exists = close_leg(leg, L, axis, at);
  if (!at.exists) return;
  turn_and_extend(leg, at);
  place_points(leg, at);
  deflect_seals(leg, spinning, at);
}

}  // namespace hydrapod::dynamics
