#pragma once
/// The same machine described in other words.

#include "hydrapod/model/machine.hpp"

namespace hydrapod::test {

/// Everything that stands in the world turned by `R` about the base origin, poses and gravity too.
inline model::Machine turned(model::Machine machine, const spatial::Matrix3& R) {
  machine.gravity = R * machine.gravity;
  for (auto& leg : machine.legs) {
    leg.base_joint = R * leg.base_joint;
    leg.gimbal_axis = R * leg.gimbal_axis;
  }
  for (auto& pose : machine.poses) pose.X_BP = {R * pose.X_BP.R_BP, R * pose.X_BP.p_BP};
  return machine;
}

/// The platform frame's origin moved to `p_PQ` and its axes turned to `R_PQ`, with the same body in
/// the same places.
inline model::Machine with_other_platform_frame(model::Machine machine,
                                                const spatial::Vector3& p_PQ,
                                                const spatial::Matrix3& R_PQ) {
  auto& platform = machine.platform;
  platform.mass_center = R_PQ.transpose() * (platform.mass_center - p_PQ);
  platform.inertia = R_PQ.transpose() * platform.inertia * R_PQ;
  for (auto& leg : machine.legs)
    leg.platform_joint = R_PQ.transpose() * (leg.platform_joint - p_PQ);
  for (auto& pose : machine.poses) pose.X_BP = {pose.X_BP.R_BP * R_PQ, pose.X_BP * p_PQ};
  return machine;
}

}  // namespace hydrapod::test
