#pragma once
/// Who moves and what stores the energy in a mode.
///
/// Kinetic energy φᵀ M φ is split into the platform's six directions (about its mass centre, base
/// axes) and the six legs; these twelve shares sum to 1. A product of inertia between two rotations
/// is shared half and half, so a direction's share may be slightly negative.
///
/// Elastic energy is split into oil springs (gimbals in series with them included), guide sleeves
/// and piston rings, per leg, and the base's mount; these sum to 1. With a base that moves the
/// kinetic energy of the legs is that of their motion against it. What gravity and preload give back or take (second order: curvature, weights, knees under
/// compression) is no elastic energy; `preload` states it as a multiple of the elastic energy: −0.6
/// means that preload takes away 60 % of the stiffness that the springs give the mode, −1 that the
/// legs buckle.

#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::modal {

using spatial::Vector6;

struct EnergyShares {
  Vector6 platform{Vector6::Zero()};      ///< kinetic, x y z rx ry rz
  Vector6 legs{Vector6::Zero()};          ///< kinetic, legs 1…6
  Vector6 oil{Vector6::Zero()};           ///< elastic, legs 1…6
  Vector6 guide_sleeve{Vector6::Zero()};  ///< elastic, legs 1…6
  Vector6 piston_ring{Vector6::Zero()};   ///< elastic, legs 1…6
  double base_mount{};                    ///< elastic
  double preload{};                       ///< geometric / elastic, ≥ −1 when stable
};

/// Shares of every column of `shapes` (any normalisation).
std::vector<EnergyShares> energy_shares(const LinearModel& model,
                                        const Eigen::Ref<const ModelMatrix>& shapes);

/// Shares of a complex shape: its energies averaged over a period.
EnergyShares energy_shares(const LinearModel& model, const ModelVector& real,
                           const ModelVector& imaginary);

}  // namespace hydrapod::modal
