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

/// `legs`: those of the equilibrium, where there is one and gravity.
StaticEquilibrium static_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind, const StaticsSearch& search,
                                     std::array<BentLeg, model::leg_count>& legs);

}  // namespace hydrapod::dynamics
