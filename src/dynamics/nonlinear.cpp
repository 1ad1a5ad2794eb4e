#include "hydrapod/dynamics/nonlinear.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hydrapod/dynamics/bent_leg.hpp"
#include "leg_equations.hpp"
#include "leg_motion.hpp"

namespace hydrapod::dynamics {

namespace {

using Jacobian = Eigen::Matrix<double, 3, 6>;

/// Writes a vector to where `to` points.
template <class Vector>
void store(const Vector& v, double* to) {
  std::copy(v.data(), v.data() + v.size(), to);
}

Matrix3 rotation(const double* quaternion) {
  return Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3])
      .normalized()
      .toRotationMatrix();
}

void require_piston_rings(const model::Machine& machine, ModelKind kind) {
  if (kind != ModelKind::full) return;
  for (int i = 0; i < model::leg_count; ++i)
    if (!machine.legs[i].piston_ring)
      throw std::invalid_argument(
          fmt::format("the full model needs legs.piston_ring.stiffness; leg {} has none", i + 1));
}

/// A bend given in the frame of `bent_leg` (its axis depends on the pose) in a frame on `axis`.
LegState in_frame(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                  const Vector3& axis, const LegState& state) {
  const Vector3 n = (a - leg.base_joint).normalized();
  if (frame_axis(n, leg.gimbal_axis, axes) == axis) return state;
  const auto bent = bent_leg(leg, a, axes, Vector3::Zero(), state);
  if (!bent.exists) return state;
  const Matrix3& R = bent.element.frame.R_BL;
  const Vector3 a2 = R.col(2).cross(axis).normalized();
  Matrix3 R_to;
  R_to << a2.cross(R.col(2)), a2, R.col(2);
  const double s1 = std::sin(state.flexible[0]), c1 = std::cos(state.flexible[0]);
  const double s2 = std::sin(state.flexible[1]), c2 = std::cos(state.flexible[1]);
  const Vector3 e = R_to.transpose() * (R * Vector3(s2, -s1 * c2, c1 * c2));
  const Vector3 u = R_to.transpose() * (R * Vector3(state.flexible[2], state.flexible[3], 0.0));
  LegState result = state;
  result.flexible << std::atan2(-e.y(), e.z()), std::asin(std::clamp(e.x(), -1.0, 1.0)), u.x(),
      u.y();
  return result;
}

/// The machine's 6×6 system and its legs, for `n` flexible coordinates per leg.
template <int n>
class Assembly {
 public:
  Assembly(const Motion& motion, const model::Machine& machine, bool spinning,
           const std::array<Vector3, model::leg_count>& piston_axes)
      : motion_(motion), machine_(machine), spinning_(spinning), piston_axes_(piston_axes) {}

  void solve(const Loads& loads, double* v_rate) {
    const auto& platform = machine_.platform;
    const Vector3 omega = motion_.twist.tail<3>();
    const Matrix3 inertia = motion_.X_BP.R_BP * platform.inertia * motion_.X_BP.R_BP.transpose();
    Matrix6 M = Matrix6::Zero();
    M.diagonal().head<3>().setConstant(platform.mass);
    M.bottomRightCorner<3, 3>() = inertia;
    Vector6 force = loads.wrench;
    force.head<3>() += platform.mass * machine_.gravity;
    force.tail<3>() -= omega.cross(inertia * omega);
    std::array<LegEquations<n>, model::leg_count> legs;
    std::array<Jacobian, model::leg_count> J;
    for (int i = 0; i < model::leg_count; ++i) {
      const Vector3 arm = motion_.legs[i].a - motion_.p_BC;
      const auto around = surroundings(i, omega.cross(omega.cross(arm)), loads.axial[i]);
      leg_equations<n>(motion_.legs[i], around, legs[i]);
      J[i] = jacobian(i, legs[i].A_inverse, arm);
      const Jacobian SJ = legs[i].eliminated_mass() * J[i];
      M.noalias() += J[i].transpose() * SJ;
      force.noalias() -= J[i].transpose() * legs[i].eliminated_residual();
      force.tail<3>() += legs[i].joint_moment;
    }
    const Vector6 acceleration = M.llt().solve(force);
    store(acceleration, v_rate);
    if constexpr (n > 0)
      for (int i = 0; i < model::leg_count; ++i)
        store(legs[i].flexible_acceleration(J[i] * acceleration), v_rate + 6 + n * i);
  }

  void add_mass(Eigen::MatrixXd& M) {
    for (int i = 0; i < model::leg_count; ++i) {
      LegEquations<n> leg;
      leg_mass<n>(motion_.legs[i], surroundings(i, Vector3::Zero(), 0.0), leg);
      const Jacobian J = jacobian(i, leg.A_inverse, motion_.legs[i].a - motion_.p_BC);
      M.topLeftCorner<6, 6>() += J.transpose() * leg.M_cc * J;
      if constexpr (n > 0) {
        const int at = 6 + n * i;
        M.block<6, n>(0, at) = J.transpose() * leg.X;
        M.block<n, 6>(at, 0) = leg.X.transpose() * J;
        M.block<n, n>(at, at) = leg.M_ff;
      }
    }
  }

 private:
  [[nodiscard]] LegSurroundings surroundings(int i, const Vector3& joint_bias, double axial) const {
    return {machine_.legs[i],
            machine_.gravity,
            piston_axes_[i],
            spinning_,
            motion_.twist.tail<3>(),
            joint_bias,
            axial};
  }
  /// Chart rates (α̇, β̇, ṡ) per platform twist.
  [[nodiscard]] Jacobian jacobian(int i, const Matrix3& A_inverse, const Vector3& arm) const {
    Jacobian J;
    J.leftCols<3>() = A_inverse * motion_.legs[i].R_BL.transpose();
    for (int row = 0; row < 3; ++row) {
      const Vector3 j = J.row(row).head<3>();
      J.row(row).tail<3>() = arm.cross(j);
    }
    return J;
  }

  const Motion& motion_;
  const model::Machine& machine_;
  bool spinning_;
  const std::array<Vector3, model::leg_count>& piston_axes_;
};

/// Calls `use` with the number of flexible coordinates per leg as a constant.
template <class Use>
void with_flexible(ModelKind kind, Use use) {
  switch (kind) {
    case ModelKind::rigid:
      return use(std::integral_constant<int, 0>{});
    case ModelKind::guide:
      return use(std::integral_constant<int, 2>{});
    case ModelKind::full:
      return use(std::integral_constant<int, 4>{});
  }
}

}  // namespace

bool Motion::exists() const {
  return std::all_of(legs.begin(), legs.end(), [](const LegMotion& leg) { return leg.exists; });
}

NonlinearModel::NonlinearModel(const model::Machine& machine, ModelKind kind,
                               const spatial::Pose& X_reference)
    : machine_(machine),
      kind_(kind),
      spinning_(machine.flexible_axes == model::FlexibleAxes::gimbal) {
  require_piston_rings(machine, kind);
  const auto geometry = kinematics::inverse_kinematics(machine, X_reference);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const auto frame = leg_frame(geometry[i].n, leg.gimbal_axis, machine.flexible_axes);
    axes_[i] = frame_axis(geometry[i].n, leg.gimbal_axis, machine.flexible_axes);
    arms_[i] = leg.platform_joint - machine.platform.mass_center;
    piston_axes_[i] = Vector3(1.0, 0.0, frame.tan_gimbal).normalized();
  }
  if (!spinning_ || kind == ModelKind::rigid) return;
  const auto rest = static_equilibrium(machine, X_reference, kind);
  if (rest.status != StaticsStatus::converged) return;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto bent = bent_leg(machine.legs[i], geometry[i].a, machine.flexible_axes,
                               machine.gravity, rest.legs[i]);
    piston_axes_[i] = Vector3(1.0, 0.0, bent.element.frame.tan_gimbal).normalized();
  }
}

NonlinearModel::NonlinearModel(const model::Machine& machine, ModelKind kind)
    : NonlinearModel(machine, kind, machine.neutral()) {}

void NonlinearModel::configuration(const spatial::Pose& X_BP,
                                   const std::array<LegState, model::leg_count>& legs,
                                   double* y) const {
  store(kinematics::mass_center(machine_, X_BP), y);
  const Eigen::Quaterniond q = Eigen::Quaterniond(X_BP.R_BP).normalized();
  y[3] = q.w();
  store(Vector3(q.vec()), y + 4);
  for (int i = 0; i < model::leg_count; ++i)
    for (int k = 0; k < flexible(); ++k) y[7 + flexible() * i + k] = legs[i].flexible[k];
}

StaticEquilibrium NonlinearModel::equilibrium(const spatial::Pose& X_BP) const {
  auto rest = static_equilibrium(machine_, X_BP, kind_);
  const auto geometry = kinematics::inverse_kinematics(machine_, X_BP);
  if (rest.status == StaticsStatus::converged)
    for (int i = 0; i < model::leg_count; ++i)
      rest.legs[i] =
          in_frame(machine_.legs[i], geometry[i].a, machine_.flexible_axes, axes_[i], rest.legs[i]);
  return rest;
}

void NonlinearModel::motion(const double* y, const double* v, Motion& motion) const {
  const int n = flexible();
  motion.p_BC = Eigen::Map<const Vector3>(y);
  motion.X_BP.R_BP = rotation(y + 3);
  motion.X_BP.p_BP = motion.p_BC - motion.X_BP.R_BP * machine_.platform.mass_center;
  motion.twist = Eigen::Map<const Vector6>(v);
  const Vector3 velocity = motion.twist.head<3>(), omega = motion.twist.tail<3>();
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = motion.legs[i];
    const Vector3 arm = motion.X_BP.R_BP * arms_[i];
    leg.a = motion.p_BC + arm;
    leg.v_a = velocity + omega.cross(arm);
    for (int k = 0; k < n; ++k) {
      leg.flexible[k] = y[7 + n * i + k];
      leg.flexible_rate[k] = v[6 + n * i + k];
    }
    move_leg(machine_.legs[i], axes_[i], spinning_, n > 0, leg);
  }
}

void NonlinearModel::rates(const double* y, const double* v, double* y_rate) const {
  std::copy(v, v + 3, y_rate);
  const Vector3 omega(v[3], v[4], v[5]), q(y[4], y[5], y[6]);
  y_rate[3] = -0.5 * omega.dot(q);
  store(Vector3(0.5 * (y[3] * omega + omega.cross(q))), y_rate + 4);
  std::copy(v + 6, v + velocities(), y_rate + 7);
}

void NonlinearModel::accelerations(const Motion& motion, const Loads& loads, double* v_rate) const {
  with_flexible(kind_, [&](auto n) {
    Assembly<n()>(motion, machine_, spinning_, piston_axes_).solve(loads, v_rate);
  });
}

Eigen::MatrixXd NonlinearModel::mass_matrix(const Motion& motion) const {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(velocities(), velocities());
  M.diagonal().head<3>().setConstant(machine_.platform.mass);
  M.block<3, 3>(3, 3) = motion.X_BP.R_BP * machine_.platform.inertia * motion.X_BP.R_BP.transpose();
  with_flexible(
      kind_, [&](auto n) { Assembly<n()>(motion, machine_, spinning_, piston_axes_).add_mass(M); });
  return M;
}

Energies NonlinearModel::energies(const Motion& motion) const {
  Energies energy;
  const auto& platform = machine_.platform;
  const Vector3 velocity = motion.twist.head<3>();
  const Vector3 omega_P = motion.X_BP.R_BP.transpose() * motion.twist.tail<3>();
  energy.platform =
      0.5 * platform.mass * velocity.squaredNorm() + 0.5 * omega_P.dot(platform.inertia * omega_P);
  energy.gravity = -platform.mass * machine_.gravity.dot(motion.p_BC);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine_.legs[i];
    const auto& at = motion.legs[i];
    const auto& tube = leg.cylinder_case;
    const auto& rod = leg.rod;
    const double I_b = tube.transverse_inertia + tube.mass * tube.mass_center * tube.mass_center;
    energy.legs +=
        0.5 * (I_b * at.omega.head<2>().squaredNorm() + rod.mass * at.g_rate.squaredNorm() +
               rod.transverse_inertia * at.e_rate.squaredNorm() +
               leg.added_axial_inertia * at.s_rate * at.s_rate);
    if (spinning_) {
      const auto spin = axial_spin(at, piston_axes_[i]);
      energy.legs += 0.5 * (tube.axial_inertia * spin.of_case * spin.of_case +
                            rod.axial_inertia * spin.of_rod * spin.of_rod);
    }
    const Vector3 g_L = at.R_BL.transpose() * machine_.gravity;
    const double base_share = (tube.mass + rod.mass) * machine_.gravity.dot(leg.base_joint);
    energy.gravity -=
        tube.mass * tube.mass_center * g_L.z() + rod.mass * g_L.dot(at.g) + base_share;
    if (kind_ != ModelKind::rigid)
      energy.sleeves += 0.5 * leg.guide_sleeve.stiffness * at.sleeve_offset.squaredNorm();
    if (kind_ == ModelKind::full)
      energy.rings += 0.5 * leg.piston_ring->stiffness * at.flexible.tail<2>().squaredNorm();
  }
  return energy;
}

double NonlinearModel::dissipation(const Motion& motion) const {
  double power = 0.0;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine_.legs[i];
    const auto& at = motion.legs[i];
    const auto& friction = leg.hydraulics.joint_friction;
    const double base = at.omega.head<2>().norm();
    const Vector3 omega = at.R_BL.transpose() * motion.twist.tail<3>();
    const double top = (omega - at.e * at.e.dot(omega) - at.e.cross(at.e_rate)).norm();
    power += joint_friction_slope(friction, base) * base * base +
             joint_friction_slope(friction, top) * top * top;
    if (kind_ != ModelKind::rigid)
      power += leg.guide_sleeve.damping * at.sleeve_offset_rate.squaredNorm();
    if (kind_ == ModelKind::full)
      power += leg.piston_ring->damping * at.ring_offset_rate.squaredNorm();
  }
  return power;
}

}  // namespace hydrapod::dynamics
