#pragma once
/// The published mechanism with six equal legs whose axes keep its symmetry: repeated pairs, six
/// seal modes in one.

#include "support/published_machine.hpp"

namespace hydrapod::test {

/// Transverse axes, no damping of any kind; with equal piston rings.
inline model::Machine symmetric_machine(double gravity = 0.0) {
  auto machine = published_machine();
  machine.flexible_axes = model::FlexibleAxes::transverse;
  machine.gravity = {0.0, 0.0, -gravity};
  for (auto& leg : machine.legs) leg.piston_ring = model::PistonRing{.stiffness = 5e5};
  return machine;
}

}  // namespace hydrapod::test
