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
/// moments), or when a step did not halve it and it is ≤ 16 ε × leg length × stiffest seal [N].
///
/// Buckling of a leg as an elastic column between its joints.
///
/// The leg lies straight and pushes with P. Rod and case bend with E I_r and E I_c; the rod touches
/// the case at the piston, x = l_m, and at the guide sleeve, x = L_g, where both have the same
/// deflection but slopes of their own. Counted from the base joint:
///
///     case  0 … l_m    P     the oil carries the force; under pressure in a tube it bends the tube
///     case  l_m … L_g  0     as a force in the wall would (effective axial force)
///     rod   l_m … l    P
///
/// Both joints are pinned. Seals are taken as stiff: how they fold is dynamics::buckling_payload.
/// Weight across the axis and play of the guides are left out, so the strength is that of an ideal
/// column; makers of cylinders ask 3.5 times the load.
///
/// Each span is one element of stability functions, exact for uniform sections (Livesley, Matrix
/// Methods of Structural Analysis, 1975). The lowest P at which the stiffness of the joined spans
/// is no longer positive definite is Euler's load P_E. No span buckles between clamped ends before
/// that, so nothing is missed (Wittrick & Williams, Q. J. Mech. Appl. Math. 24 (1971) 263).
///
/// A stocky rod yields before. With σ_E = P_E/A above half the yield strength R_e, Johnson's
/// parabola holds: P = A R_e (1 − R_e / 4σ_E).

#include <array>
#include <optional>

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
  /// P per leg that makes bent rods softer [N]; absent: that of the equilibrium itself.
  std::optional<Vector6> rod_compression{};
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

struct ColumnStrength {
  double euler{};     ///< P_E [N]
  double strength{};  ///< what the leg bears as a column [N]: P_E, or less where the rod yields
  bool yields{};      ///< Johnson's parabola holds
};

/// Of a leg of this length [m] from joint to joint; nothing where the file does not say how thick
/// the rod is, and for a rod that is guided over less than a thousandth of the length. A case
/// without `diameter` and `wall` does not bend.
std::optional<ColumnStrength> column_strength(const model::Leg& leg, double length);

}  // namespace hydrapod::dynamics
