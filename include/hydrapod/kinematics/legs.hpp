#pragma once
/// Inverse kinematics and the leg Jacobian.
///
///     L = a − b,   a = p_BP + R_BP a_P,   l = |L|,   n = L / l
///     l̇ = nᵀ v_a,  v_a = v_Q + ω × (a − Q)                         (Eq. 12)
///
/// so the row of leg i in J_l_q is [nᵀ, ((a − Q) × n)ᵀ] for the platform twist (v_Q; ω) in base
/// axes about a reference point Q.
///
/// Forward kinematics: the pose that gives measured leg lengths.
///
/// Newton on r(X) = l(X) − l_given with the exact Jacobian, pose updates on the rotation manifold
/// and a step limit, so a start within the same assembly mode converges quadratically. A hexapod
/// has up to 40 assembly modes; the one nearest the start is found, which is what a controller
/// wants.
///
/// It stops as converged when max|r| ≤ tolerance. Valid range: the start's Jacobian must be
/// regular.
///
/// What a machine file is judged by: the numbers themselves, and every named pose.
///
/// How well a pose can be held and measured: conditioning, singular directions, joint angles.
///
/// The Jacobian mixes metres and radians, so it is made dimensionless with a length r (the root
/// mean square distance of the platform joints from the reference point): J D⁻¹ with D =
/// diag(1,1,1,r,r,r).

#include <array>

#include "hydrapod/model/machine.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::kinematics {

using spatial::Matrix6;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

/// One leg at a pose, in base axes.
struct LegGeometry {
  Vector3 a{};      ///< platform joint [m]
  Vector3 n{};      ///< unit vector from base joint to platform joint; NaN for a leg of no length
  double length{};  ///< l [m]
};

using LegGeometries = std::array<LegGeometry, model::leg_count>;

LegGeometries inverse_kinematics(const model::Machine& machine, const Pose& X_BP);

/// Leg lengths [m] only.
Vector6 leg_lengths(const model::Machine& machine, const Pose& X_BP);

/// J_l_q (6×6, row per leg): l̇ = J_l_q (v_Q; ω). `p_BQ`: the reference point Q in B [m].
Matrix6 leg_jacobian(const LegGeometries& legs, const Vector3& p_BQ);

/// The platform's mass centre C in B [m]: the reference point of all dynamics.
inline Vector3 mass_center(const model::Machine& machine, const Pose& X_BP) {
  return X_BP * machine.platform.mass_center;
}

struct ForwardOptions {
  double tolerance{1e-12};  ///< [m], on the largest residual: max|l(X) − l_given|
  int max_iterations{50};
  double max_translation{0.25};  ///< [m] largest step of one iteration
  double max_rotation{0.5};      ///< [rad] largest step of one iteration
};

enum class ForwardStatus { converged, singular, not_converged };

struct ForwardResult {
  Pose X_BP{};
  ForwardStatus status{ForwardStatus::not_converged};
  int iterations{};
  double residual{};  ///< max|l(X) − l_given| [m] at X_BP
};

/// The pose near `start` at which the legs have `lengths` [m]. Never throws; read `status`.
ForwardResult forward_kinematics(const model::Machine& machine, const Vector6& lengths,
                                 const Pose& start, const ForwardOptions& options = {});

struct PoseQuality {
  double characteristic_length{};  ///< r [m]
  Vector6 singular_values{};       ///< of J D⁻¹, descending, dimensionless
  double condition{};              ///< largest / smallest singular value; infinite when singular
  /// Platform motion (v; ω) the legs resist least, about the mean of the platform joints: |(v; r
  /// ω)| = 1 [m; rad], its largest component (as in that norm) positive.
  Vector6 weakest_direction{};
};

/// A pose counts as singular from this condition number on: leg lengths then determine the pose to
/// no better than a few digits. Well built hexapods stay below 100 in their workspace.
inline constexpr double singular_condition = 1e6;

PoseQuality pose_quality(const model::Machine& machine, const Pose& X_BP);

/// PoseQuality::condition alone, to 1e-11 of itself, in a third of the time.
double pose_condition(const model::Machine& machine, const Pose& X_BP);

/// Is the condition at least singular_condition? A bound, which takes a twentieth of the time,
/// tells it of most poses.
bool is_singular(const model::Machine& machine, const Pose& X_BP);

/// Angles of one leg's joints, all [rad].
struct JointAngles {
  double gimbal_1{};   ///< rotation about a1 from the neutral pose
  double gimbal_2{};   ///< rotation about a2 from the neutral pose
  double base_tilt{};  ///< angle between the leg and its direction at the neutral pose, seen in B
  double platform_tilt{};  ///< the same seen in P
};

/// Does a joint of any leg have a limit?
bool has_joint_limits(const model::Machine& machine);

std::array<JointAngles, model::leg_count> joint_angles(const model::Machine& machine,
                                                       const Pose& X_BP);

/// Least stroke left of any leg in either direction [m], negative beyond it; NaN for legs without a
/// stroke.
double stroke_left(const model::Machine& machine, const Pose& X_BP);

/// Findings about one pose: a leg shorter than its rod, a piston outside its stroke, a guide sleeve
/// beyond the rod, a joint beyond its limit, a singular pose. `key` is what the findings are filed
/// under, for instance `poses.neutral`.
std::vector<model::Finding> check_pose(const model::Machine& machine, const Pose& X_BP,
                                       const std::string& key);

/// model::validate, then check_pose for every named pose. This is the model::Check to read machine
/// files with.
std::vector<model::Finding> check_machine(const model::Machine& machine);

}  // namespace hydrapod::kinematics
