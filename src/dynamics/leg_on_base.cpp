#include <Eigen/Geometry>
#include <Eigen/LU>
#include <stdexcept>

#include "hydrapod/dynamics/leg.hpp"
#include "leg_beams.hpp"
#include "statics_search.hpp"

namespace hydrapod::dynamics {

namespace {

using Matrix37 = Eigen::Matrix<double, 3, leg_coordinates>;

const Vector3 t_L = Vector3::UnitX();
const Vector3 a2_L = Vector3::UnitY();
const Vector3 n_L = Vector3::UnitZ();

/// A bent leg and its rates per ẋ, in the case's frame.
struct BentGeometry {
  Vector3 a1{};            ///< first axis of the frame
  Vector3 e{};             ///< direction of the rod
  Vector3 piston{};        ///< from the base joint
  Matrix37 omega{};        ///< rotation of the frame: α̇ a1 + β̇ a2
  Matrix37 e_rate{};       ///< of the rod against the frame, e°
  Matrix37 piston_rate{};  ///< of the piston against the frame

  Matrix37 n_rate{};  ///< ṅ in B

  /// Velocity of a point of the rod at `xi` from the piston.
  [[nodiscard]] Matrix37 rod_velocity(double xi) const {
    return piston_rate + xi * e_rate - spatial::skew(piston + xi * e) * omega;
  }
};

/// The joint's velocity is s° n + u° + l_mn e° + ω × (s n + u + l_mn e), which gives α̇, β̇ and ṡ.
BentGeometry bent_geometry(const model::Leg& leg, const LegElement& element,
                           model::FlexibleAxes axes, const LegState& state) {
  const Eigen::AngleAxisd about_t(state.flexible[0], t_L), about_2(state.flexible[1], a2_L);
  const Vector3 in_plane = about_2 * n_L;
  BentGeometry at;
  at.e = about_t * in_plane;
  at.piston << state.flexible.tail<2>(), element.l_m;
  const Vector3 joint = at.piston + leg.rod.length * at.e;
  const Matrix3& R = element.frame.R_BL;
  at.a1 = R.transpose() * frame_axis((R * joint).normalized(), leg.gimbal_axis, axes);
  at.e_rate.setZero();
  at.e_rate.col(3) = t_L.cross(at.e);
  at.e_rate.col(4) = about_t * a2_L.cross(in_plane);
  at.piston_rate.setZero();
  at.piston_rate.rightCols<2>() << t_L, a2_L;

  Matrix37 left = -(at.piston_rate + leg.rod.length * at.e_rate);
  left.leftCols<3>().setIdentity();
  Matrix3 A;
  A << at.a1.cross(joint), a2_L.cross(joint), n_L;
  const Matrix37 rates = A.partialPivLu().solve(left);
  at.omega = at.a1 * rates.row(0) + a2_L * rates.row(1);
  at.piston_rate += n_L * rates.row(2);
  at.n_rate = -spatial::skew(n_L) * at.omega;
  return at;
}

Matrix3 of_revolution(double transverse, double axial, const Vector3& axis) {
  const Matrix3 along = axis * axis.transpose();
  return transverse * (Matrix3::Identity() - along) + axial * along;
}

/// Inertia about the origin of B of a body with its mass centre at `center`.
Matrix6 about_origin(double mass, const Vector3& center, const Matrix3& inertia) {
  Eigen::Matrix<double, 3, 6> J;
  J << Matrix3::Identity(), -spatial::skew(center);
  Matrix6 M = mass * J.transpose() * J;
  M.bottomRightCorner<3, 3>() += inertia;
  return M;
}

/// Angular momentum of the spins that gimbals force: of case, rod and the gimbal's cross.
Matrix37 spin_momentum(const model::Leg& leg, const BentGeometry& at) {
  const Vector3 normal = at.e.cross(at.a1);
  const Vector3 p = -at.a1.dot(at.e) / normal.squaredNorm() * normal;
  const Eigen::Matrix<double, 1, leg_coordinates> alpha =  // a1 is normal to a2
      at.a1.transpose() * at.omega;
  const Eigen::Matrix<double, 1, leg_coordinates> of_case = n_L.transpose() * at.omega;
  const Eigen::Matrix<double, 1, leg_coordinates> of_rod =
      at.e.transpose() * at.omega + p.transpose() * at.e_rate;
  return leg.cylinder_case.axial_inertia * n_L * of_case + leg.rod.axial_inertia * at.e * of_rod +
         leg.gimbal_cross_inertia * at.a1 * alpha;
}

/// Momentum of the bow, linear and about the base joint.
void add_bow(const model::Leg& leg, const BentGeometry& at, const LegElement& element,
             const LegState& state, Matrix37& linear, Matrix37& about_joint) {
  const auto beams = leg_beams(leg);
  if (!beams) return;
  const auto mass = beams->bow_mass(element.l_m, state.rod_compression.value_or(-state.oil_force),
                                    element.k_s + element.k_contact);
  // d_s° = u° − ṡ τ + h τ°,  τ = e⊥/e_n
  const Vector2 tau = at.e.head<2>() / at.e.z();
  const Eigen::Matrix<double, 2, leg_coordinates> tau_rate =
      (at.e_rate.topRows<2>() - tau * at.e_rate.row(2)) / at.e.z();
  const Eigen::Matrix<double, 2, leg_coordinates> d_rate =
      at.piston_rate.topRows<2>() - tau * at.piston_rate.row(2) + element.l_mh * tau_rate;
  const Vector3 bow(element.bending_force[0], element.bending_force[1], 0.0);
  Matrix37 bow_rate = -spatial::skew(bow) * at.omega;
  bow_rate.topRows<2>() += InSeries(element).F_d * d_rate;
  const auto about = [&](const Vector3& arm, const Matrix37& arm_rate) {
    return Matrix37(spatial::skew(arm) * bow_rate + spatial::skew(bow) * arm_rate);
  };
  linear -= mass.moment * bow_rate;
  about_joint += mass.around * about(n_L, at.n_rate) -
                 mass.piston * about(at.piston, at.rod_velocity(0.0)) -
                 mass.tilt * about(at.e, at.e_rate - spatial::skew(at.e) * at.omega) +
                 mass.self * spatial::skew(bow) * bow_rate;
}

}  // namespace

LegOnBase leg_on_base(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                      const LegState& state) {
  const auto bent = bent_leg_without_bow_mass(leg, a, axes, Vector3::Zero(), state);
  if (!bent.exists) throw std::invalid_argument("leg_on_base: no extension closes this leg");
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  const Vector3& b = leg.base_joint;
  const Matrix3& R = bent.element.frame.R_BL;
  const auto at = bent_geometry(leg, bent.element, axes, state);
  const Vector3 tube_center = tube.mass_center * n_L;
  const Vector3 rod_center = at.piston + rod.mass_center * at.e;
  const Matrix37 p_tube = -tube.mass * spatial::skew(tube_center) * at.omega;
  const Matrix37 p_rod = rod.mass * at.rod_velocity(rod.mass_center);
  const Matrix37 e_rate = at.e_rate - spatial::skew(at.e) * at.omega;
  Matrix37 about_joint = spatial::skew(tube_center) * p_tube + spatial::skew(rod_center) * p_rod +
                         of_revolution(tube.transverse_inertia, 0.0, n_L) * at.omega +
                         rod.transverse_inertia * spatial::skew(at.e) * e_rate;
  const bool gimbal = axes == model::FlexibleAxes::gimbal;
  if (gimbal) about_joint += spin_momentum(leg, at);

  Matrix37 linear = p_tube + p_rod;
  add_bow(leg, at, bent.element, state, linear, about_joint);

  LegOnBase on_base;
  on_base.momentum.topRows<3>() = R * linear;
  on_base.momentum.bottomRows<3>() =
      R * about_joint + spatial::skew(b) * on_base.momentum.topRows<3>();
  on_base.inertia =
      about_origin(tube.mass, b + R * tube_center,
                   of_revolution(tube.transverse_inertia, tube.axial_inertia, R.col(2))) +
      about_origin(rod.mass, b + R * rod_center,
                   of_revolution(rod.transverse_inertia, rod.axial_inertia, R * at.e));
  if (gimbal)
    on_base.inertia.bottomRightCorner<3, 3>() +=
        leg.gimbal_cross_inertia * leg.gimbal_axis * leg.gimbal_axis.transpose();
  return on_base;
}

DrawnLeg drawn_leg(const model::Leg& leg, const LegElement& element, model::FlexibleAxes axes,
                   const LegState& state) {
  if (leg.strut) {
    const DrawnPoint joint{.p = leg.base_joint};
    return {joint, joint, joint};
  }
  const auto at = bent_geometry(leg, element, axes, state);
  const Matrix3& R = element.frame.R_BL;
  const auto drawn = [&](const Vector3& p_L, const Matrix37& rates) {
    DrawnPoint point{leg.base_joint + R * p_L, R * rates};
    point.p_x.leftCols<3>() *= R.transpose();
    return point;
  };
  return {drawn(leg.guide_sleeve.position * n_L, leg.guide_sleeve.position * at.n_rate),
          drawn(at.piston, at.rod_velocity(0.0)),
          drawn(at.piston + element.l_mh * at.e, at.rod_velocity(element.l_mh))};
}

}  // namespace hydrapod::dynamics
