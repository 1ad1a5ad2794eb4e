#pragma once
/// The description of a hydraulic hexapod: what a machine file says, in SI units and radians.
///
/// Frames. Base frame B: origin at the centre of the base joint circle, z towards the platform.
/// Platform frame P: origin at the centre of the platform joint circle. Joint coordinates may be
/// any points, so nothing else depends on circles.
///
/// One leg, from the base joint along its axis n: the cylinder case, fixed to it the guide sleeve
/// at L_g; inside it the piston at l_m = l − l_mn, where the rod (length l_mn, piston to platform
/// joint) begins. The guided length l_mh = L_g − l_m shrinks as the leg extends.
///
/// Source: Zhang & Jiang, Energies 2021, 14, 1604; letters as in docs/notation.md.
///
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
/// (control/controller.hpp).
///
/// The servo-hydraulics of a hexapod as plain data: valves, supply, leakage, friction, end stops.
///
/// Only simulation needs it, and a machine file may leave all of it out. What has a default here
/// has it for every machine; what is optional follows from the machine by the rules of
/// hydraulics/servo_axis.hpp, and `hydrapod check` prints what was assumed.
///
/// Pressures are absolute. SI units.

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

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
  /// [N m/rad] of what sticks before it slides (LuGre); modes at amplitudes only.
  std::optional<double> bristle_stiffness{};
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

using spatial::Matrix3;
using spatial::Pose;
using spatial::Vector3;

inline constexpr int leg_count = 6;
inline constexpr double standard_gravity = 9.80665;  ///< [m/s²]

/// Cylinder case, axisymmetric about the leg's axis.
struct CylinderCase {
  double mass{};                     ///< m_t [kg], ≥ 0
  double mass_center{};              ///< r_b [m] from the base joint along the axis
  double transverse_inertia{};       ///< I_t [kg m²] about its mass centre
  double axial_inertia{};            ///< I_ta [kg m²], used with FlexibleAxes::gimbal only
  std::optional<double> diameter{};  ///< outside [m], with `wall`; absent: the case does not bend
  std::optional<double> wall{};      ///< [m]
};

/// Rod with piston, axisymmetric.
struct Rod {
  double length{};                   ///< l_mn [m], piston to platform joint
  double mass{};                     ///< m_g [kg], ≥ 0
  double mass_center{};              ///< c_g [m] from the piston towards the platform
  double transverse_inertia{};       ///< I_r [kg m²] about its mass centre
  double axial_inertia{};            ///< I_ra [kg m²], used with FlexibleAxes::gimbal only
  std::optional<double> diameter{};  ///< outside [m]; absent: that of the oil spring's cylinder
  std::optional<double> wall{};      ///< [m] of a hollow rod; absent: it is solid
  double youngs_modulus{2.06e11};    ///< E [Pa] of rod and case: steel
  double yield_strength{3.55e8};     ///< R_e [Pa] of the rod
};

/// What makes an O-ring a spring whose stiffness depends on frequency, amplitude and pressure
/// (docs/theory/elastomers.md). The seal's `stiffness` k is that of slow and small motions.
struct Elastomer {
  double dynamic_ratio{};            ///< k'(ω)/k at `frequency`, > 1
  double loss_factor{};              ///< η = k''/k' there, > 0
  double frequency{};                ///< [Hz] at which both hold
  double softening{};                ///< share of k that large amplitudes take away, [0, 1)
  double softening_amplitude{1e-4};  ///< [m] at which half of that is gone
  double pressure_stiffening{};      ///< growth of k per pressure of the oil beside the seal [1/Pa]
};

/// The step seals' O-rings in the guide sleeve: lateral spring between case and rod; and the guide
/// ring, on which the rod lies where the O-rings yield by more than `gap`.
struct GuideSleeve {
  double position{};            ///< L_g [m] from the base joint
  double stiffness{};           ///< k_s [N/m]
  double damping{};             ///< c_s [N s/m]
  std::optional<double> gap{};  ///< g [m] from the rod to the guide ring; absent: never touched
  double guide_stiffness{5e7};  ///< k_c [N/m] of the guide ring beyond the gap
  std::optional<Elastomer> elastomer{};  ///< absent: an ideal spring
};

/// The glyd ring's O-ring at the piston: lateral spring between case and piston.
struct PistonRing {
  double stiffness{};  ///< k_g [N/m]
  double damping{};    ///< c_u [N s/m]
  std::optional<Elastomer> elastomer{};
};

/// Where the piston can be: l_m in [retracted, retracted + length].
struct Stroke {
  double retracted{};  ///< l_m [m] with the piston at the cap end
  double length{};     ///< [m]
};

/// Air carried in the oil as bubbles.
struct EntrainedAir {
  double fraction{};       ///< volume share at atmospheric pressure, [0, 1)
  double pressure{};       ///< mean absolute chamber pressure [Pa]
  double polytropic{1.4};  ///< exponent n of p Vⁿ
};

enum class VolumeRule {
  chambers,  ///< the two true volumes at the pose
  equal      ///< Eq. 16: both chambers hold V_0 at every pose
};

/// What the oil spring follows from when it is not given directly.
struct Cylinder {
  double bore{};                 ///< [m]
  double rod_diameter{};         ///< [m]
  double cap_dead_volume{};      ///< [m³] chamber on the base side
  double rod_dead_volume{};      ///< [m³] chamber around the rod
  double cap_line_volume{};      ///< [m³]
  double rod_line_volume{};      ///< [m³]
  double cap_line_length{};      ///< [m] of the line to the valve, 0: its oil has no inertia
  double rod_line_length{};      ///< [m]
  double cap_line_compliance{};  ///< [m³/Pa] of the hose's wall: volume per pressure
  double rod_line_compliance{};  ///< [m³/Pa]
  double density{870.0};         ///< ρ [kg/m³] of the oil in the lines
  double bulk_modulus{};         ///< β_e [Pa] of the oil without air
  std::optional<EntrainedAir> air{};
  VolumeRule volumes{VolumeRule::chambers};
  std::optional<double> control_volume{};  ///< V_0 [m³] for VolumeRule::equal; default: the mean of
                                           ///< both chambers at mid stroke
};

/// The oil column as a spring along the axis: exactly one of `stiffness` and `cylinder` is set.
struct OilSpring {
  std::optional<double> stiffness{};  ///< k_h [N/m]
  std::optional<Cylinder> cylinder{};
  double damping{};  ///< c_h [N s/m], viscous, parallel to the spring
};

/// Largest tilt of a joint from where it stands at the neutral pose.
struct JointLimits {
  std::optional<double> base{};      ///< [rad]
  std::optional<double> platform{};  ///< [rad]
};

/// What the lateral forces at the guide sleeve do to rod and case.
enum class LegBending {
  rigid,   ///< nothing: only the seals are compliant
  elastic  ///< beams, by `rod.diameter`, `rod.wall`, `case.diameter`, `case.wall` and
           ///< `rod.youngs_modulus`, in series with the guide sleeve (docs/theory/leg.md)
};

struct Leg {
  Vector3 base_joint{Vector3::Zero()};      ///< b in B [m]
  Vector3 platform_joint{Vector3::Zero()};  ///< a_P in P [m]
  CylinderCase cylinder_case{};
  Rod rod{};
  GuideSleeve guide_sleeve{};
  std::optional<PistonRing> piston_ring{};  ///< absent: the piston ring is rigid (k_g → ∞)
  LegBending bending{LegBending::rigid};
  OilSpring oil_spring{};
  std::optional<Stroke> stroke{};
  JointLimits joint_limits{};
  double added_axial_inertia{};  ///< m_a [kg], moves with the piston only
  /// k_j [N/m] of both gimbals and their fastening along the leg; absent: they are rigid.
  std::optional<double> gimbal_stiffness{};
  Vector3 gimbal_axis{Vector3::UnitY()};  ///< a1: base-fixed axis of the lower gimbal, unit, in B
  /// I_c [kg m²] of the lower gimbal's cross about a1; used with FlexibleAxes::gimbal only.
  double gimbal_cross_inertia{};
  LegHydraulics hydraulics{};  ///< for simulation only
};

/// What the base stands on, as springs between base and ground at the origin of B along its axes.
struct BaseMount {
  /// x, y, z [N/m], rx, ry, rz [N m/rad]; absent: the base does not move that way.
  std::array<std::optional<double>, 6> stiffness{};
  double mass{};                     ///< of the base [kg], ≥ 0, at the origin of B
  Vector3 inertia{Vector3::Zero()};  ///< its moments about the axes of B [kg m²], ≥ 0
};

struct Platform {
  double mass{};                         ///< m [kg], payload included
  Vector3 mass_center{Vector3::Zero()};  ///< p_PC [m] in P
  Matrix3 inertia{Matrix3::Zero()};      ///< I_C [kg m²] about C, axes of P
};

/// A mode of the payload and the platform's structure, with the platform's joints held
/// (docs/theory/payload.md). Its coordinate ξ is normalised to a modal mass of 1 kg and stands at
/// zero under the weight. What it takes part with, about the origin of P in its axes, is
/// participation(): √m (d, r × d) of a mass m at r that swings along d; or the given numbers.
/// Platform::mass, mass_center and inertia contain its mass.
struct PayloadMode {
  std::string name{};
  double frequency{};      ///< ω/2π [Hz]
  double damping_ratio{};  ///< ζ, on top of `damping`
  /// m [kg] that swings: exactly one of `mass` and `participation` is set.
  std::optional<double> mass{};
  Vector3 position{Vector3::Zero()};    ///< r of that mass in P [m]
  Vector3 direction{Vector3::UnitX()};  ///< d in P, of any length but zero
  /// Σ m_i φ_i [kg] and Σ m_i r_i × φ_i [kg m] per Σ m_i φ_i² = 1 kg.
  std::optional<Vector3> participation{};
  Vector3 participation_moment{Vector3::Zero()};
};

/// More modes than a payload can be told to have by measurements of a hexapod.
inline constexpr int most_payload_modes = 6;

/// Directions of the flexible axes at the piston.
enum class FlexibleAxes {
  transverse,  ///< two axes normal to the leg; nothing spins about the leg's axis
  gimbal       ///< parallel to the lower gimbal's axes; axial spin and inertia follow from it
};

/// Used for every mode where a machine gives no damping of any kind; every output says so.
inline constexpr double default_modal_ratio = 0.02;

/// What damps the oil in the linear models.
enum class OilDamping {
  viscous,  ///< `oil_spring.damping`, a damper parallel to the oil spring
  chambers  ///< leakage and valve at rest: each chamber is a spring in series with a damper, as in
            ///< simulations (docs/theory/hydraulics.md, "Oil damping in the linear models")
};

/// Damping that is not a named damper. Added to the viscous dampers of the legs.
struct Damping {
  /// ζ of every mode; see ModalRatio for what holds where it is not set.
  std::optional<double> modal_ratio{};
  double rayleigh_mass{};       ///< α [1/s] of C = α M + β K
  double rayleigh_stiffness{};  ///< β [s]
  OilDamping oil{OilDamping::viscous};
};

struct NamedPose {
  std::string name{};
  Pose X_BP{};
};

/// Joints on a circle of radius r in pairs: three pairs, the joints of a pair `spacing` apart
/// (Table 1 of the paper: "gimbal spacing").
struct JointCircle {
  double radius{};   ///< r [m] > 0
  double spacing{};  ///< s [m], 0 < s < 2r
  /// Half the angle between the two joints of a pair: α = asin(s / 2r) [rad].
  [[nodiscard]] double half_angle() const { return std::asin(spacing / (2.0 * radius)); }
};

struct Machine {
  std::string name{};
  std::string description{};
  std::string source{};
  std::string state{};  ///< that the numbers describe, "calibrated"; empty: nominal
  Vector3 gravity{0.0, 0.0, -standard_gravity};  ///< [m/s²] in B
  Platform platform{};
  std::array<Leg, leg_count> legs{};
  std::optional<BaseMount> base_mount{};     ///< absent: the base stands still
  std::vector<PayloadMode> payload_modes{};  ///< none: platform and payload are rigid
  FlexibleAxes flexible_axes{FlexibleAxes::transverse};
  Damping damping{};
  ControlSettings controller{};
  Sensors sensors{};
  Hydraulics hydraulics{};         ///< for simulation only
  std::vector<NamedPose> poses{};  ///< the first one, "neutral", always exists
  /// What the joints were laid out by, so that it can be varied; the legs hold where they are.
  std::optional<JointCircle> base_circle{}, platform_circle{};

  [[nodiscard]] const Pose& neutral() const { return poses.front().X_BP; }
};

/// A damping ratio ζ, and why it has its value.
struct ModalRatio {
  double value{};
  bool is_default{};  ///< nothing in the machine says anything about damping
};

/// ζ that every mode of the linear models has on top of the dampers: none with
/// OilDamping::chambers, else seal_ratio().
ModalRatio modal_ratio(const Machine& machine);

/// ζ of seals and base mount where these get dampers of their own (simulations, and linear models
/// with OilDamping::chambers): `damping.modal_ratio` where it is set; else `default_modal_ratio`
/// where the legs have no damper and Rayleigh's damping is zero; else 0.
ModalRatio seal_ratio(const Machine& machine);

/// Are the oil columns of the linear models two chambers per leg, with leakage and valve?
inline bool has_chambers(const Machine& machine) {
  return machine.damping.oil == OilDamping::chambers;
}

/// Do rod or case of a leg bend?
bool has_elastic_legs(const Machine& machine);

/// Outside diameter of the rod [m]: `rod.diameter`, else that of the oil spring's cylinder; nothing
/// where neither says it.
std::optional<double> rod_diameter(const Leg& leg);

/// Is a seal an elastomer?
bool has_elastomers(const Machine& machine);
/// Does the pressure of the oil stiffen one?
bool has_pressed_seals(const Machine& machine);

/// Has a leg a viscous damper: at a guide sleeve, a piston ring or beside the oil spring?
bool has_leg_dampers(const Machine& machine);
bool has_rayleigh_damping(const Machine& machine);

/// L of a payload's mode about the point `p` of P (its origin; its mass centre), axes of P: [kg]
/// and [kg m], for a modal mass of 1 kg.
Vector6 participation(const PayloadMode& mode, const Vector3& p = Vector3::Zero());

/// Mass matrix of the platform about its mass centre, axes of P, less Σ L Lᵀ of the payload's
/// modes: what is left of it when all of them swing freely.
Eigen::Matrix<double, 6, 6> mass_without_payload_modes(const Machine& machine);

using JointPoints = std::array<Vector3, leg_count>;

/// Joints of legs 1…6 in B (z = 0): pairs at 60°, 180°, 300°; leg 1 at 60° − α, leg 2 at 60° + α,
/// ….
JointPoints base_joint_points(const JointCircle& circle);

/// Joints of legs 1…6 in P (z = 0): pairs at 0°, 120°, 240°; leg 1 at 0° + α, leg 2 at 120° − α, ….
JointPoints platform_joint_points(const JointCircle& circle);

}  // namespace hydrapod::model
