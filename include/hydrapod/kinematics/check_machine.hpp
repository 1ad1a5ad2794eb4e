#pragma once
/// What a machine file is judged by: the numbers themselves, and every named pose.
///
/// How well a pose can be held and measured: conditioning, singular directions, joint angles.
///
/// The Jacobian mixes metres and radians, so it is made dimensionless with a length r (the root
/// mean square distance of the platform joints from the reference point): J D⁻¹ with D =
/// diag(1,1,1,r,r,r).

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/validation.hpp"

namespace hydrapod::kinematics {

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

/// Angles of one leg's joints, all [rad].
struct JointAngles {
  double gimbal_1{};   ///< rotation about a1 from the neutral pose
  double gimbal_2{};   ///< rotation about a2 from the neutral pose
  double base_tilt{};  ///< angle between the leg and its direction at the neutral pose, seen in B
  double platform_tilt{};  ///< the same seen in P
};

std::array<JointAngles, model::leg_count> joint_angles(const model::Machine& machine,
                                                       const Pose& X_BP);

/// Findings about one pose: a leg shorter than its rod, a piston outside its stroke, a guide sleeve
/// beyond the rod, a joint beyond its limit, a singular pose. `key` is what the findings are filed
/// under, for instance `poses.neutral`.
std::vector<model::Finding> check_pose(const model::Machine& machine, const Pose& X_BP,
                                       const std::string& key);

/// model::validate, then check_pose for every named pose. This is the model::Check to read machine
/// files with.
std::vector<model::Finding> check_machine(const model::Machine& machine);

}  // namespace hydrapod::kinematics
