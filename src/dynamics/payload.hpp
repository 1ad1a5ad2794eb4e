#pragma once
/// Modes of the payload in the linear models; derivation: docs/theory/payload.md.
///
/// With q the absolute motion of the platform at its mass centre, L the participation of a mode
/// about it in base axes, l its first half, and ξ measured from where the mode stands under the
/// weight,
///
///     T = ½ q̇ᵀ M_P q̇ + ξ̇ Lᵀ q̇ + ½ ξ̇²        V = ½ ω² ξ² − ξ θᵀ (l × g)
///
/// θ: rotation of the platform against the base, as the machine's own weight has it. M_P contains
/// the mass that swings.

#include "hydrapod/base/units.hpp"
#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

/// [rad/s]
inline double omega_of(const model::PayloadMode& mode) { return base::two_pi * mode.frequency; }

/// Names, participation and ω² of the machine's modes into `model`; takes Σ L Lᵀ off
/// model.platform_mass. Called with X_BP and platform_mass in place, before dof() is used.
void set_payload(const model::Machine& machine, LinearModel& model);

/// The machine whose payload is rigid, complete but for Rayleigh's damping, gets ξ as coordinates
/// behind all others.
void add_payload(const model::Machine& machine, LinearModel& model);

}  // namespace hydrapod::dynamics
