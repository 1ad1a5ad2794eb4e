#pragma once
/// The search behind static_equilibrium() with what it finds on the way. Private to the module.

#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::dynamics {

struct StaticsSearch {
  StaticsOptions options{};
  /// As StaticsOptions::tolerance, after at least one step.
  double tolerance_after_step{options.tolerance};
  const StaticEquilibrium* start{};  ///< none: straight legs
};

/// bent_leg() whose M leaves out the mass of the bow. Newton's steps need no M, and this mass costs
/// more than all else of a leg.
BentLeg bent_leg_without_bow_mass(const model::Leg& leg, const Vector3& a, model::FlexibleAxes axes,
                                  const Vector3& gravity, const LegState& state);

/// `legs`: those of the equilibrium, where there is one and gravity.
StaticEquilibrium static_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind, const StaticsSearch& search,
                                     std::array<BentLeg, model::leg_count>& legs);

}  // namespace hydrapod::dynamics
