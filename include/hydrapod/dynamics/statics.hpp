#pragma once
/// Static equilibrium under gravity at a given pose.
///
/// The pose is where the machine stands when it is held by closed valves, so the platform's pose is
/// given and the six oil forces f and the flexible coordinates of the legs follow: with V_i(a_i,
/// φ_i, u_i) of bent_leg, ∂V_i/∂(φ_i, u_i) = 0 for every leg and Σ J_v,iᵀ λ_i = (m g; 0) for the
/// platform. Newton on all of it; each leg's own coordinates are eliminated first, which leaves a
/// 6×6 system for f.
///
/// Stops as converged when every residual is ≤ tolerance × (weight of the moving parts; × 1 m for
/// moments).

#include <array>

#include "hydrapod/dynamics/leg.hpp"

namespace hydrapod::dynamics {

/// Which flexible coordinates the legs have.
enum class ModelKind {
  rigid,  ///< none: 6 degrees of freedom
  guide,  ///< tilt of the rod in the guide sleeve: 18
  full    ///< and the piston's offset in its ring: 30
};

/// Flexible coordinates per leg: 0, 2 or 4.
constexpr int flexible_per_leg(ModelKind kind) {
  return kind == ModelKind::rigid ? 0 : kind == ModelKind::guide ? 2 : 4;
}
constexpr int degrees_of_freedom(ModelKind kind) {
  return 6 + model::leg_count * flexible_per_leg(kind);
}

struct StaticsOptions {
  double tolerance{1e-11};  ///< relative to the weight of platform and legs
  int max_iterations{60};
};

enum class StaticsStatus {
  converged,
  singular,
  folded,  ///< Newton ended where a leg is folded so far that its piston has left the guide sleeve
           ///< (l_mh ≤ 0), or that no extension closes it
  not_converged
};

struct StaticEquilibrium {
  StaticsStatus status{StaticsStatus::not_converged};
  int iterations{};
  double residual{};  ///< relative to the weight
  std::array<LegState, model::leg_count> legs{};
};

/// Equilibrium at `X_BP`. `start`: where to begin (a neighbouring equilibrium), else straight legs.
/// Never throws for a machine and pose that pass kinematics::check_machine; read `status`.
StaticEquilibrium static_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind, const StaticsOptions& options = {},
                                     const StaticEquilibrium* start = nullptr);

}  // namespace hydrapod::dynamics
