#pragma once
/// Springs and dampers that stand for what is not linear, at given amplitudes (harmonic balance).
///
/// An element whose force f(x, ẋ) meets the motion x = x̄ + A cos ωt gives back a force of which the
/// part at ω is k A cos ωt − c ω A sin ωt:
///
///     k = 1/(πA) ∮ f cos θ dθ          c = −1/(πAω) ∮ f sin θ dθ
///
/// Parts at multiples of ω are left out: they meet masses that hardly follow them. Derivation,
/// limits: docs/theory/amplitude.md.

#include <Eigen/Core>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::dynamics {

/// The guide ring under a rod that swings.
struct GuideEquivalent {
  /// Beside k_s: S = 1/π ∮ (∂f/∂d) sin² θ dθ, symmetric, S a = the part of the force at ω.
  Eigen::Matrix2d stiffness{Eigen::Matrix2d::Zero()};
  Vector2 mean{Vector2::Zero()};  ///< d̄ about which it swings [m]
  bool touches{};                 ///< somewhere in the period
};

/// `rest`: static offset, `amplitude`: a, both along t and a2 [m]. d̄ is where the mean force of seal
/// and guide ring is that at rest.
GuideEquivalent guide_equivalent(const model::GuideSleeve& sleeve, const Vector2& rest,
                                 const Vector2& amplitude);

/// What amplitudes leave of an elastomer's stiffness (Payne effect, after Kraus):
/// 1 − softening r/(1 + r), r = (A / softening_amplitude)^1.2.
double softened(const model::Elastomer& elastomer, double amplitude);

/// A seal k with arms, in series with what bends: springs and arms once more, since k(p) / (1 + f
/// k(p)) falls from one real pole to the next. Returned are those arms that act on δ = d/(1 + f k)
/// of the slow motion: beside k/(1 + f k) of d they give the exact stiffness. `k` of slow motions
/// [N/m], `f` [m/N].
SealArms arms_in_series(const SealArms& arms, double k, double f);

/// Of something that follows the coordinates of leg `leg` with `per_x`: its rate per y.
ModelVector per_coordinate(const LinearModel& model, int leg, const Vector7& per_x);

struct Equivalent {
  double stiffness{};  ///< [N/m]
  double damping{};    ///< [N s/m]
};

/// Friction of a cylinder's seals along the leg at the amplitude A [m] > 0 and ω [rad/s]: bristles,
/// which are a spring while they stick, or the smooth law. Its viscous part is left out.
Equivalent friction_equivalent(hydraulics::Friction friction, double amplitude, double omega);

}  // namespace hydrapod::dynamics
