#include "hydrapod/dynamics/nonlinear.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "factors_of_six.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "leg_equations.hpp"
#include "leg_motion.hpp"

namespace hydrapod::dynamics {

namespace {

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

Vector3L broadcast(const Vector3& v) { return {Lanes(v.x()), Lanes(v.y()), Lanes(v.z())}; }

Matrix3L broadcast(const Matrix3& R) {
  Matrix3L lanes;
  for (int k = 0; k < 9; ++k) lanes(k % 3, k / 3) = Lanes(R(k % 3, k / 3));
  return lanes;
}

/// Vectors of the legs one by one as lanes.
template <class Value>
Vector3L gather_vectors(Value value) {
  Vector3L lanes;
  for (int k = 0; k < 3; ++k) lanes[k] = gather([&](int i) { return value(i)[k]; });
  return lanes;
}

LegConstants gather_constants(const model::Machine& machine,
                              const std::array<Vector3, model::leg_count>& axes,
                              const std::array<Vector3, model::leg_count>& piston_axes,
                              const kinematics::LegGeometries& geometry) {
  const auto& legs = machine.legs;
  const auto tube = [&](int i) -> const auto& { return legs[i].cylinder_case; };
  const auto rod = [&](int i) -> const auto& { return legs[i].rod; };
  const auto joint = [&](int i) -> const auto& { return legs[i].hydraulics.joint_friction; };
  const auto ring = [&](int i) { return legs[i].piston_ring.value_or(model::PistonRing{}); };
  LegConstants to;
  to.b = gather_vectors([&](int i) { return legs[i].base_joint; });
  to.axis = gather_vectors([&](int i) { return axes[i]; });
  to.arm = gather_vectors(
      [&](int i) -> Vector3 { return legs[i].platform_joint - machine.platform.mass_center; });
  to.piston_axis = gather_vectors([&](int i) { return piston_axes[i]; });
  to.l_mn = gather([&](int i) { return rod(i).length; });
  to.c_g = gather([&](int i) { return rod(i).mass_center; });
  to.L_g = gather([&](int i) { return legs[i].guide_sleeve.position; });
  to.m_t_r_b = gather([&](int i) { return tube(i).mass * tube(i).mass_center; });
  to.I_b = gather([&](int i) {
    return tube(i).transverse_inertia + tube(i).mass * tube(i).mass_center * tube(i).mass_center;
  });
  to.I_ta = gather([&](int i) { return tube(i).axial_inertia; });
  to.I_c = gather([&](int i) { return legs[i].gimbal_cross_inertia; });
  to.m_g = gather([&](int i) { return rod(i).mass; });
  to.I_r = gather([&](int i) { return rod(i).transverse_inertia; });
  to.I_ra = gather([&](int i) { return rod(i).axial_inertia; });
  to.m_a = gather([&](int i) {
    return legs[i].added_axial_inertia +
           hydraulics::line_inertia(legs[i], geometry[i].length - rod(i).length);
  });
  to.k_s = gather([&](int i) { return legs[i].guide_sleeve.stiffness; });
  to.c_s = gather([&](int i) { return legs[i].guide_sleeve.damping; });
  to.k_g = gather([&](int i) { return ring(i).stiffness; });
  to.c_ring = gather([&](int i) { return ring(i).damping; });
  to.gap = gather([&](int i) {
    return legs[i].guide_sleeve.gap.value_or(std::numeric_limits<double>::infinity());
  });
  to.k_c = gather([&](int i) { return legs[i].guide_sleeve.guide_stiffness; });
  to.guide_contact = std::any_of(legs.begin(), legs.end(), [](const model::Leg& leg) {
    return leg.guide_sleeve.gap.has_value();
  });
  to.joint_viscous = gather([&](int i) { return joint(i).viscous; });
  to.joint_coulomb = gather([&](int i) { return joint(i).coulomb; });
  to.joint_smoothing = gather([&](int i) { return joint(i).smoothing_rate; });
  to.real = Lanes(1.0);
  for (int i = model::leg_count; i < Lanes::size; ++i) to.real.set(i, 0.0);
  return to;
}

bool has_joint_friction(const model::Machine& machine) {
  return std::any_of(machine.legs.begin(), machine.legs.end(), [](const model::Leg& leg) {
    const auto& friction = leg.hydraulics.joint_friction;
    return friction.viscous != 0.0 || friction.coulomb != 0.0;
  });
}

/// The machine's 6×6 system and its legs, for `n` flexible coordinates per leg.
template <int n>
class Assembly {
 public:
  Assembly(const Motion& motion, const model::Platform& platform, const LegSurroundings& around,
           const PayloadInMotion& payload)
      : motion_(motion), platform_(platform), around_(around), payload_(payload) {}

  /// v̇; with `momentum` also v̇ per acceleration of the base, into `per_base`.
  void solve(const Vector6& wrench, double* v_rate, const BaseMomentum* momentum = nullptr,
             BaseResponse* per_base = nullptr) {
    const Vector3 omega = motion_.twist.tail<3>();
    const Matrix3 inertia = motion_.X_BP.R_BP * platform_.inertia * motion_.X_BP.R_BP.transpose();
    Vector6 force = wrench;
    force.head<3>() += platform_.mass * around_.gravity;
    force.tail<3>() -= omega.cross(inertia * omega);
    LegEquations<n> legs;
    leg_equations<n>(side_by_side(motion_), around_, legs);
    const JacobianL J = jacobian(legs.A_inverse);
    const Matrix3L S = around_.legs.real * legs.eliminated_mass();
    const Vector3L r = around_.legs.real * legs.eliminated_residual();
    const JacobianL SJ = S * J;
    Matrix6 M;
    for (int column = 0; column < 6; ++column) {
      for (int row = column; row < 6; ++row) M(row, column) = J.col(row).dot(SJ.col(column)).sum();
      force[column] -= J.col(column).dot(r).sum();
    }
    M.diagonal().head<3>().array() += platform_.mass;
    M.bottomRightCorner<3, 3>() += inertia;
    if (around_.joint_friction)
      for (int k = 0; k < 3; ++k) force[3 + k] += legs.joint_moment[k].sum();
    payload_.eliminate(M, force);
    const FactorsOfSix factors(M);
    const Vector6 acceleration = factors.solve(force);
    store(acceleration, v_rate);
    payload_.accelerations(acceleration, v_rate + 6 + model::leg_count * n);
    if constexpr (n > 0) {
      Eigen::Matrix<Lanes, 6, 1> everywhere;
      for (int k = 0; k < 6; ++k) everywhere[k] = Lanes(acceleration[k]);
      const auto flexible = legs.flexible_acceleration(J * everywhere);
      for (int k = 0; k < n; ++k)
        for (int i = 0; i < model::leg_count; ++i) v_rate[6 + n * i + k] = flexible[k][i];
    }
    if (momentum) respond(legs, J, factors, *momentum, *per_base);
  }

  void add_mass(Eigen::MatrixXd& M) {
    LegEquations<n> legs;
    leg_mass<n>(side_by_side(motion_), around_, legs);
    const JacobianL J = jacobian(legs.A_inverse);
    const Matrix3L S = around_.legs.real * legs.M_cc;
    const JacobianL SJ = S * J;
    for (int k = 0; k < 36; ++k) M(k % 6, k / 6) += J.col(k % 6).dot(SJ.col(k / 6)).sum();
    if constexpr (n > 0) {
      const Eigen::Matrix<Lanes, 6, n> coupling = J.transpose() * legs.X;
      for (int i = 0; i < model::leg_count; ++i)
        for (int k = 0; k < n; ++k) {
          const int at = 6 + n * i + k;
          for (int row = 0; row < 6; ++row) M(row, at) = M(at, row) = coupling(row, k)[i];
          for (int j = 0; j < n; ++j) M(6 + n * i + j, at) = legs.M_ff(j, k)[i];
        }
    }
  }

 private:
  using JacobianL = Eigen::Matrix<Lanes, 3, 6>;

  /// −M⁻¹ Pᵀ: what an acceleration of the base brings against the coordinates, legs eliminated.
  void respond(const LegEquations<n>& legs, const JacobianL& J, const FactorsOfSix& factors,
               const BaseMomentum& momentum, BaseResponse& per_base) const {
    per_base.resize(momentum.cols(), 6);
    for (int b = 0; b < 6; ++b) {
      Vector6 force = -momentum.row(b).template head<6>().transpose();
      Eigen::Matrix<Lanes, n, 1> inner;
      for (int k = 0; k < n; ++k)
        inner[k] = gather([&](int i) { return momentum(b, 6 + n * i + k); });
      if constexpr (n > 0) {
        const Vector3L r = legs.X * (legs.M_ff_inverse * inner);
        for (int k = 0; k < 6; ++k) force[k] += J.col(k).dot(r).sum();
      }
      const int modes = payload_.count;
      const PayloadInMotion::Modes swings = momentum.row(b).tail(modes).transpose();
      if (modes > 0) force += payload_.L * swings;
      const Vector6 acceleration = factors.solve(force);
      per_base.col(b).template head<6>() = acceleration;
      if (modes > 0)
        per_base.col(b).tail(modes) = -(swings + payload_.L.transpose() * acceleration);
      if constexpr (n > 0) {
        Eigen::Matrix<Lanes, 6, 1> everywhere;
        for (int k = 0; k < 6; ++k) everywhere[k] = Lanes(acceleration[k]);
        const Eigen::Matrix<Lanes, n, 1> flexible =
            -(legs.M_ff_inverse * (inner + legs.X.transpose() * (J * everywhere)));
        for (int k = 0; k < n; ++k)
          for (int i = 0; i < model::leg_count; ++i) per_base(6 + n * i + k, b) = flexible[k][i];
      }
    }
  }

  /// Chart rates (α̇, β̇, ṡ) per platform twist.
  [[nodiscard]] JacobianL jacobian(const Matrix3L& A_inverse) const {
    JacobianL J;
    const Matrix3L linear = A_inverse * side_by_side(motion_).R_BL.transpose();
    for (int row = 0; row < 3; ++row) {
      const Vector3L j = linear.row(row).transpose();
      J.row(row).head<3>() = j.transpose();
      J.row(row).tail<3>() = side_by_side(motion_).arm.cross(j).transpose();
    }
    return J;
  }

  const Motion& motion_;
  const model::Platform& platform_;
  const LegSurroundings& around_;
  const PayloadInMotion& payload_;
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
    : machine_(with_pressed_seals(machine, kind, X_reference)),
      kind_(kind),
      spinning_(machine.flexible_axes == model::FlexibleAxes::gimbal),
      joint_friction_(has_joint_friction(machine)) {
  require_kind(machine, kind);
  const auto geometry = kinematics::inverse_kinematics(machine, X_reference);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const auto frame = leg_frame(geometry[i].n, leg.gimbal_axis, machine.flexible_axes);
    axes_[i] = frame_axis(geometry[i].n, leg.gimbal_axis, machine.flexible_axes);
    piston_axes_[i] = Vector3(1.0, 0.0, frame.tan_gimbal).normalized();
  }
  if (spinning_ && kind != ModelKind::rigid) turn_piston_axes(X_reference);
  weight_at_rest_ = X_reference.R_BP.transpose() * machine_.gravity;
  auto constants = gather_constants(machine_, axes_, piston_axes_, geometry);
  constants.payload = PayloadConstants(machine_, weight_at_rest_);
  add_beams(machine_, kind, X_reference, geometry, constants);
  constants_ = std::make_shared<const LegConstants>(constants);
}

/// To where the gimbals' axes are when the legs are bent by gravity.
void NonlinearModel::turn_piston_axes(const spatial::Pose& X_reference) {
  const auto rest = static_equilibrium(machine_, X_reference, kind_);
  if (rest.status != StaticsStatus::converged) return;
  const auto geometry = kinematics::inverse_kinematics(machine_, X_reference);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto bent = bent_leg(machine_.legs[i], geometry[i].a, machine_.flexible_axes,
                               machine_.gravity, rest.legs[i]);
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
  const Vector6 payload = constants_->payload.at_rest(X_BP.R_BP.transpose() * machine_.gravity);
  std::copy(payload.data(), payload.data() + payload_count(), y + positions() - payload_count());
}

StaticEquilibrium NonlinearModel::equilibrium(const spatial::Pose& X_BP) const {
  StaticsOptions options;
  if (constants_->bends)
    options.rod_compression = Eigen::Map<const Vector6>(constants_->compression.data());
  auto rest = rest_with_payload(machine_, X_BP, kind_, constants_->payload, options);
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
  const int modes = payload_count(), first = velocities() - modes;
  for (int k = 0; k < modes; ++k) {
    motion.payload[k] = y[first + 1 + k];
    motion.payload_rate[k] = v[first + k];
  }
  auto& lanes = side_by_side(motion);
  lanes.flexible.setConstant(Lanes(0.0));
  lanes.flexible_rate.setConstant(Lanes(0.0));
  for (int k = 0; k < n; ++k) {
    lanes.flexible[k] = gather([&](int i) { return y[7 + n * i + k]; });
    lanes.flexible_rate[k] = gather([&](int i) { return v[6 + n * i + k]; });
  }
  lanes.arm = broadcast(motion.X_BP.R_BP) * constants_->arm;
  const Vector3L L = broadcast(motion.p_BC) + lanes.arm - constants_->b;
  const Vector3L v_a = broadcast(velocity) + broadcast(omega).cross(lanes.arm);
  const Lanes exist = move_legs(*constants_, L, v_a, spinning_, n > 0, lanes);
  const bool bends = constants_->bends;
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = motion.legs[i];
    leg.exists = exist[i] > 0.0;
    leg.length = lanes.length[i];
    leg.length_rate = lanes.length_rate[i];
    leg.s = lanes.s[i];
    leg.s_rate = lanes.s_rate[i];
    for (int k = 0; k < n; ++k) leg.flexible[k] = lanes.flexible[k][i];
    const auto& offset = bends ? lanes.seal_offset : lanes.sleeve_offset;
    leg.sleeve_offset << offset[0][i], offset[1][i];
  }
}

void NonlinearModel::rates(const double* y, const double* v, double* y_rate) const {
  std::copy(v, v + 3, y_rate);
  const Vector3 omega(v[3], v[4], v[5]), q(y[4], y[5], y[6]);
  y_rate[3] = -0.5 * omega.dot(q);
  store(Vector3(0.5 * (y[3] * omega + omega.cross(q))), y_rate + 4);
  std::copy(v + 6, v + velocities(), y_rate + 7);
}

LegSurroundings NonlinearModel::surroundings(const Motion& motion, const Loads& loads) const {
  const Vector3L omega = broadcast(Vector3(motion.twist.tail<3>()));
  const Vector3L swing = omega.cross(side_by_side(motion).arm);
  LegSurroundings around{*constants_,
                         spinning_,
                         joint_friction_,
                         machine_.gravity,
                         motion.twist.tail<3>(),
                         omega.cross(swing),
                         gather([&](int i) { return loads.axial[i]; })};
  if (loads.joints_stick) {
    around.joint_friction = around.joints_stick = true;
    for (int k = 0; k < 2; ++k) {
      around.base_torque[k] = gather([&](int i) { return loads.base_joint[i][k]; });
      around.platform_torque[k] = gather([&](int i) { return loads.platform_joint[i][k]; });
    }
  }
  if (!loads.seals_press) return around;
  around.seals_press = true;
  for (int k = 0; k < 2; ++k) {
    around.sleeve_force[k] = gather([&](int i) { return loads.sleeve[i][k]; });
    around.ring_force[k] = gather([&](int i) { return loads.ring[i][k]; });
  }
  around.frame_moment = gather([&](int i) { return loads.frame_moment[i]; });
  return around;
}

void NonlinearModel::accelerations(const Motion& motion, const Loads& loads, double* v_rate) const {
  const LegSurroundings around = surroundings(motion, loads);
  const PayloadInMotion payload(constants_->payload, motion, machine_.gravity);
  with_flexible(kind_, [&](auto n) {
    Assembly<n()>(motion, machine_.platform, around, payload).solve(loads.wrench, v_rate);
  });
}

void NonlinearModel::accelerations(const Motion& motion, const Loads& loads,
                                   const BaseMomentum& momentum, double* v_rate,
                                   BaseResponse& per_base) const {
  const LegSurroundings around = surroundings(motion, loads);
  const PayloadInMotion payload(constants_->payload, motion, machine_.gravity);
  with_flexible(kind_, [&](auto n) {
    Assembly<n()>(motion, machine_.platform, around, payload)
        .solve(loads.wrench, v_rate, &momentum, &per_base);
  });
}

Eigen::MatrixXd NonlinearModel::mass_matrix(const Motion& motion) const {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(velocities(), velocities());
  M.diagonal().head<3>().setConstant(machine_.platform.mass);
  M.block<3, 3>(3, 3) = motion.X_BP.R_BP * machine_.platform.inertia * motion.X_BP.R_BP.transpose();
  const LegSurroundings around{*constants_,
                               spinning_,
                               joint_friction_,
                               machine_.gravity,
                               motion.twist.tail<3>(),
                               broadcast(Vector3(Vector3::Zero())),
                               Lanes(0.0)};
  const PayloadInMotion payload(constants_->payload, motion, machine_.gravity);
  with_flexible(kind_, [&](auto n) {
    Assembly<n()>(motion, machine_.platform, around, payload).add_mass(M);
  });
  payload.add_mass(M, velocities() - payload.count);
  return M;
}

Energies NonlinearModel::energies(const Motion& motion) const {
  const auto& platform = machine_.platform;
  const auto& legs = *constants_;
  const auto& at = side_by_side(motion);
  const Vector3 velocity = motion.twist.head<3>();
  const Vector3 omega_P = motion.X_BP.R_BP.transpose() * motion.twist.tail<3>();
  Energies energy;
  energy.platform =
      0.5 * platform.mass * velocity.squaredNorm() + 0.5 * omega_P.dot(platform.inertia * omega_P);
  Lanes twice = legs.I_b * (at.omega[0] * at.omega[0] + at.omega[1] * at.omega[1]) +
                legs.m_g * at.g_rate.dot(at.g_rate) + legs.I_r * at.e_rate.dot(at.e_rate) +
                legs.m_a * at.s_rate * at.s_rate;
  if (spinning_) {
    const auto spin = axial_spin(at, legs.piston_axis);
    twice += legs.I_ta * spin.of_case * spin.of_case + legs.I_ra * spin.of_rod * spin.of_rod +
             legs.I_c * at.alpha * at.alpha;
  }
  if (legs.bends) twice += bow_energy(at, legs);
  energy.legs = 0.5 * twice.sum();
  energy.gravity = -platform.mass * machine_.gravity.dot(motion.p_BC);
  for (const auto& leg : machine_.legs)
    energy.gravity -=
        (leg.cylinder_case.mass + leg.rod.mass) * machine_.gravity.dot(leg.base_joint);
  const Vector3L g_L = in_cases(at, machine_.gravity);
  const Lanes weight = legs.m_t_r_b * g_L[2] + legs.m_g * g_L.dot(at.g);
  energy.gravity -= weight.sum();
  if (kind_ != ModelKind::rigid) {
    const Vector2L& offset = legs.bends ? at.seal_offset : at.sleeve_offset;
    const Lanes sleeves = legs.k_s * offset.dot(offset);
    energy.sleeves = 0.5 * sleeves.sum();
    if (legs.guide_contact) energy.sleeves += guide_energy(at, legs).sum();
    if (legs.bends)
      energy.bending = 0.5 * Lanes(at.bending * at.bending_force.dot(at.bending_force)).sum();
  }
  if (kind_ == ModelKind::full) {
    const Lanes rings =
        legs.k_g * (at.flexible[2] * at.flexible[2] + at.flexible[3] * at.flexible[3]);
    energy.rings = 0.5 * rings.sum();
  }
  add_payload_energies(legs.payload, motion, machine_.gravity, energy);
  return energy;
}

double NonlinearModel::dissipation(const Motion& motion) const {
  const auto& at = side_by_side(motion);
  Lanes power(0.0);
  if (joint_friction_) {
    const auto turning = joint_turning(at, *constants_, motion.twist.tail<3>());
    power += turning.base_slope * turning.base_rate.dot(turning.base_rate) +
             turning.platform_slope * turning.platform_rate.dot(turning.platform_rate);
  }
  if (kind_ != ModelKind::rigid) {
    const Vector2L& rate = constants_->bends ? at.seal_offset_rate : at.sleeve_offset_rate;
    power += constants_->c_s * rate.dot(rate);
  }
  if (kind_ == ModelKind::full)
    power += constants_->c_ring * at.ring_offset_rate.dot(at.ring_offset_rate);
  return power.sum() + payload_dissipation(constants_->payload, motion);
}

}  // namespace hydrapod::dynamics
