#pragma once
/// The numbers a controller runs with: nothing left to defaults.

#include <array>

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

}  // namespace hydrapod::control
