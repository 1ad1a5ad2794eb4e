#pragma once
/// Legs without inertia.

#include "hydrapod/model/machine.hpp"

namespace hydrapod::test {

/// Massless legs: `times` 0 leaves base and legs without inertia.
inline void scale_legs_inertia(model::Machine& machine, double times) {
  for (auto& leg : machine.legs)
    for (double* inertia :
         {&leg.cylinder_case.mass, &leg.cylinder_case.transverse_inertia,
          &leg.cylinder_case.axial_inertia, &leg.rod.mass, &leg.rod.transverse_inertia,
          &leg.rod.axial_inertia, &leg.added_axial_inertia})
      *inertia *= times;
}

}  // namespace hydrapod::test
