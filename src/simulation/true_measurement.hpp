#pragma once
/// What sensors without faults show at a state of the plant.

#include "hydrapod/control/controller.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

/// Accelerations only where the controller feeds them back.
control::Measurement true_measurement(const Plant& plant, const double* x, const PlantInput& input,
                                      model::DampingFeedback feedback);

}  // namespace hydrapod::simulation
