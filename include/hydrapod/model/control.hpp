#pragma once
/// What the machine file says about the controller and its sensors, in SI units and radians.
///
/// The control law (docs/theory/control.md): per leg a wanted speed of the piston
///
///     v = J (G e + G ∫e dt / T_i + k_ff V_cmd) − f          pose space
///     v = G e + G ∫e dt / T_i + k_ff J V_cmd − f            leg space
///
/// with e the error of the pose or of the leg lengths, G the gains, V_cmd the commanded twist, f
/// the high-passed feedback of load force or acceleration; then signal conditioning turns v into
/// the drive of the valve. What is not given here follows from the machine
/// (control/parameters.hpp).

#include <optional>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::model {

using spatial::Vector6;

enum class ControlSpace {
  pose,  ///< errors of x, y, z, rx, ry, rz by forward kinematics, as in the paper
  leg    ///< errors of the six leg lengths
};

/// Which signal adds damping to the oil modes.
enum class DampingFeedback {
  pressure,  ///< load force from the chamber pressures, high-passed ("dynamic pressure feedback")
  acceleration,  ///< acceleration of the piston in the cylinder, high-passed
  none
};

/// What the signal conditioning corrects of the cylinder's speed per drive.
enum class Compensation {
  load,       ///< the speed at the present load force: needs pressure sensors
  asymmetry,  ///< the speeds of extending and retracting under the load at the neutral pose
  none        ///< one speed for both directions, their mean
};

/// The valve amplifier's input: drive in shares of the rated one, [−1, 1].
struct DriveOutput {
  double limit{1.0};                ///< (0, 1]
  double resolution{1.0 / 32768};   ///< step of the converter, 0: none; default 16 bits over ±1
  Vector6 scale{Vector6::Ones()};   ///< per leg, multiplies the drive
  Vector6 offset{Vector6::Zero()};  ///< per leg, added to the drive: null of the valve
};

struct ControlSettings {
  ControlSpace space{ControlSpace::pose};
  std::optional<Vector6> gain{};      ///< G [1/s], per direction or per leg
  std::optional<double> bandwidth{};  ///< [rad/s], one gain for all instead of `gain`
  /// Where neither is given: this share of the lowest oil mode's frequency.
  static constexpr double default_bandwidth_share = 0.3;
  /// The same without pressure feedback.
  static constexpr double default_bandwidth_share_undamped = 0.05;
  std::optional<double> integral_time{};  ///< T_i [s], 0: no integral; default 8 / smallest gain
  double velocity_feedforward{1.0};       ///< k_ff
  DampingFeedback feedback{DampingFeedback::pressure};
  /// Damping ratio that pressure feedback gives to the lowest oil mode, acceleration feedback to
  /// the highest, unless `feedback_gain` says otherwise.
  double feedback_damping{0.4};
  std::optional<double> feedback_gain{};    ///< [m/(N s)] for pressure, [s] for acceleration
  std::optional<double> feedback_corner{};  ///< of the high pass [rad/s]; default a tenth of the
                                            ///< lowest oil mode's frequency
  double sample_time{1e-3};                 ///< [s]
  double delay{1.0};  ///< from reading the sensors to the new drive, in samples
  Compensation compensation{Compensation::load};
  double overlap_compensation{1.0};  ///< share of the valve's overlap that is jumped over
  DriveOutput output{};
};

/// A sensor: true value, plus noise, clipped to the range, rounded to the resolution.
struct Sensor {
  double resolution{};           ///< 0: none
  double noise{};                ///< RMS of white noise from sample to sample
  std::optional<double> low{};   ///< least value it can show
  std::optional<double> high{};  ///< largest value it can show
};

struct Sensors {
  Sensor length{.resolution = 5e-6, .noise = 2e-6};        ///< leg length [m]
  Sensor pressure{.resolution = 2e3, .noise = 5e3};        ///< chamber pressure [Pa]
  Sensor acceleration{.resolution = 1e-3, .noise = 1e-2};  ///< piston in the cylinder [m/s²]
};

}  // namespace hydrapod::model
