#pragma once
/// Oil columns as two chambers per leg, with leakage and valve at rest: the linearisation of
/// simulation::Plant with the spools held (docs/theory/hydraulics.md, "Oil damping in the linear
/// models").

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

/// Puts the chambers' stiffness into the legs' K and the viscous friction of the seals along the
/// legs into C, and keeps what relaxes in model.arms, whose s_y follows with point_arms(). The
/// legs' own dampers c_h are not to be in C. Throws base::ComputationError where the supply does
/// not hold a leg, or its piston is outside its stroke.
void fill_chambers(const model::Machine& machine, LinearModel& model);

/// s_y of the arms, which until then is per coordinate of their leg, with J and the base's
/// coordinates in place.
void point_arms(LinearModel& model);

/// Dampers of the mount beside its springs, as those of simulations: 2 ζ √(k M_kk) + β k.
void damp_mount(const model::Machine& machine, LinearModel& model);

}  // namespace hydrapod::dynamics
