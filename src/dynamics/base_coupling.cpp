/// What a base that moves feels of the mechanism on it.

#include <Eigen/Geometry>

#include "leg_equations.hpp"

namespace hydrapod::dynamics {

namespace {

/// A vector of B that is given by lanes, summed over the legs.
Vector3 sum(const Vector3L& v) { return {v[0].sum(), v[1].sum(), v[2].sum()}; }

/// Σ b × v over the legs.
Vector3 moments(const Vector3L& b, const Vector3L& v) { return sum(b.cross(v)); }

/// Inertia about the origin of a body with mass centre at `c`.
Matrix6 about_origin(double mass, const Vector3& c, const Matrix3& inertia) {
  Eigen::Matrix<double, 3, 6> J;
  J << Matrix3::Identity(), -spatial::skew(c);
  Matrix6 M = mass * J.transpose() * J;
  M.bottomRightCorner<3, 3>() += inertia;
  return M;
}

Matrix3 of_revolution(double transverse, double axial, const Vector3& axis) {
  const Matrix3 along = axis * axis.transpose();
  return transverse * (Matrix3::Identity() - along) + axial * along;
}

Vector3 leg_vector(const Vector3L& v, int i) { return {v[0][i], v[1][i], v[2][i]}; }

}  // namespace

Vector6 NonlinearModel::momentum(const Motion& motion) const {
  const auto& at = side_by_side(motion);
  const auto& legs = *constants_;
  const auto& platform = machine_.platform;
  const Vector3 omega = motion.twist.tail<3>();
  Vector3 p_platform = platform.mass * motion.twist.head<3>();
  const Matrix3& R = motion.X_BP.R_BP;
  // ṅ = (ω_2, −ω_1, 0) in the case's frame, as in PointForces
  const Vector3L n(Lanes(0.0), Lanes(0.0), Lanes(1.0));
  const Vector3L n_rate(at.omega[1], -at.omega[0], Lanes(0.0));
  Vector3L about_joint = legs.I_b * n.cross(n_rate) + legs.I_r * at.e.cross(at.e_rate) +
                         legs.m_g * at.g.cross(at.g_rate);
  if (spinning_) {
    const auto spin = axial_spin(at, legs.piston_axis);
    const Vector3L a1(at.cosine, Lanes(0.0), at.sine);
    about_joint += (legs.I_ta * spin.of_case) * n + (legs.I_ra * spin.of_rod) * at.e +
                   (legs.I_c * at.alpha) * a1;
  }
  Vector3L momentum = legs.m_t_r_b * n_rate + legs.m_g * at.g_rate;
  if (legs.bends) {
    const auto bow = bow_momentum(at, legs);
    momentum += bow.linear;
    about_joint += bow.angular;
  }
  const Vector3L p_leg = at.R_BL * momentum;
  Vector3 about_center = R * (platform.inertia * (R.transpose() * omega));
  if (payload_count() > 0) {
    const PayloadInMotion payload(legs.payload, motion, machine_.gravity);
    p_platform += Vector3(payload.rates.head<3>()) + omega.cross(payload.offset);
    about_center +=
        Vector3(payload.rates.tail<3>()) + payload.offset.cross(Vector3(motion.twist.head<3>()));
  }
  Vector6 total;
  total.head<3>() = p_platform + sum(p_leg);
  total.tail<3>() = motion.p_BC.cross(p_platform) + about_center + moments(legs.b, p_leg) +
                    sum(at.R_BL * about_joint);
  return total;
}

BaseCoupling NonlinearModel::base_coupling(const double* y) const {
  BaseCoupling coupling;
  coupling.momentum.resize(6, velocities());
  Eigen::VectorXd v = Eigen::VectorXd::Zero(velocities());
  Motion motion;
  for (int k = 0; k < velocities(); ++k) {
    v[k] = 1.0;
    this->motion(y, v.data(), motion);
    coupling.momentum.col(k) = momentum(motion);
    v[k] = 0.0;
  }
  const Matrix3& R = motion.X_BP.R_BP;
  const auto& platform = machine_.platform;
  coupling.inertia = about_origin(platform.mass, motion.p_BC, R * platform.inertia * R.transpose());
  const auto& at = side_by_side(motion);
  const Vector3L n = at.R_BL.col(2), e = at.R_BL * at.e, g = at.R_BL * at.g;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine_.legs[i];
    const auto& tube = leg.cylinder_case;
    coupling.inertia +=
        about_origin(tube.mass, leg.base_joint + tube.mass_center * leg_vector(n, i),
                     of_revolution(tube.transverse_inertia, tube.axial_inertia, leg_vector(n, i)));
    coupling.inertia += about_origin(
        leg.rod.mass, leg.base_joint + leg_vector(g, i),
        of_revolution(leg.rod.transverse_inertia, leg.rod.axial_inertia, leg_vector(e, i)));
    if (spinning_)
      coupling.inertia.bottomRightCorner<3, 3>() +=
          leg.gimbal_cross_inertia * leg.gimbal_axis * leg.gimbal_axis.transpose();
  }
  return coupling;
}

}  // namespace hydrapod::dynamics
