#pragma once
/// What the machine file says of servo-hydraulics, controller and sensors, as plain data.
///
/// Controller and sensors: the control law stands in control/controller.hpp and
/// docs/theory/control.md. What is not given here follows from the machine.
///
/// Servo-hydraulics: only simulation needs them, and a machine file may leave all of them out. What
/// has a default here has it for every machine; what is optional follows from the machine by the
/// rules of hydraulics/servo_axis.hpp, and `hydrapod check` prints what was assumed. Pressures are
/// absolute.

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

/// Four-edge servo valve with the spool as a lag of second order. Spool positions are fractions of
/// the travel: +1 opens supply to the cap side (the leg extends), −1 to the rod side.
struct ServoValve {
  std::optional<double> rated_flow{};  ///< [m³/s] at full opening and the rated pressure drop
  double rated_pressure_drop{7e6};     ///< [Pa] over both edges together, half of it over each
  double overlap{};                    ///< of the travel; negative: underlap
  double laminar_pressure{1e5};        ///< p_t [Pa]: below it an edge flows laminar
  double natural_frequency{600.0};     ///< ω_v [rad/s]
  double damping_ratio{0.8};           ///< ζ_v
  double rate_limit{100.0};            ///< [1/s] of the travel
  /// Null leakage [m³/s] from supply to return with ports blocked; default: 1 % of the rated flow.
  std::optional<double> leakage{};
};

/// Laminar leakage of a cylinder, flow per pressure.
struct CylinderLeakage {
  std::optional<double> internal{};  ///< [m³/(s Pa)] past the piston
  double external{};                 ///< [m³/(s Pa)] from each chamber to the outside
};

/// Bristles that stick before they slide (LuGre).
struct LuGreBristles {
  double stiffness{};  ///< σ0 [N/m]
  double damping{};    ///< σ1 [N s/m]
};

/// Friction of a cylinder's seals along its axis: Coulomb, Stribeck and viscous.
struct SealFriction {
  std::optional<double> coulomb{};    ///< F_c [N]
  std::optional<double> breakaway{};  ///< F_s [N], at rest; default: 1.5 F_c
  double stribeck_velocity{0.02};     ///< v_s [m/s]
  double smoothing_velocity{0.002};   ///< v_0 [m/s] of tanh(v / v_0); not used with bristles
  std::optional<double> viscous{};    ///< b [N s/m]
  std::optional<LuGreBristles> bristles{};
};

/// Friction in a leg's joints against turning of the leg's axis, at the base joint and at the
/// platform joint.
struct JointFriction {
  double viscous{};             ///< [N m s/rad]
  double coulomb{};             ///< [N m]
  double smoothing_rate{0.01};  ///< [rad/s]
  /// σ0 [N m/rad] of what sticks before it slides (LuGre).
  std::optional<double> bristle_stiffness{};
  double bristle_damping{};  ///< σ1 [N m s/rad]
};

/// What stops the piston at both ends of its stroke.
struct EndStops {
  std::optional<double> stiffness{};  ///< [N/m]; default: 20 times the oil spring
  double damping{0.5};                ///< [s/m]: the force is k δ (1 + damping δ̇)
};

/// Gas-charged accumulator at the supply.
struct Accumulator {
  double gas_volume{};     ///< [m³] of gas at the precharge
  double precharge{};      ///< [Pa]
  double polytropic{1.4};  ///< exponent n of p Vⁿ
};

struct Supply {
  double pressure{14e6};        ///< p_s [Pa]
  double return_pressure{5e5};  ///< p_r [Pa]
  /// Largest flow of the pump [m³/s]; not set: the supply holds its pressure whatever is drawn.
  std::optional<double> pump_flow{};
  std::optional<Accumulator> accumulator{};
  double line_volume{1e-3};  ///< [m³] of oil between pump and valves, with a pump flow only
};

/// The cylinder that stands in for a leg which gives only its oil spring's stiffness.
struct EquivalentCylinder {
  double area_ratio{0.5};        ///< e
  std::optional<double> area{};  ///< A_p [m²]
  double bulk_modulus{1e9};      ///< β_e [Pa]
};

/// What one leg has.
struct LegHydraulics {
  ServoValve valve{};
  CylinderLeakage leakage{};
  SealFriction friction{};
  JointFriction joint_friction{};
  EndStops end_stops{};
  EquivalentCylinder equivalent_cylinder{};
};

/// Lines between valves and chambers whose oil moves by itself: waves (docs/theory/hydraulics.md,
/// "Waves in lines"). Every line that has a length; lengths and volumes are those of Cylinder.
struct Lines {
  double segments{};       ///< N, a whole number; 0: each line is a dead end without waves
  double modes{};          ///< per line, a whole number, in place of segments
  double viscosity{0.04};  ///< μ [Pa s]: 46 mm²/s at 870 kg/m³, an oil of ISO VG 46 at 40 °C
};

/// More segments than a record or a controller can tell apart, and fewer than make a plant slow.
inline constexpr int most_line_segments = 8;

/// What the legs share.
struct Hydraulics {
  Supply supply{};
  Lines lines{};
  double cavitation_pressure{5e4};  ///< [Pa] about which a chamber fills with vapour
};

}  // namespace hydrapod::model
