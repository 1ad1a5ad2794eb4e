#pragma once
/// What the run and the check before it share. Private to the module.

#include "hydrapod/rig/rig.hpp"

namespace hydrapod::rig {

/// ∂l/∂(x … rz) about the origin of P: leg lengths per displacement of the demanded pose.
spatial::Matrix6 excitation_jacobian(const model::Machine& machine, const spatial::Pose& pose);

/// Columns of J over their largest entries: drives per direction.
spatial::Matrix6 drive_shares(const spatial::Matrix6& J);

}  // namespace hydrapod::rig
