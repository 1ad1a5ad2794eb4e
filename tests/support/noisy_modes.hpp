#pragma once
/// Modes as identification gives them from a record of a machine: only those that the platform
/// feels, close ones as one, frequencies, dampings and shapes with noise.

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/observation/targets.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

/// Standard deviations.
struct ModeNoise {
  double frequency{1e-3};  ///< relative
  double damping{0.07};    ///< relative
  double shape{0.03};      ///< of a shape scaled to unit kinetic energy
};

/// Of the machine at its poses with these names; the motion of the platform frame's origin.
observation::Targets noisy_modes(const model::Machine& machine,
                                 const std::vector<std::string>& poses, dynamics::ModelKind kind,
                                 const ModeNoise& noise, Random& random);

/// The same of the plant: what a record identified from the drives of the valves on shows. Poles
/// with a damping ratio below 0.3; those nearer than half the smaller decay rate are one, in every
/// direction they move the platform in. Complex shapes with complex noise.
observation::Targets noisy_plant_modes(
    const model::Machine& machine, const std::vector<std::string>& poses, dynamics::ModelKind kind,
    const ModeNoise& noise, Random& random,
    observation::Observed observed = observation::Observed::plant);

}  // namespace hydrapod::test
