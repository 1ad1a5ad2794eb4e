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
/// A leg may also be a plain strut, a spring and a damper between its joints without mass, or an
/// electric cylinder, with a driven screw in place of the oil.

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/base/units.hpp"
#include "hydrapod/model/servo_hydraulics.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::model {

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

/// Springs in series with dampers beside a seal's spring k (Prony series):
/// k(iω) = k (1 + Σ g_j iωτ_j/(1 + iωτ_j)).
struct MaxwellArms {
  Vector3 strength{Vector3::Zero()};  ///< g_j ≥ 0, spring of an arm over k
  Vector3 time{Vector3::Zero()};      ///< τ_j [s] in which it relaxes
};

/// What makes an O-ring a spring whose stiffness depends on frequency, amplitude and pressure
/// (docs/theory/elastomers.md). The seal's `stiffness` k is that of slow and small motions.
/// Either `arms`, or the three numbers above it, from which arms follow.
struct Elastomer {
  std::optional<double> dynamic_ratio{};  ///< k'(ω)/k at `frequency`, > 1
  std::optional<double> loss_factor{};    ///< η = k''/k' there, > 0
  std::optional<double> frequency{};      ///< [Hz] at which both hold
  std::optional<MaxwellArms> arms{};
  double softening{};                ///< share of k that large amplitudes take away, [0, 1)
  double softening_amplitude{1e-4};  ///< [m] at which half of that is gone
  double softening_time{1.0};        ///< τ [s] in which a simulation takes means of the amplitude
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

/// A spring and a damper between the joints, without mass, case and rod (docs/theory/leg.md, "Plain
/// struts").
struct Strut {
  double stiffness{};  ///< [N/m]
  double damping{};    ///< [N s/m], viscous, parallel to the spring
};

/// What drives an electric cylinder: motor, screw and nut, in place of the oil (docs/theory/
/// actuators.md). Its case, rod and guide bush are `cylinder_case`, `rod` and `guide_sleeve`.
struct Screw {
  double stiffness{};                    ///< k_a [N/m] of screw, nut and bearings along the axis
  double damping{};                      ///< c_a [N s/m], parallel to it
  double lead{};                         ///< p [m] that the nut moves per revolution
  double inertia{};                      ///< J [kg m²] of rotor, coupling and screw
  std::optional<double> torque_limit{};  ///< T_max [N m] of the motor
  std::optional<double> speed_limit{};   ///< ω_max [rad/s] of the motor
  double friction_torque{};              ///< T_f [N m], Coulomb
  double viscous_friction{};             ///< b [N m s/rad]
  double speed_bandwidth{50.0};          ///< ω_s/2π [Hz] of the speed loop
  /// t_i [s] of the speed loop; absent: both poles of a rotor without load are at ω_s/2.
  std::optional<double> speed_integral_time{};

  /// 2π/p [rad/m]: turns of the motor per motion of the nut, and force per torque.
  [[nodiscard]] double ratio() const { return base::two_pi / lead; }
  /// J (2π/p)² [kg], which the inertia is along the leg.
  [[nodiscard]] double reflected_mass() const { return inertia * ratio() * ratio(); }
};

/// What a leg is along its axis. All six are alike.
enum class LegType {
  cylinder,  ///< hydraulic: case, rod, guide sleeve, oil
  strut,     ///< Strut alone
  screw      ///< electric cylinder: case, rod, guide sleeve, Screw
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
  std::optional<Strut> strut{};  ///< in place of everything from `cylinder_case` to `stroke`
  std::optional<Screw> screw{};  ///< in place of `oil_spring`
  JointLimits joint_limits{};
  double added_axial_inertia{};  ///< m_a [kg], moves with the piston only
  /// k_j [N/m] of both gimbals and their fastening along the leg; absent: they are rigid.
  std::optional<double> gimbal_stiffness{};
  /// k_b [N/m] of cylinder seals that stick at the amplitude of the motion: between rod and case,
  /// beside the oil, gimbals in series with both; 0: they slide. Simulations with valves have friction in its place.
  double stick_stiffness{};
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
  viscous,   ///< `oil_spring.damping`, a damper parallel to the oil spring
  chambers,  ///< leakage and valve at rest: each chamber is a spring in series with a damper, as in
             ///< simulations (docs/theory/hydraulics.md, "Oil damping in the linear models")
  automatic  ///< `chambers` where a leg states leakage or a valve, which `oil_spring.damping`
             ///< stands for in other machines, else `viscous`
};

/// Damping that is not a named damper. Added to the viscous dampers of the legs.
struct Damping {
  /// ζ of every mode; see ModalRatio for what holds where it is not set.
  std::optional<double> modal_ratio{};
  double rayleigh_mass{};       ///< α [1/s] of C = α M + β K
  double rayleigh_stiffness{};  ///< β [s]
  OilDamping oil{OilDamping::automatic};
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

/// ζ that every mode of the linear models has on top of the dampers: none with chambers, else
/// seal_ratio().
ModalRatio modal_ratio(const Machine& machine);

/// ζ of seals and base mount where these get dampers of their own (simulations, and linear models
/// with chambers): `damping.modal_ratio` where it is set; else `default_modal_ratio`
/// where the legs have no damper and Rayleigh's damping is zero; else 0.
ModalRatio seal_ratio(const Machine& machine);

/// Are the oil columns of the linear models two chambers per leg, with leakage and valve? What
/// OilDamping::automatic stands for follows from the legs.
bool has_chambers(const Machine& machine);

LegType leg_type(const Leg& leg);
/// That of the first leg.
inline LegType leg_type(const Machine& machine) { return leg_type(machine.legs.front()); }

/// Do rod or case of a leg bend?
bool has_elastic_legs(const Machine& machine);

/// Outside diameter of the rod [m]: `rod.diameter`, else that of the oil spring's cylinder; nothing
/// where neither says it.
std::optional<double> rod_diameter(const Leg& leg);

/// Is a seal an elastomer?
bool has_elastomers(const Machine& machine);
/// Does the pressure of the oil stiffen one?
bool has_pressed_seals(const Machine& machine);

/// Has a leg a viscous damper: at a guide sleeve, a piston ring or along its axis?
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
