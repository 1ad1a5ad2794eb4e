#include "hydrapod/control/controller.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "conditioning.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::control {

namespace {

using Inputs = ControllerInputs;

/// Which slow parts change the drives.
struct SlowParts {
  bool force{}, acceleration{};
  explicit SlowParts(const ControllerParameters& parameters)
      : force(parameters.feedback == model::DampingFeedback::pressure ||
              parameters.compensation == model::Compensation::load),
        acceleration(parameters.feedback == model::DampingFeedback::acceleration) {}
};

/// Without it ∫e moves nothing, and its poles at zero would make every loop look unstable.
bool has_integral(const ControllerParameters& parameters) { return parameters.integral_time > 0.0; }

std::vector<std::string> state_names(const ControllerParameters& parameters) {
  using spatial::direction_names;
  std::vector<std::string> names;
  for (int i = 0; has_integral(parameters) && i < 6; ++i)
    names.push_back(parameters.space == model::ControlSpace::pose
                        ? fmt::format("integral {}", direction_names[i])
                        : fmt::format("integral of leg {}", i + 1));
  const SlowParts slow(parameters);
  for (int i = 1; slow.force && i <= 6; ++i)
    names.push_back(fmt::format("slow force of leg {}", i));
  for (int i = 1; slow.acceleration && i <= 6; ++i)
    names.push_back(fmt::format("slow acceleration of leg {}", i));
  return names;
}

/// Load forces per input, 6 × 36.
Eigen::MatrixXd force_signal(const ControllerParameters& parameters) {
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(6, Inputs::count);
  for (int i = 0; i < 6; ++i) {
    F(i, Inputs::cap_pressure + i) = parameters.axes[i].piston_area;
    F(i, Inputs::rod_pressure + i) = -parameters.axes[i].annulus_area;
  }
  return F;
}

/// ∂(J w)/∂(displacement of the pose). With ρ = a − p and u = w_v + w_ω × ρ, the speed of the joint
/// a, the leg's speed is n·u; a displacement (δp; δθ) moves a by δa = δp + δθ × ρ:
///
///     δ(n·u) = u⊥·δa / l + (n × w_ω)·(δθ × ρ)
Matrix6 turned_speeds(const kinematics::LegGeometries& legs, const Pose& X_BP, const Vector6& w) {
  using spatial::Vector3;
  Matrix6 slope;
  for (int i = 0; i < 6; ++i) {
    const Vector3 n = legs[i].n, rho = legs[i].a - X_BP.p_BP, turning = w.tail<3>();
    const Vector3 u = w.head<3>() + turning.cross(rho);
    const Vector3 across = (u - n.dot(u) * n) / legs[i].length;
    slope.row(i) << across.transpose(),
        (rho.cross(across) + rho.cross(n.cross(turning))).transpose();
  }
  return slope;
}

/// ∂drive/∂(slow load) [1/N] of a leg that is held by `drive` with the wanted speed `speed`.
double drive_per_load(const ControllerParameters& parameters, int leg, double load, double drive,
                      double speed) {
  if (parameters.compensation != model::Compensation::load) return 0.0;
  const double over_speed = log_speed_per_load(parameters.axes[leg], load, speed > 0.0);
  return -drive_per_speed(parameters, leg, load, drive) * speed * over_speed;
}

}  // namespace

LinearController linear_controller(const model::Machine& machine,
                                   const ControllerParameters& parameters, const Pose& X_BP,
                                   const Vector6& drives, const Vector6& loads) {
  const bool pose_space = parameters.space == model::ControlSpace::pose;
  const auto legs = kinematics::inverse_kinematics(machine, X_BP);
  const Matrix6 J = kinematics::leg_jacobian(legs, X_BP.p_BP);
  const Matrix6 to_legs = pose_space ? J : Matrix6::Identity();

  Eigen::MatrixXd error = Eigen::MatrixXd::Zero(6, Inputs::count);
  error.middleCols<6>(Inputs::length) = pose_space ? Matrix6(-J.inverse()) : -Matrix6::Identity();
  error.middleCols<6>(Inputs::command) = pose_space ? Matrix6::Identity() : J;

  const Matrix6 G = to_legs * parameters.gain.asDiagonal();
  Matrix6 slope = Matrix6::Zero(), per_load = Matrix6::Zero();
  Vector6 held;  // wanted speeds that hold the machine
  for (int i = 0; i < 6; ++i) {
    held[i] =
        speed_of_drive(parameters, i, drives[i], conditioning_speeds(parameters, i, loads[i]));
    slope(i, i) = drive_per_speed(parameters, i, loads[i], drives[i]);
    per_load(i, i) = drive_per_load(parameters, i, loads[i], drives[i], held[i]);
  }

  LinearController linear{.states = state_names(parameters)};
  const int n = static_cast<int>(linear.states.size());
  linear.A = linear.A_d = Eigen::MatrixXd::Zero(n, n);
  linear.A_d.setIdentity();
  linear.B = linear.B_d = Eigen::MatrixXd::Zero(n, Inputs::count);
  linear.C = Eigen::MatrixXd::Zero(6, n);
  linear.D = G * error;
  linear.D.middleCols<6>(Inputs::velocity) += parameters.velocity_feedforward * J;
  if (pose_space) {
    const Matrix6 J_inverse = J.inverse();
    linear.D.middleCols<6>(Inputs::length) +=
        turned_speeds(legs, X_BP, J_inverse * held) * J_inverse;
  }
  int first = 0;
  if (has_integral(parameters)) {
    linear.B.topRows<6>() = error;
    linear.B_d.topRows<6>() = parameters.sample_time * error;
    linear.C.leftCols<6>() = G / parameters.integral_time;
    first = 6;
  }
  linear.C = (slope * linear.C).eval();
  linear.D = (slope * linear.D).eval();

  const double share = -std::expm1(-parameters.feedback_corner * parameters.sample_time);
  /// States that follow `signal` slowly; what is left of it slows the legs by `gain`.
  const auto add_slow = [&](const Eigen::MatrixXd& signal, const Matrix6& gain) {
    linear.A.block<6, 6>(first, first) = -parameters.feedback_corner * Matrix6::Identity();
    linear.A_d.block<6, 6>(first, first) = (1.0 - share) * Matrix6::Identity();
    linear.B.middleRows<6>(first) = parameters.feedback_corner * signal;
    linear.B_d.middleRows<6>(first) = share * signal;
    linear.C.middleCols<6>(first) += slope * gain;
    linear.D -= slope * gain * signal;
    first += 6;
  };
  const SlowParts slow(parameters);
  const Matrix6 gain = parameters.feedback_gain.asDiagonal();
  if (slow.force) {
    const bool fed_back = parameters.feedback == model::DampingFeedback::pressure;
    linear.C.middleCols<6>(first) = per_load;  // zero unless the load is compensated
    add_slow(force_signal(parameters), fed_back ? gain : Matrix6(Matrix6::Zero()));
  }
  if (slow.acceleration) {
    Eigen::MatrixXd signal = Eigen::MatrixXd::Zero(6, Inputs::count);
    signal.middleCols<6>(Inputs::acceleration).setIdentity();
    add_slow(signal, gain);
  }
  return linear;
}

}  // namespace hydrapod::control
