#pragma once
/// Private to the module.

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::simulation {

/// Displacement of P's origin from that of C, both with the rotation: 6 × 6.
inline spatial::Matrix6 origin_from_center(const model::Machine& machine,
                                           const spatial::Pose& X_BP) {
  spatial::Matrix6 T = spatial::Matrix6::Identity();
  const spatial::Vector3 arm = X_BP.p_BP - kinematics::mass_center(machine, X_BP);
  T.topRightCorner<3, 3>() = -spatial::skew(arm);
  return T;
}

}  // namespace hydrapod::simulation
