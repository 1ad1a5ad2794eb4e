#pragma once
/// A base that gives way: its motion follows the platform's.
///
/// The base's small motion q_b = (linear, angular) at the origin of B moves everything that stands
/// on it; the coordinates y stay what they were, q the platform's motion against the ground. Legs
/// see q − T q_b, T bringing a motion of the base to the platform's mass centre. Of all motions of
/// the base the one is kept that the legs' springs force on it when the platform is held displaced:
///
///     q_b = G q,   (I + F S) G = F Tᵀ K_rr,   S = Tᵀ K_rr T,   F = diag(1/k) of the mount
///
/// (Guyan's reduction with the flexible coordinates left as they are, so that legs still meet only
/// in the platform). Energies are exact for this motion:
///
///     V = V_legs(q − T G q, φ, u) + ½ qᵀ Gᵀ K_m G q
///     T = ½ q̇ᵀ M_P q̇ + T_legs(q̇ − T G q̇, …) + (G q̇)ᵀ Σ p_i + ½ (G q̇)ᵀ (M_b + Σ M_i) G q̇
///
/// with p_i the momentum of leg i in its motion against the base and M_i its inertia, straight,
/// both about the origin of B. Frequencies are upper bounds, exact where the legs' and the base's
/// inertia is small beside the platform's; the base's own resonance on its mount is not among them.
/// What the weight does on a base that tilts, m g h against the mount's k_rx, is left out.

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

/// Replaces model.J by J (I − T G) and adds the mount's parts to M and K. Called with J, the legs
/// and the platform's parts of K in place, before the legs are added.
void add_base_mount(const model::Machine& machine, LinearModel& model);

}  // namespace hydrapod::dynamics
