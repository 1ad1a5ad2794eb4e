#pragma once
/// Machines whose elastomers soften under large amplitudes.

#include <string>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::test {

/// Elastomers for all guide sleeves but that of leg 3 and every other piston ring; those of leg 1
/// keep their stiffness. No two are alike.
inline model::Machine with_softening(model::Machine machine, double amplitude, double time) {
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const double d = static_cast<double>(i);
    auto& leg = machine.legs[i];
    if (i != 2)
      leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.27 + 0.13 * d,
                                    .loss_factor = 0.14,
                                    .frequency = 6.7 + d,
                                    .softening = i == 0 ? 0.0 : 0.23 + 0.07 * d,
                                    .softening_amplitude = amplitude * (1.0 + 0.31 * d),
                                    .softening_time = time * (1.0 - 0.11 * d)};
    if (leg.piston_ring && i % 2 == 1)
      leg.piston_ring->elastomer = {
          .arms = model::MaxwellArms{.strength = {0.31, 0.17, 0.53}, .time = {0.11, 0.013, 0.0021}},
          .softening = 0.57 - 0.04 * d,
          .softening_amplitude = 0.7 * amplitude,
          .softening_time = 1.3 * time};
  }
  return machine;
}

/// The same machine, small motions: nothing softens.
inline model::Machine without_softening(model::Machine machine) {
  for (auto& leg : machine.legs) {
    if (leg.guide_sleeve.elastomer) leg.guide_sleeve.elastomer->softening = 0.0;
    if (leg.piston_ring && leg.piston_ring->elastomer) leg.piston_ring->elastomer->softening = 0.0;
  }
  return machine;
}

}  // namespace hydrapod::test
