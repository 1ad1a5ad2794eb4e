#pragma once
/// Guide rings on which rods lie.

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::test {

/// Gaps through three times of which the rods sag at the neutral pose, and stiff rings.
inline void lay_on_guides(model::Machine& machine) {
  const auto model = dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
  for (int i = 0; i < model::leg_count; ++i) {
    auto& sleeve = machine.legs[i].guide_sleeve;
    sleeve.gap = model.legs[i].sleeve_offset.norm() / 3.0;
    sleeve.guide_stiffness = 20.0 * sleeve.stiffness;
  }
}

}  // namespace hydrapod::test
