#include "hydrapod/dynamics/leg.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "hydrapod/hydraulics/servo_axis.hpp"
#include "leg_beams.hpp"
#include "straight_leg.hpp"

namespace hydrapod::dynamics {

namespace {

/// Mass of one bending plane in the plane's coordinates (lateral joint velocity v, tilt rate φ̇ and
/// offset rate u̇, each positive towards v): symmetric 3×3.
Matrix3 plane_mass(const model::Leg& leg, double l, double l_m) {
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  const double r_a = l_m + rod.mass_center;
  // ω = (v − u̇ − l_mn φ̇) / l                                                        (Eq. 11)
  const Vector3 omega(1.0 / l, -rod.length / l, -1.0 / l);
  const Vector3 v_g = r_a * omega + Vector3(0.0, rod.mass_center, 1.0);
  const Vector3 omega_rod = omega + Vector3(0.0, 1.0, 0.0);
  const double I_base = tube.mass * tube.mass_center * tube.mass_center + tube.transverse_inertia;
  return I_base * omega * omega.transpose() + rod.mass * v_g * v_g.transpose() +
         rod.transverse_inertia * omega_rod * omega_rod.transpose();
}

/// What the mass of the bow adds to plane_mass(); `force`: F per (v, φ, u).
Matrix3 plane_bow_mass(const model::Leg& leg, const LegElement& at, const BowMass& bow,
                       const Vector3& force) {
  const Vector3 omega(1.0 / at.l, -leg.rod.length / at.l, -1.0 / at.l);
  const Vector3 piston = at.l_m * omega + Vector3(0.0, 0.0, 1.0);
  const Vector3 omega_rod = omega + Vector3(0.0, 1.0, 0.0);
  const Vector3 momentum = bow.around * omega - bow.piston * piston - bow.tilt * omega_rod;
  return force * momentum.transpose() + momentum * force.transpose() +
         bow.self * force * force.transpose();
}

/// Puts a plane's 3×3 matrix where its coordinates (v, φ, u) stand in x; `sign` is that of φ.
void scatter(const Matrix3& plane, const std::array<int, 3>& at, double sign, Matrix7& M) {
  const Vector3 signs(1.0, sign, 1.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) M(at[i], at[j]) += signs[i] * signs[j] * plane(i, j);
}

// A tilt about a2 moves the rod towards t, a tilt about t moves it away from a2.
constexpr std::array<int, 3> plane_t{0, 4, 5};
constexpr std::array<int, 3> plane_2{1, 3, 6};

/// Rotations forced by the gimbals: axial spin σ = tan_gimbal ω_t of the case, σ + tan_gimbal φ̇1 of
/// the rod; rotation α̇ = sec_gimbal ω_t of the lower gimbal's cross about a1.
void add_gimbal_rotations(const model::Leg& leg, double l, const LegFrame& frame, Matrix7& M) {
  Vector7 omega_t = Vector7::Zero();  // rotation rate of the case about t
  omega_t[1] = -1.0 / l;
  omega_t[3] = -leg.rod.length / l;
  omega_t[6] = 1.0 / l;
  const Vector7 spin = frame.tan_gimbal * omega_t, cross = frame.sec_gimbal * omega_t;
  Vector7 rod_spin = spin;
  rod_spin[3] += frame.tan_gimbal;
  M += leg.cylinder_case.axial_inertia * spin * spin.transpose() +
       leg.rod.axial_inertia * rod_spin * rod_spin.transpose() +
       leg.gimbal_cross_inertia * cross * cross.transpose();
}

/// Springs or dampers of a straight leg: guide sleeve `at_sleeve`, piston ring `at_ring`, axial
/// `axial`.
void set_lateral_and_axial(const LegElement& leg, double at_sleeve, double at_ring, double axial,
                           Matrix7& A) {
  A.noalias() = at_sleeve * leg.d_x.transpose() * leg.d_x;
  A(5, 5) += at_ring;
  A(6, 6) += at_ring;
  A(2, 2) += axial;
}

}  // namespace

Vector3 frame_axis(const Vector3& n, const Vector3& a1, model::FlexibleAxes axes) {
  constexpr double near = 0.9;
  if (axes == model::FlexibleAxes::gimbal || std::abs(a1.dot(n)) < near) return a1;
  return std::abs(n.y()) < near ? Vector3::UnitY() : Vector3::UnitX();
}

LegFrame leg_frame(const Vector3& n, const Vector3& a1, model::FlexibleAxes axes) {
  constexpr double lock = 1.0 - 1e-9;
  const bool gimbal = axes == model::FlexibleAxes::gimbal;
  if (gimbal && std::abs(a1.dot(n)) > lock)
    throw std::invalid_argument(
        "gimbal_axis: the leg points along its lower gimbal's first axis (gimbal lock)");
  const Vector3 axis = frame_axis(n, a1, axes);
  const Vector3 a2 = n.cross(axis).normalized();
  const Vector3 t = a2.cross(n);
  LegFrame frame;
  frame.R_BL << t, a2, n;
  if (gimbal) {
    frame.sec_gimbal = 1.0 / a1.dot(t);
    frame.tan_gimbal = a1.dot(n) * frame.sec_gimbal;
  }
  return frame;
}

LegElement straight_leg(const model::Leg& leg, const kinematics::LegGeometry& geometry,
                        model::FlexibleAxes axes) {
  LegElement element;
  set_straight_leg(leg, geometry, axes, element);
  return element;
}

void set_straight_leg(const model::Leg& leg, const kinematics::LegGeometry& geometry,
                      model::FlexibleAxes axes, LegElement& element) {
  element.frame = leg_frame(geometry.n, leg.gimbal_axis, axes);
  element.l = geometry.length;
  element.l_m = geometry.length - leg.rod.length;
  element.l_mh = leg.guide_sleeve.position - element.l_m;
  const auto axial = hydraulics::axial_spring(leg, element.l_m);
  element.k_h = axial.stiffness;
  element.k_s = leg.guide_sleeve.stiffness;
  element.k_g = leg.piston_ring ? leg.piston_ring->stiffness : 0.0;

  element.s_x[2] = 1.0;
  element.d_x(0, 4) = element.l_mh;
  element.d_x(1, 3) = -element.l_mh;
  element.d_x(0, 5) = 1.0;
  element.d_x(1, 6) = 1.0;
  element.u_x(0, 5) = element.u_x(1, 6) = 1.0;

  Matrix3 plane = plane_mass(leg, element.l, element.l_m);
  double at_sleeve = element.k_s;
  if (const auto beams = leg_beams(leg)) {
    element.bending = beams->compliance(element.l_m, 0.0).f;
    const double series = 1.0 + element.bending * element.k_s;  // d_s over δ
    element.d_x /= series;
    element.F_x = element.k_s * element.d_x;
    at_sleeve *= series;
    const double stiffness = element.k_s / series;
    plane += plane_bow_mass(leg, element, beams->bow_mass(element.l_m, 0.0, element.k_s),
                            stiffness * Vector3(0.0, element.l_mh, 1.0));
  }
  scatter(plane, plane_t, 1.0, element.M);
  scatter(plane, plane_2, -1.0, element.M);
  element.M(2, 2) =
      leg.rod.mass + leg.added_axial_inertia + hydraulics::line_inertia(leg, element.l_m);
  if (axes == model::FlexibleAxes::gimbal)
    add_gimbal_rotations(leg, element.l, element.frame, element.M);

  set_lateral_and_axial(element, at_sleeve, element.k_g, element.k_h, element.K);
  set_lateral_and_axial(element, leg.guide_sleeve.damping,
                        leg.piston_ring ? leg.piston_ring->damping : 0.0, axial.damping, element.C);
}

}  // namespace hydrapod::dynamics
