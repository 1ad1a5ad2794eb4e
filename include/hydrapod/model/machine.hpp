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

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/model/control.hpp"
#include "hydrapod/model/hydraulics.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::model {

using spatial::Matrix3;
using spatial::Pose;
using spatial::Vector3;

inline constexpr int leg_count = 6;
inline constexpr double standard_gravity = 9.80665;  ///< [m/s²]

/// Cylinder case, axisymmetric about the leg's axis.
struct CylinderCase {
  double mass{};                ///< m_t [kg], ≥ 0
  double mass_center{};         ///< r_b [m] from the base joint along the axis
  double transverse_inertia{};  ///< I_t [kg m²] about its mass centre
  double axial_inertia{};       ///< I_ta [kg m²], used with FlexibleAxes::gimbal only
};

/// Rod with piston, axisymmetric.
struct Rod {
  double length{};              ///< l_mn [m], piston to platform joint
  double mass{};                ///< m_g [kg], ≥ 0
  double mass_center{};         ///< c_g [m] from the piston towards the platform
  double transverse_inertia{};  ///< I_r [kg m²] about its mass centre
  double axial_inertia{};       ///< I_ra [kg m²], used with FlexibleAxes::gimbal only
};

/// The step seals' O-rings in the guide sleeve: lateral spring between case and rod.
struct GuideSleeve {
  double position{};   ///< L_g [m] from the base joint
  double stiffness{};  ///< k_s [N/m]
  double damping{};    ///< c_s [N s/m]
};

/// The glyd ring's O-ring at the piston: lateral spring between case and piston.
struct PistonRing {
  double stiffness{};  ///< k_g [N/m]
  double damping{};    ///< c_g [N s/m]
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
  double bore{};             ///< [m]
  double rod_diameter{};     ///< [m]
  double cap_dead_volume{};  ///< [m³] chamber on the base side
  double rod_dead_volume{};  ///< [m³] chamber around the rod
  double cap_line_volume{};  ///< [m³]
  double rod_line_volume{};  ///< [m³]
  double bulk_modulus{};     ///< β_e [Pa] of the oil without air
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

struct Leg {
  Vector3 base_joint{Vector3::Zero()};      ///< b in B [m]
  Vector3 platform_joint{Vector3::Zero()};  ///< a_P in P [m]
  CylinderCase cylinder_case{};
  Rod rod{};
  GuideSleeve guide_sleeve{};
  std::optional<PistonRing> piston_ring{};  ///< absent: the piston ring is rigid (k_g → ∞)
  OilSpring oil_spring{};
  std::optional<Stroke> stroke{};
  JointLimits joint_limits{};
  double added_axial_inertia{};  ///< m_a [kg], oil in the lines seen at the piston
  /// k_j [N/m] of both gimbals and their fastening along the leg; absent: they do not give way.
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

/// How the flexible axes of a knee stand.
enum class FlexibleAxes {
  transverse,  ///< two axes normal to the leg; nothing spins about the leg's axis
  gimbal       ///< parallel to the lower gimbal's axes; axial spin and inertia follow from it
};

inline constexpr double default_modal_ratio = 0.02;

/// Damping that is not a named damper. Added to the viscous dampers of the legs.
struct Damping {
  /// Ratio given to every undamped mode. Not set: `default_modal_ratio` where the legs have no
  /// damper and Rayleigh is zero, else 0.
  std::optional<double> modal_ratio{};
  double rayleigh_mass{};       ///< α [1/s] of C = α M + β K
  double rayleigh_stiffness{};  ///< β [s]
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
  Vector3 gravity{0.0, 0.0, -standard_gravity};  ///< [m/s²] in B
  Platform platform{};
  std::array<Leg, leg_count> legs{};
  std::optional<BaseMount> base_mount{};  ///< absent: the base stands still
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

using JointPoints = std::array<Vector3, leg_count>;

/// Joints of legs 1…6 in B (z = 0): pairs at 60°, 180°, 300°; leg 1 at 60° − α, leg 2 at 60° + α,
/// ….
JointPoints base_joint_points(const JointCircle& circle);

/// Joints of legs 1…6 in P (z = 0): pairs at 0°, 120°, 240°; leg 1 at 0° + α, leg 2 at 120° − α, ….
JointPoints platform_joint_points(const JointCircle& circle);

}  // namespace hydrapod::model
