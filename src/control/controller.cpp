#include "hydrapod/control/controller.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "conditioning.hpp"

namespace hydrapod::control {

namespace {

/// What a controller can rely on in every sample: leg lengths are known to micrometres, and from
/// the last pose Newton needs two or three steps.
constexpr kinematics::ForwardOptions forward_options{.tolerance = 1e-9, .max_iterations = 8};

/// The rotation vector of a rotation by less than half a turn.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd rotation(R);
  return rotation.angle() * rotation.axis();
}

/// (p_cmd − p; rotation vector of R_cmd Rᵀ).
Vector6 pose_error(const Pose& command, const Pose& measured) {
  Vector6 error;
  error.head<3>() = command.p_BP - measured.p_BP;
  error.tail<3>() = rotation_vector(command.R_BP * measured.R_BP.transpose());
  return error;
}

}  // namespace

Vector6 load_forces(const std::array<DriveAxis, model::leg_count>& axes,
                    const Measurement& measured) {
  Vector6 forces;
  for (int i = 0; i < model::leg_count; ++i)
    forces[i] = measured.cap_pressure[i] * axes[i].piston_area -
                measured.rod_pressure[i] * axes[i].annulus_area;
  return forces;
}

Controller::Controller(const model::Machine& machine, const ControllerParameters& parameters)
    : machine_(machine), parameters_(parameters) {
  validate(parameters);
  slow_share_ = -std::expm1(-parameters.feedback_corner * parameters.sample_time);
  for (int i = 0; i < model::leg_count; ++i)
    fixed_speeds_[i] = conditioning_speeds(parameters, i, parameters.axes[i].load);
  state_.X_BP = machine.neutral();
  for (int i = 0; i < model::leg_count; ++i) state_.slow_force[i] = parameters.axes[i].load;
}

void Controller::reset(const Pose& X_BP, const Measurement& measured) {
  state_ = {};
  state_.X_BP = X_BP;
  state_.slow_force = load_forces(parameters_.axes, measured);
  state_.slow_acceleration = measured.acceleration;
}

void Controller::take_over(const Vector6& drives) {
  Vector6 held;
  for (int i = 0; i < model::leg_count; ++i)
    held[i] = speed_of_drive(parameters_, i, drives[i],
                             conditioning_speeds(parameters_, i, state_.slow_force[i]));
  if (parameters_.space == model::ControlSpace::pose) {
    const auto legs = kinematics::inverse_kinematics(machine_, state_.X_BP);
    held = kinematics::leg_jacobian(legs, state_.X_BP.p_BP).partialPivLu().solve(held).eval();
  }
  for (int i = 0; i < 6; ++i)
    state_.integral[i] = parameters_.gain[i] > 0.0 && std::isfinite(held[i])
                             ? parameters_.integral_time * held[i] / parameters_.gain[i]
                             : 0.0;
}

Vector6 Controller::proportional_integral(const Vector6& error) const {
  Vector6 sum = error;
  if (parameters_.integral_time > 0.0) sum += state_.integral / parameters_.integral_time;
  return parameters_.gain.cwiseProduct(sum);
}

Vector6 Controller::pose_space_speed(const Measurement& measured, const Command& command) {
  const auto found =
      kinematics::forward_kinematics(machine_, measured.length, state_.X_BP, forward_options);
  state_.forward = found.status;
  if (found.status != kinematics::ForwardStatus::converged) {
    state_.error.setZero();
    return Vector6::Zero();
  }
  state_.X_BP = found.X_BP;
  state_.error = pose_error(command.X_BP, state_.X_BP);
  const auto legs = kinematics::inverse_kinematics(machine_, state_.X_BP);
  const Matrix6 J = kinematics::leg_jacobian(legs, state_.X_BP.p_BP);
  return J * (proportional_integral(state_.error) +
              parameters_.velocity_feedforward * command.velocity);
}

Vector6 Controller::leg_space_speed(const Measurement& measured, const Command& command) {
  const auto legs = kinematics::inverse_kinematics(machine_, command.X_BP);
  for (int i = 0; i < model::leg_count; ++i) state_.error[i] = legs[i].length - measured.length[i];
  const Matrix6 J = kinematics::leg_jacobian(legs, command.X_BP.p_BP);
  return proportional_integral(state_.error) +
         parameters_.velocity_feedforward * (J * command.velocity);
}

Vector6 Controller::damping_speed(const Measurement& measured) {
  const Vector6 force = load_forces(parameters_.axes, measured);
  const Vector6 fast_force = force - state_.slow_force;
  const Vector6 fast_acceleration = measured.acceleration - state_.slow_acceleration;
  state_.slow_force += slow_share_ * fast_force;
  state_.slow_acceleration += slow_share_ * fast_acceleration;
  switch (parameters_.feedback) {
    case model::DampingFeedback::pressure:
      return parameters_.feedback_gain.cwiseProduct(fast_force);
    case model::DampingFeedback::acceleration:
      return parameters_.feedback_gain.cwiseProduct(fast_acceleration);
    case model::DampingFeedback::none:
      break;
  }
  return Vector6::Zero();
}

Vector6 Controller::step(const Measurement& measured, const Command& command) {
  const bool pose_space = parameters_.space == model::ControlSpace::pose;
  Vector6 speed =
      pose_space ? pose_space_speed(measured, command) : leg_space_speed(measured, command);
  const Vector6 slow_force = state_.slow_force;
  speed -= damping_speed(measured);
  if (state_.forward != kinematics::ForwardStatus::converged) speed.setZero();
  state_.wanted_speed = speed;
  Vector6 drives;
  bool any_limited = false;
  const bool at_load = parameters_.compensation == model::Compensation::load;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto speeds =
        at_load ? conditioning_speeds(parameters_, i, slow_force[i]) : fixed_speeds_[i];
    const auto drive = condition(parameters_, i, speed[i], speeds);
    drives[i] = drive.value;
    state_.limited[i] = drive.limited;
    any_limited |= drive.limited;
  }
  if (!any_limited) state_.integral += parameters_.sample_time * state_.error;
  return drives;
}

}  // namespace hydrapod::control
