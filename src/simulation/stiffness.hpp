#pragma once
/// What the fastest state of a plant costs an explicit integrator. Private to the module.

#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::simulation {

/// Throws base::ComputationError where steps are shorter than those of any machine and a run of
/// `until` seconds takes more of them than one waits for. Explicit methods
/// are stable up to steps of about 1/|λ|, λ being the fastest pole of the plant at rest. Oil and
/// platform alone have |λ| = √(k_h/m), which is proportional to the bore where strokes are equal.
void require_passable(const Plant& plant, const Plant::Rest& rest, const IntegratorOptions& options,
                      double until);

}  // namespace hydrapod::simulation
