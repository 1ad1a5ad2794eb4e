#pragma once
/// The load at which the legs fold: how much payload the machine carries at a pose.
///
/// A payload is mass added at the platform's mass centre. For a load growing from nothing the
/// static equilibrium at the pose is followed until one of two things happens, which is bracketed
/// and bisected:
/// - the lowest stiffness reaches zero (K singular: a seal mode at zero frequency);
/// - a limit point: beyond it no oil forces hold the platform at this pose with legs that are
///   merely bent. Legs that their own weight bends before they are loaded end here, shortly before
///   the mode is at zero, as an imperfect column does; straight ones (vertical, or without weight)
///   end in the first way.

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

struct BucklingOptions {
  double tolerance{1e-6};      ///< relative to the total mass on the legs
  double largest_factor{100};  ///< search up to this multiple of the platform's mass
};

enum class BucklingStatus {
  found,      ///< the legs buckle at `payload`
  not_found,  ///< no buckling up to the largest payload searched, or no gravity
  buckled     ///< the machine as it stands is unstable; `payload` is negative: what must come off
};

struct Buckling {
  BucklingStatus status{BucklingStatus::not_found};
  double payload{};          ///< [kg] on top of the platform's mass
  bool limit_point{};        ///< ended at a limit point, else with a mode at zero
  StaticEquilibrium last{};  ///< the equilibrium at (just below) that payload
};

Buckling buckling_payload(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                          const BucklingOptions& options = {});

}  // namespace hydrapod::dynamics
