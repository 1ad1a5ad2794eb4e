#include "hydrapod/control/linear_controller.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "conditioning.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::control {

namespace {

using Inputs = ControllerInputs;

std::vector<std::string> state_names(const ControllerParameters& parameters) {
  using spatial::direction_names;
  std::vector<std::string> names;
  for (int i = 0; i < 6; ++i)
    names.push_back(parameters.space == model::ControlSpace::pose
                        ? fmt::format("integral {}", direction_names[i])
                        : fmt::format("integral of leg {}", i + 1));
  if (parameters.feedback == model::DampingFeedback::none) return names;
  const bool pressure = parameters.feedback == model::DampingFeedback::pressure;
  for (int i = 1; i <= 6; ++i)
    names.push_back(fmt::format("slow {} of leg {}", pressure ? "force" : "acceleration", i));
  return names;
}

/// The fed-back force or acceleration per input, 6 × 36.
Eigen::MatrixXd feedback_signal(const ControllerParameters& parameters) {
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(6, Inputs::count);
  for (int i = 0; i < 6; ++i) {
    if (parameters.feedback == model::DampingFeedback::acceleration) {
      F(i, Inputs::acceleration + i) = 1.0;
    } else {
      F(i, Inputs::cap_pressure + i) = parameters.axes[i].piston_area;
      F(i, Inputs::rod_pressure + i) = -parameters.axes[i].annulus_area;
    }
  }
  return F;
}

}  // namespace

LinearController linear_controller(const model::Machine& machine,
                                   const ControllerParameters& parameters, const Pose& X_BP,
                                   const Vector6& drives, const Vector6& loads) {
  const bool pose_space = parameters.space == model::ControlSpace::pose;
  const bool feedback = parameters.feedback != model::DampingFeedback::none;
  const auto legs = kinematics::inverse_kinematics(machine, X_BP);
  const Matrix6 J = kinematics::leg_jacobian(legs, X_BP.p_BP);
  const Matrix6 to_legs = pose_space ? J : Matrix6::Identity();

  Eigen::MatrixXd error = Eigen::MatrixXd::Zero(6, Inputs::count);
  error.middleCols<6>(Inputs::length) = pose_space ? Matrix6(-J.inverse()) : -Matrix6::Identity();
  error.middleCols<6>(Inputs::command) = pose_space ? Matrix6::Identity() : J;

  const Matrix6 G = to_legs * parameters.gain.asDiagonal();
  Matrix6 slope = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) slope(i, i) = drive_per_speed(parameters, i, loads[i], drives[i]);

  LinearController linear{.states = state_names(parameters)};
  const int n = static_cast<int>(linear.states.size());
  linear.A = linear.A_d = Eigen::MatrixXd::Zero(n, n);
  linear.A_d.setIdentity();
  linear.B = linear.B_d = Eigen::MatrixXd::Zero(n, Inputs::count);
  linear.C = Eigen::MatrixXd::Zero(6, n);
  linear.B.topRows<6>() = error;
  linear.B_d.topRows<6>() = parameters.sample_time * error;
  linear.D = G * error;
  linear.D.middleCols<6>(Inputs::velocity) += parameters.velocity_feedforward * J;
  if (parameters.integral_time > 0.0) linear.C.leftCols<6>() = G / parameters.integral_time;
  if (feedback) {
    const Eigen::MatrixXd F = feedback_signal(parameters);
    const double share = -std::expm1(-parameters.feedback_corner * parameters.sample_time);
    const Eigen::MatrixXd gain = parameters.feedback_gain.asDiagonal();
    linear.A.bottomRightCorner<6, 6>() = -parameters.feedback_corner * Matrix6::Identity();
    linear.A_d.bottomRightCorner<6, 6>() = (1.0 - share) * Matrix6::Identity();
    linear.B.bottomRows<6>() = parameters.feedback_corner * F;
    linear.B_d.bottomRows<6>() = share * F;
    linear.C.rightCols<6>() = gain;
    linear.D -= gain * F;
  }
  linear.C = (slope * linear.C).eval();
  linear.D = (slope * linear.D).eval();
  return linear;
}

}  // namespace hydrapod::control
