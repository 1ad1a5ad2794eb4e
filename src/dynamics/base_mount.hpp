#pragma once
/// A base that gives way. Its small motion q_b = (linear, angular) at the origin of B moves
/// everything that stands on it. The platform's six of y are its motion against the ground; legs
/// see q − T q_b, T bringing a motion of the base to the platform's mass centre. With p_i the
/// momentum of leg i in its motion against the base and M_i its inertia, both about the origin of B
/// (LegOnBase), K_m the mount's springs and M_b the base's own inertia,
///
///     V = V_still(q − T q_b, φ, u) + ½ q_bᵀ K_m q_b
///     T = ½ q̇ᵀ M_P q̇ + T_legs(q̇ − T q̇_b, …) + q̇_bᵀ Σ p_i + ½ q̇_bᵀ (M_b + Σ M_i) q̇_b
///
/// q_b are coordinates, in the directions that have a spring, the last of y: nothing is left out.
/// Only where neither base nor legs have inertia the base puts its springs in series with the
/// legs'. Its motion then is the one that the legs' springs force on it when the platform is held
/// displaced:
///
///     q_b = G q,   (I + F S) G = F Tᵀ K_rr,   S = Tᵀ K_rr T,   F = diag(1/k) of the mount
///
/// which is exact. What the weight does on a base that tilts, m g h against the mount's k_rx, is
/// left out.

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

using LegsOnBase = std::array<LegOnBase, model::leg_count>;

/// Replaces model.J by J (I − T G) and adds the mount's part to K. Called with J, the legs and the
/// platform's parts of K in place, before the legs are added. Neither base nor legs have inertia.
void condense_base(const model::BaseMount& mount, LinearModel& model);

/// The machine on a still base, complete but for Rayleigh's damping, gets model.base_directions as
/// coordinates. `M_legs`: the legs' part of its M.
void add_base_coordinates(const model::BaseMount& mount, const LegsOnBase& legs,
                          const ModelMatrix& M_legs, LinearModel& model);

}  // namespace hydrapod::dynamics
