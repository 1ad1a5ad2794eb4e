#pragma once
/// Modes from the modal form of an observation. Private to the module.

#include "hydrapod/observation/observation.hpp"

namespace hydrapod::observation {

/// Fills in the mode's pole, the platform's motion and the inputs from its column.
void describe_mode(const Observation& seen, ObservedMode& mode);

}  // namespace hydrapod::observation
