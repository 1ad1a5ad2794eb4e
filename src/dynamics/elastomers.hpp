#pragma once
/// Seals that are elastomers, in the linear models: docs/theory/elastomers.md.

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

/// Puts the arms of the seals into the legs' K as if their dampers were rigid, and keeps them in
/// model.arms, whose s_y follows with point_arms().
void fill_seal_arms(const model::Machine& machine, LinearModel& model);

/// Throws base::ComputationError where the legs stand in quick motions but fold while the seals
/// creep: K without the seals' arms is not positive definite, K with them is.
void require_slow_stiffness(const LinearModel& model);

}  // namespace hydrapod::dynamics
