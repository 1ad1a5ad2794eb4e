#pragma once
/// The numbers of a machine that the kernels read. Private to the module.

#include "hydrapod/dynamics/statics.hpp"
#include "lane_numbers.hpp"

namespace hydrapod::study {

/// Do the kernels know everything that the machine has? Not plain struts, a compliant base, modes
/// of the payload, elastomers, rods and cases that bend, seals that stick, guide rings that the rod
/// may touch, the inertia of oil lines, oil damped by chambers.
bool fits_lanes(const model::Machine& machine);

/// What all designs of a study have in common.
LaneOptions lane_options(const model::Machine& machine, double resonance_share);

/// `flexible`, `rigid`: where the searches for equilibrium begin; none: at straight legs.
MachineNumbers<double> lane_numbers(const model::Machine& machine, const spatial::Pose& X_BP,
                                    const dynamics::StaticEquilibrium* flexible,
                                    const dynamics::StaticEquilibrium* rigid);

}  // namespace hydrapod::study
