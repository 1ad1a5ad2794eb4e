#pragma once
/// The dampers of seals that a machine file gives only as modal or Rayleigh damping. Private to
/// Plant.

#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::simulation {

/// The machine with dampers at guide sleeves and piston rings that stand for `[damping]`; see
/// plant.hpp.
model::Machine with_seal_dampers(model::Machine machine, dynamics::ModelKind kind,
                                 const spatial::Pose& X_reference);

}  // namespace hydrapod::simulation
