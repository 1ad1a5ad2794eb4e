#pragma once
/// The controller of a hexapod as it runs on a real machine: leg lengths and pressures in, drives
/// of the six servo valves out, once per sample.
///
/// 1. Pose space: the pose X_BP from the measured leg lengths by forward kinematics, starting at
/// the
///    last one; e = (p_cmd − p; rotation vector of R_cmd Rᵀ) in base axes, about the origin of P;
///    J = ∂l/∂(x…rz) at the measured pose. Leg space: e = l(X_cmd) − l, J at the commanded pose.
/// 2. Wanted speed of the pistons
///        v = J (G e + G/T_i ∫e dt + k_ff V_cmd) − g f        (pose space; in leg space J only
///        before V)
///    with f the load force p_1 A_1 − p_2 A_2, or the piston's acceleration, less its low-passed
///    self:
///        f_k = F_k − s_k,   s_{k+1} = s_k + (1 − e^{−ω_c T}) (F_k − s_k).
/// 3. Signal conditioning per leg: v over the speed at full drive (parameters.hpp; under the slow
/// load
///    s_k for Compensation::load), the valve's overlap jumped over (within 0.2 % of full drive
///    around zero in proportion), times scale, plus offset, limited, rounded to the converter's
///    step.
///
/// The integral stands still while any drive is at its limit. A step allocates nothing and never
/// throws; it takes a few microseconds (bench/control_bench.cpp).
///
/// The numbers a controller runs with: nothing left to defaults.
///
/// The controller for small motions about an equilibrium: as a sampled system, and as the
/// continuous one that it approaches with ever faster sampling.
///
///     ξ_{k+1} = A_d ξ_k + B_d u_k   or   ξ̇ = A ξ + B u,      drives = C ξ + D u
///
/// u = (leg lengths 6, cap pressures 6, rod pressures 6, piston accelerations 6, commanded
/// displacement of the pose 6 (as in spatial::displaced), commanded velocity 6), ξ = (∫e 6, where
/// there is an integral; slow parts of the load forces 6, where pressures are fed back or drives
/// are corrected for the load; of the accelerations 6, where these are fed back). Limits, rounding,
/// noise and the computation's delay are not in it.
///
/// What holds the machine against leakage are drives d_0 of wanted speeds v_0 = J w_0. Two small
/// terms follow from them: ∂(J w_0)/∂pose · J⁻¹ δl in pose space, and under Compensation::load
/// −(∂d/∂v) v_0 ∂(ln v_full)/∂s · δs by the slow load s.

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::control {

using spatial::Matrix6;
using spatial::Pose;
using spatial::Vector6;

/// A valve and its cylinder as signal conditioning sees them. With chamber pressures p_1, p_2 the
/// steady speed at the drive d (a share of the rated one) under the load force F = p_1 A_1 − p_2
/// A_2 follows from Q = K d √Δp at both edges:
///
///     extending   v = d K √[(p_s A_1 − p_t A_2 − F) / (A_1³ + A_2³)]
///     retracting  v = d K √[(p_s A_2 − p_t A_1 + F) / (A_1³ + A_2³)]
struct DriveAxis {
  double piston_area{};       ///< A_1 [m²]
  double annulus_area{};      ///< A_2 [m²]
  double flow_coefficient{};  ///< K [m³/(s √Pa)] of one edge at full drive
  double supply_pressure{};   ///< p_s [Pa]
  double return_pressure{};   ///< p_t [Pa]
  double overlap{};           ///< of the spool, as a share of the drive's range
  double load{};              ///< F [N] at the neutral pose
  /// [m/s] at full drive, whatever the load: of an electric drive, which has no areas, flow and
  /// pressures; 0: of a valve.
  double full_speed{};
};

struct AxisSpeeds {
  double extending{};   ///< [m/s] at full drive
  double retracting{};  ///< [m/s], positive
};

/// The speeds at full drive under the load force [N]. What is left to drive the flow counts as no
/// less than 1/25 of the supply's force on the piston, so the speed is never less than a fifth of
/// that without any load.
AxisSpeeds full_drive_speeds(const DriveAxis& axis, double load);

struct ControllerParameters {
  model::ControlSpace space{model::ControlSpace::pose};
  Vector6 gain{Vector6::Zero()};  ///< G [1/s]
  double integral_time{};         ///< T_i [s], 0: no integral
  double velocity_feedforward{1.0};
  model::DampingFeedback feedback{model::DampingFeedback::none};
  Vector6 feedback_gain{Vector6::Zero()};  ///< per leg, [m/(N s)] or [s]
  double feedback_corner{};                ///< [rad/s]
  double sample_time{1e-3};                ///< [s]
  double delay{};                          ///< [samples]; not the controller's: its computer's
  model::Compensation compensation{model::Compensation::load};
  double overlap_compensation{};
  model::DriveOutput output{};
  std::array<DriveAxis, model::leg_count> axes{};
};

/// Throws std::invalid_argument naming the parameter: not finite, a negative gain or time, an axis
/// without area, flow or pressure.
void validate(const ControllerParameters& parameters);

/// What the sensors show.
struct Measurement {
  Vector6 length{Vector6::Zero()};        ///< leg lengths l [m]
  Vector6 cap_pressure{Vector6::Zero()};  ///< p_1 [Pa]
  Vector6 rod_pressure{Vector6::Zero()};  ///< p_2 [Pa]
  Vector6 acceleration{Vector6::Zero()};  ///< of the pistons in the cylinders, s̈ [m/s²]
};

/// What the platform should do.
struct Command {
  Pose X_BP{};                        ///< pose of P
  Vector6 velocity{Vector6::Zero()};  ///< (velocity of P's origin, angular velocity), base axes
};

struct ControllerState {
  Pose X_BP{};                                   ///< last pose from the leg lengths
  Vector6 error{Vector6::Zero()};                ///< e [m, rad] or [m]
  Vector6 integral{Vector6::Zero()};             ///< ∫e dt
  Vector6 slow_force{Vector6::Zero()};           ///< s of the load forces [N]
  Vector6 slow_acceleration{Vector6::Zero()};    ///< s of the accelerations [m/s²]
  Vector6 wanted_speed{Vector6::Zero()};         ///< v [m/s]
  std::array<bool, model::leg_count> limited{};  ///< the drive is at its limit
  kinematics::ForwardStatus forward{kinematics::ForwardStatus::converged};
};

class Controller {
 public:
  /// Throws std::invalid_argument for parameters that do not hold (validate).
  Controller(const model::Machine& machine, const ControllerParameters& parameters);

  /// Starts anew at `X_BP` with the slow parts of the feedback at what is measured now.
  void reset(const Pose& X_BP, const Measurement& measured);

  /// After reset(): the integral begins where the drives come out as `drives` for no error, as far
  /// as there is an integral, so that a machine held by them is taken over without a bump.
  void take_over(const Vector6& drives);

  /// One sample: drives of legs 1…6, shares of the rated one. Where forward kinematics finds no
  /// pose (state().forward tells), the wanted speeds are zero.
  Vector6 step(const Measurement& measured, const Command& command);

  [[nodiscard]] const ControllerState& state() const { return state_; }
  [[nodiscard]] const ControllerParameters& parameters() const { return parameters_; }

 private:
  [[nodiscard]] Vector6 pose_space_speed(const Measurement& measured, const Command& command);
  [[nodiscard]] Vector6 leg_space_speed(const Measurement& measured, const Command& command);
  /// g f, and moves the slow parts on.
  [[nodiscard]] Vector6 damping_speed(const Measurement& measured);
  [[nodiscard]] Vector6 proportional_integral(const Vector6& error) const;

  model::Machine machine_;
  ControllerParameters parameters_;
  std::array<AxisSpeeds, model::leg_count> fixed_speeds_{};
  double slow_share_{};  ///< 1 − e^{−ω_c T}
  ControllerState state_{};
};

/// Load forces p_1 A_1 − p_2 A_2 [N].
Vector6 load_forces(const std::array<DriveAxis, model::leg_count>& axes,
                    const Measurement& measured);

/// Where the inputs of a LinearController begin.
struct ControllerInputs {
  static constexpr int length = 0, cap_pressure = 6, rod_pressure = 12, acceleration = 18,
                       command = 24, velocity = 30, count = 36;
};

struct LinearController {
  Eigen::MatrixXd A{}, B{};           ///< continuous
  Eigen::MatrixXd A_d{}, B_d{};       ///< sampled
  Eigen::MatrixXd C{}, D{};           ///< both
  std::vector<std::string> states{};  ///< "integral x", …, "slow force of leg 1", …
};

/// About `X_BP`, commanded and measured, with the drives [shares] that hold it and the load forces
/// [N] at it.
LinearController linear_controller(const model::Machine& machine,
                                   const ControllerParameters& parameters, const Pose& X_BP,
                                   const Vector6& drives, const Vector6& loads);

}  // namespace hydrapod::control
