#pragma once
/// Seals of cylinders in motions that are not small.

#include "hydrapod/model/machine.hpp"

namespace hydrapod::simulation {

/// `legs.stick_stiffness` is of motions that are smaller than the presliding displacement. A
/// simulation with valves has the friction law of the seals in its place, and a controller is tuned
/// for seals that slide.
inline model::Machine with_sliding_seals(model::Machine machine) {
  for (auto& leg : machine.legs) leg.stick_stiffness = 0.0;
  return machine;
}

}  // namespace hydrapod::simulation
