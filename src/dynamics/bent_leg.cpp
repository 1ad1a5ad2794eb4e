#include "hydrapod/dynamics/leg.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "guide_contact.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "leg_beams.hpp"
#include "statics_search.hpp"

namespace hydrapod::dynamics {

namespace {

// The chart: rotation of the case about a1 and a2, extension s, then the flexible coordinates.
constexpr int alpha = 0, beta = 1, extension = 2, phi = 3, offset = 5;
using Matrix37 = Eigen::Matrix<double, 3, leg_coordinates>;
using Matrix27 = Eigen::Matrix<double, 2, leg_coordinates>;

const Vector3 t_L = Vector3::UnitX();
const Vector3 a2_L = Vector3::UnitY();
const Vector3 n_L = Vector3::UnitZ();

/// Direction of the rod in the case frame with its first and second derivatives by φ1, φ2.
struct RodDirection {
  Vector3 e, e_1, e_2, e_11, e_12, e_22;
  explicit RodDirection(double phi_1, double phi_2) {
    const double s1 = std::sin(phi_1), c1 = std::cos(phi_1);
    const double s2 = std::sin(phi_2), c2 = std::cos(phi_2);
    e << s2, -s1 * c2, c1 * c2;
    e_1 << 0.0, -c1 * c2, -s1 * c2;
    e_2 << c2, s1 * s2, -c1 * s2;
    e_11 << 0.0, s1 * c2, -c1 * c2;
    e_12 << 0.0, c1 * s2, s1 * s2;
    e_22 << -s2, s1 * c2, -c1 * c2;
  }
};

/// A point of the leg, in the case frame: P = (s n + u) + ξ e for points of the rod, P fixed for
/// those of the case.
struct LegPoint {
  Vector3 P{};
  double xi{};
  bool on_rod{};
};

/// Everything about the configuration that the derivatives need.
struct Configuration {
  RodDirection rod;
  Vector3 a1;  ///< gimbal axis in the case frame: (cos θ2, 0, sin θ2)
  Matrix3 R_BL;
  double s;
  Vector2 u;

  [[nodiscard]] LegPoint rod_point(double xi) const {
    return {Vector3(u[0], u[1], s) + xi * rod.e, xi, true};
  }
};

/// Closes the leg: extension and gimbal angles from the joint position. `L`: base to platform
/// joint.
bool close_leg(const model::Leg& leg, const Vector3& L, const Vector3& a1, const LegState& state,
               Configuration& at) {
  const Vector3 q = Vector3(at.u[0], at.u[1], 0.0) + leg.rod.length * at.rod.e;
  const double discriminant = q.z() * q.z() + L.squaredNorm() - q.squaredNorm();
  if (!(discriminant > 0.0) || !state.flexible.allFinite()) return false;
  at.s = std::sqrt(discriminant) - q.z();
  const Vector3 P = q + at.s * n_L;

  const double h = a1.dot(L);
  const double r = std::hypot(P.x(), P.z());
  if (!(std::abs(h) < r)) return false;
  const double theta = std::asin(h / r) - std::atan2(P.x(), P.z());
  const double c = std::cos(theta), sine = std::sin(theta);
  const double P_w = c * P.z() - sine * P.x();
  const Vector3 L_normal = L - h * a1;
  const Vector3 a2 = (P.y() * L_normal - P_w * a1.cross(L_normal)).normalized();
  const Vector3 w = a1.cross(a2);
  at.R_BL << c * a1 - sine * w, a2, sine * a1 + c * w;
  at.a1 = Vector3(c, 0.0, sine);
  return true;
}

/// ∂P/∂chart.
Matrix37 point_rates(const Configuration& at, const LegPoint& point) {
  Matrix37 rates = Matrix37::Zero();
  rates.col(alpha) = at.a1.cross(point.P);
  rates.col(beta) = a2_L.cross(point.P);
  if (!point.on_rod) return rates;
  rates.col(extension) = n_L;
  rates.col(phi) = point.xi * at.rod.e_1;
  rates.col(phi + 1) = point.xi * at.rod.e_2;
  rates.col(offset) = t_L;
  rates.col(offset + 1) = a2_L;
  return rates;
}

/// Adds γ·∂²P/∂chart² to H.
void add_point_curvature(const Configuration& at, const LegPoint& point, const Matrix37& rates,
                         const Vector3& gamma, Matrix7& H) {
  Matrix7 A = Matrix7::Zero();  // upper triangle
  A.row(alpha) = gamma.cross(at.a1).transpose() * rates;
  A.row(beta).tail<6>() = gamma.cross(a2_L).transpose() * rates.rightCols<6>();
  if (point.on_rod) {
    A(phi, phi) = point.xi * gamma.dot(at.rod.e_11);
    A(phi, phi + 1) = point.xi * gamma.dot(at.rod.e_12);
    A(phi + 1, phi + 1) = point.xi * gamma.dot(at.rod.e_22);
  }
  H += A.selfadjointView<Eigen::Upper>();
}

/// Lateral offset d_s of the chords at the guide sleeve with its derivatives by the chart.
struct SleeveOffset {
  Vector2 d;
  Matrix27 D = Matrix27::Zero();
  std::array<Matrix7, 2> D2{Matrix7::Zero(), Matrix7::Zero()};

  SleeveOffset(const Configuration& at, double position) {
    const auto& rod = at.rod;
    const double h = position - at.s;
    const double q = rod.e.z(), q_1 = rod.e_1.z(), q_2 = rod.e_2.z();
    const Vector2 tau = rod.e.head<2>() / q;
    const Vector2 tau_1 = (rod.e_1.head<2>() - tau * q_1) / q;
    const Vector2 tau_2 = (rod.e_2.head<2>() - tau * q_2) / q;
    const Vector2 tau_11 = (rod.e_11.head<2>() - 2.0 * tau_1 * q_1 - tau * rod.e_11.z()) / q;
    const Vector2 tau_12 =
        (rod.e_12.head<2>() - tau_1 * q_2 - tau_2 * q_1 - tau * rod.e_12.z()) / q;
    const Vector2 tau_22 = (rod.e_22.head<2>() - 2.0 * tau_2 * q_2 - tau * rod.e_22.z()) / q;
    d = at.u + h * tau;
    D.col(extension) = -tau;
    D.col(phi) = h * tau_1;
    D.col(phi + 1) = h * tau_2;
    D(0, offset) = 1.0;
    D(1, offset + 1) = 1.0;
    for (int k = 0; k < 2; ++k) {
      Matrix7 A = Matrix7::Zero();
      A(extension, phi) = -tau_1[k];
      A(extension, phi + 1) = -tau_2[k];
      A(phi, phi) = h * tau_11[k];
      A(phi, phi + 1) = h * tau_12[k];
      A(phi + 1, phi + 1) = h * tau_22[k];
      D2[k] = A.selfadjointView<Eigen::Upper>();
    }
  }
};

/// ∂e/∂chart.
Matrix37 rod_axis_rates(const Configuration& at) {
  Matrix37 rates = Matrix37::Zero();
  rates.col(alpha) = at.a1.cross(at.rod.e);
  rates.col(beta) = a2_L.cross(at.rod.e);
  rates.col(phi) = at.rod.e_1;
  rates.col(phi + 1) = at.rod.e_2;
  return rates;
}

/// Kinetic energy of the leg: 2T = ċᵀ M ċ in the chart.
Matrix7 chart_mass(const model::Leg& leg, const Configuration& at, const Matrix37& case_rates,
                   const Matrix37& rod_rates, bool gimbal) {
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  Matrix7 M = tube.mass * case_rates.transpose() * case_rates +
              rod.mass * rod_rates.transpose() * rod_rates;
  M(alpha, alpha) += tube.transverse_inertia * at.a1.x() * at.a1.x();  // ω⊥ = (a1·t) α̇ t + β̇ a2
  M(beta, beta) += tube.transverse_inertia;
  M(extension, extension) += leg.added_axial_inertia + hydraulics::line_inertia(leg, at.s);

  const Matrix37 e_rates = rod_axis_rates(at);  // as long as the rod's transverse rate
  M += rod.transverse_inertia * e_rates.transpose() * e_rates;
  if (!gimbal) return M;

  M(alpha, alpha) += leg.gimbal_cross_inertia;
  // Case: σ = a1·n α̇. Rod: two revolute joints, first axis f1 = a1, second normal to f1 and e.
  M(alpha, alpha) += tube.axial_inertia * at.a1.z() * at.a1.z();
  const Vector3 normal = at.rod.e.cross(at.a1);
  const Vector3 per_rate = -at.a1.dot(at.rod.e) / normal.squaredNorm() * normal;
  Vector7 spin = Vector7::Zero();
  spin[alpha] = at.a1.dot(at.rod.e);
  spin[beta] = a2_L.dot(at.rod.e);
  spin[phi] = per_rate.dot(at.rod.e_1);
  spin[phi + 1] = per_rate.dot(at.rod.e_2);
  return M + rod.axial_inertia * spin * spin.transpose();
}

/// Rod and case between the chords, where they bend.
struct Bending {
  BeamCompliance compliance;
  InSeries series;
  Vector2 force;  ///< F
  Matrix27 D;     ///< ∂d_s/∂chart − F ∂f/∂chart: of δ it is δ_d D, of F it is F_d D

  /// `element` with the seal's offset and springs, `P`: compression of the rod.
  Bending(const LegBeams& beams, double s, double P, const SleeveOffset& sleeve,
          const LegElement& element)
      : compliance(beams.compliance(s, P)),
        series(element),
        force((element.k_s + element.k_contact) * element.sleeve_offset),
        D(sleeve.D) {
    D.col(extension) -= compliance.f_s * force;
  }
};

/// What the mass of the bow adds to M: its field is −g F on the rod and +g F on the case.
void add_bow_mass(const Configuration& at, const SleeveOffset& sleeve, const Bending& bending,
                  const BowMass& mass, Matrix7& M) {
  Matrix37 bow = Matrix37::Zero();
  const Vector3 force(bending.force[0], bending.force[1], 0.0);
  bow.topRows<2>() = bending.series.F_d * sleeve.D;
  bow.col(alpha) = at.a1.cross(force);
  bow.col(beta) = a2_L.cross(force);
  const Matrix37 piston = point_rates(at, at.rod_point(0.0));
  Matrix37 axis = Matrix37::Zero();
  axis.col(alpha) = at.a1.cross(n_L);
  axis.col(beta) = a2_L.cross(n_L);
  const Matrix7 mixed = bow.transpose() * (mass.around * axis - mass.piston * piston -
                                           mass.tilt * rod_axis_rates(at));
  M += mixed + mixed.transpose() + mass.self * bow.transpose() * bow;
}

/// Rate of a lateral vector `v` of the case that the case sees. With transverse axes the case does
/// not spin about n, but the chart does, with σ = (a1·n) α̇; then σ n × v is added to the rates in
/// the chart.
Matrix27 seen_by_case(const Configuration& at, const Matrix27& chart_rates, const Vector2& v,
                      const Matrix7& T, bool gimbal) {
  Matrix27 rates = chart_rates * T;
  if (!gimbal) rates += Vector2(-v[1], v[0]) * (at.a1.z() * T.row(alpha));
  return rates;
}

/// ∂(chart)/∂(a in the case frame, φ, u).
Matrix7 chart_from_local(const Matrix37& joint_rates) {
  const Matrix3 A_inverse = joint_rates.leftCols<3>().inverse();
  Matrix7 T = Matrix7::Identity();
  T.topLeftCorner<3, 3>() = A_inverse;
  T.topRightCorner<3, 4>() = -A_inverse * joint_rates.rightCols<4>();
  return T;
}

/// The points that carry mass or force, with their rates in the chart.
struct LegPoints {
  LegPoint joint, rod_center, case_center;
  Matrix37 joint_rates, rod_rates, case_rates;

  LegPoints(const model::Leg& leg, const Configuration& at)
      : joint(at.rod_point(leg.rod.length)),
        rod_center(at.rod_point(leg.rod.mass_center)),
        case_center{leg.cylinder_case.mass_center * n_L, 0.0, false},
        joint_rates(point_rates(at, joint)),
        rod_rates(point_rates(at, rod_center)),
        case_rates(point_rates(at, case_center)) {}
};

/// Weights of case and rod as potential gradients: −m g, in the case frame.
struct Weights {
  Vector3 tube, rod;
};

/// Of the compliances at the guide sleeve: ∂V/∂chart. The energy ½ f F² by f at a given d_s is
/// −½ F².
Vector7 sleeve_gradient(const LegElement& element, const SleeveOffset& sleeve,
                        const std::optional<Bending>& bending) {
  if (!bending) {
    const double k_secant = element.k_s + element.k_contact;
    return k_secant * sleeve.D.transpose() * sleeve.d;
  }
  Vector7 gradient = sleeve.D.transpose() * bending->force;
  gradient[extension] -= 0.5 * bending->compliance.f_s * bending->force.squaredNorm();
  return gradient;
}

/// And ∂²V/∂chart².
Matrix7 sleeve_hessian(const LegElement& element, const SleeveOffset& sleeve,
                       const std::optional<Bending>& bending) {
  if (bending) {
    const Vector2& F = bending->force;
    Matrix7 H = bending->D.transpose() * bending->series.F_d * bending->D + F[0] * sleeve.D2[0] +
                F[1] * sleeve.D2[1];
    H(extension, extension) -= 0.5 * bending->compliance.f_ss * F.squaredNorm();
    return H;
  }
  const double k_secant = element.k_s + element.k_contact;
  Matrix7 H = k_secant * (sleeve.D.transpose() * sleeve.D + sleeve.d[0] * sleeve.D2[0] +
                          sleeve.d[1] * sleeve.D2[1]);
  if (element.k_contact > 0.0) {
    const Vector7 radial = sleeve.D.transpose() * element.contact_root;
    H += radial * radial.transpose();
  }
  return H;
}

/// ∂V/∂chart.
Vector7 chart_gradient(const LegElement& element, const Configuration& at, const LegPoints& points,
                       const Vector7& of_sleeve, const Weights& weights, double oil_force) {
  Vector7 gradient = of_sleeve + points.case_rates.transpose() * weights.tube +
                     points.rod_rates.transpose() * weights.rod;
  gradient[extension] += oil_force;
  gradient.tail<2>() += element.k_g * at.u;
  return gradient;
}

/// ∂²V/∂chart² − λ·∂²a/∂chart² at constant oil force.
Matrix7 chart_hessian(const LegElement& element, const Configuration& at, const LegPoints& points,
                      const Matrix7& of_sleeve, const Weights& weights, const Vector3& lambda) {
  Matrix7 H = of_sleeve;
  H(offset, offset) += element.k_g;
  H(offset + 1, offset + 1) += element.k_g;
  add_point_curvature(at, points.case_center, points.case_rates, weights.tube, H);
  add_point_curvature(at, points.rod_center, points.rod_rates, weights.rod, H);
  add_point_curvature(at, points.joint, points.joint_rates, -lambda, H);
  return H;
}

/// The leg's viscous dampers.
Matrix7 leg_damping(const model::Leg& leg, const LegElement& element, double s) {
  const Matrix7 C =
      leg.guide_sleeve.damping * element.d_x.transpose() * element.d_x +
      hydraulics::axial_spring(leg, s).damping * element.s_x * element.s_x.transpose();
  if (!leg.piston_ring) return C;
  return C + leg.piston_ring->damping * element.u_x.transpose() * element.u_x;
}

/// Lengths, springs and frame of the element; its matrices follow later.
void describe(const model::Leg& leg, const Configuration& at, double length, bool gimbal,
              LegElement& element) {
  element.frame.R_BL = at.R_BL;
  element.frame.tan_gimbal = gimbal ? at.a1.z() / at.a1.x() : 0.0;
  element.l = length;
  element.l_m = at.s;
  element.l_mh = leg.guide_sleeve.position - at.s;
  element.k_h = hydraulics::axial_spring(leg, at.s).stiffness;
  element.k_s = leg.guide_sleeve.stiffness;
  element.k_g = leg.piston_ring ? leg.piston_ring->stiffness : 0.0;
}

/// The seal's offset, and the guide ring where the rod lies on it. `chords`: d_s.
void press(const model::GuideSleeve& sleeve, const Vector2& chords, LegElement& element) {
  Vector2& delta = element.sleeve_offset = chords;
  if (const double d = chords.norm(); element.bending > 0.0 && d > 0.0)
    delta *= seal_offset(d, element.bending, element.k_s,
                         sleeve.gap.value_or(std::numeric_limits<double>::infinity()),
                         sleeve.guide_stiffness) /
             d;
  const double size = delta.norm();
  const auto contact = guide_contact(sleeve, size);
  if (!(contact.secant > 0.0)) return;
  element.k_contact = contact.secant;
  element.contact_root = std::sqrt(std::max(contact.tangent - contact.secant, 0.0)) / size * delta;
}

BentLeg make_bent_leg(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                      const Vector3& gravity, const LegState& state, bool with_bow_mass) {
  BentLeg bent;
  const Vector3 L = a - leg.base_joint;
  const Vector3 a1 = frame_axis(L.normalized(), leg.gimbal_axis, axes);
  Configuration at{
      RodDirection(state.flexible[0], state.flexible[1]), {}, {}, {}, state.flexible.tail<2>()};
  bent.exists = close_leg(leg, L, a1, state, at);
  if (!bent.exists) return bent;
  const bool gimbal = axes == model::FlexibleAxes::gimbal;
  auto& element = bent.element;
  describe(leg, at, L.norm(), gimbal, element);

  const LegPoints points(leg, at);
  const SleeveOffset sleeve(at, leg.guide_sleeve.position);
  const auto beams = leg_beams(leg);
  const double P = state.rod_compression.value_or(-state.oil_force);
  if (beams) element.bending = beams->compliance(at.s, P).f;
  press(leg.guide_sleeve, sleeve.d, element);
  std::optional<Bending> bending;
  if (beams) bending.emplace(*beams, at.s, P, sleeve, element);
  const Vector3 g_L = at.R_BL.transpose() * gravity;
  const Weights weights{-leg.cylinder_case.mass * g_L, -leg.rod.mass * g_L};
  const Vector7 gradient = chart_gradient(
      element, at, points, sleeve_gradient(element, sleeve, bending), weights, state.oil_force);

  const Matrix7 T = chart_from_local(points.joint_rates);
  const Vector3 lambda = T.topLeftCorner<3, 3>().transpose() * gradient.head<3>();
  bent.joint_force = at.R_BL * lambda;
  bent.flexible_gradient =
      gradient.tail<4>() - points.joint_rates.rightCols<4>().transpose() * lambda;

  element.s_x = T.row(extension).transpose();
  element.d_x =
      seen_by_case(at, bending ? Matrix27(bending->series.delta_d * bending->D) : sleeve.D,
                   element.sleeve_offset, T, gimbal);
  Matrix27 offset_rates = Matrix27::Zero();
  offset_rates.rightCols<2>().setIdentity();
  element.u_x = seen_by_case(at, offset_rates, at.u, T, gimbal);
  bent.K_without_oil = T.transpose() *
                       chart_hessian(element, at, points, sleeve_hessian(element, sleeve, bending),
                                     weights, lambda) *
                       T;
  element.K = bent.K_without_oil + element.k_h * element.s_x * element.s_x.transpose();
  Matrix7 mass = chart_mass(leg, at, points.case_rates, points.rod_rates, gimbal);
  if (bending) {
    if (with_bow_mass)
      add_bow_mass(at, sleeve, *bending, beams->bow_mass(at.s, P, element.k_s + element.k_contact),
                   mass);
    element.bending_force = bending->force;
    element.F_x = seen_by_case(at, bending->series.F_d * bending->D, bending->force, T, gimbal);
  }
  element.M = T.transpose() * mass * T;
  element.C = leg_damping(leg, element, at.s);
  return bent;
}

}  // namespace

BentLeg bent_leg(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                 const Vector3& gravity, const LegState& state) {
  return make_bent_leg(leg, a, axes, gravity, state, true);
}

BentLeg bent_leg_without_bow_mass(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                                  const Vector3& gravity, const LegState& state) {
  return make_bent_leg(leg, a, axes, gravity, state, false);
}

}  // namespace hydrapod::dynamics
