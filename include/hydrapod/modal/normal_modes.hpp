#pragma once
/// Undamped modes of a linear model: (K − ω² M) φ = 0                            (Eq. 17)
///
/// Modes ascend in ω², shapes are M-orthonormal (φᵀ M φ = 1, so φᵀ K φ = ω²), and:
/// - inside a group of repeated ω² the basis is canonical: the first vector takes all the group's
///   motion in x, the next all that is left in y, and so on through z, rx, ry, rz and the legs'
///   coordinates; output is therefore the same from run to run and machine to machine;
/// - signs are canonical: the largest component (each weighted with the root of its mass), of the
///   platform where the platform moves at all, is positive.
///
/// Method. On a base without coordinates legs touch each other only through the platform, so M is
/// factored in blocks, one small block per leg and one of the platform; a symmetric eigensolver of
/// fixed size follows. With coordinates of base or payload, M is factored whole. ω² are Rayleigh
/// quotients of the shapes. Errors: ω² within some epsilons of itself, next to frequencies 10⁵
/// times higher (seals made rigid by a huge stiffness) still within 1e-9; shapes within some
/// epsilons of the largest ω² over the distance to the next.
///
/// Who moves and what stores the energy in a mode.
///
/// Kinetic energy φᵀ M φ is split into the platform's six directions (about its mass centre, base
/// axes), the six legs, the six directions of a base with coordinates and the payload's modes;
/// these shares sum to 1. Of a payload's mode ½ (Lᵀq + ξ)² counts, its absolute motion, and the
/// platform's directions share what is left of its mass without it (LinearModel::platform_mass). A
/// product of inertia between two rotations is shared half and half, so a direction's share may be
/// slightly negative.
///
/// Elastic energy is split into oil springs (gimbals in series with them included), guide sleeves,
/// piston rings and the bending of rod and case, per leg, the base's mount and the payload's modes;
/// these sum to 1. What gravity and preload give back or take (second order: curvature, weights,
/// bent legs under compression) is no elastic energy; `preload` states it as a multiple of the
/// elastic energy: −0.6 means that preload takes away 60 % of the stiffness that the springs give
/// the mode, −1 that the legs buckle.

#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::modal {

using dynamics::LinearModel;
using dynamics::ModelMatrix;
using dynamics::ModelVector;
using dynamics::NormalModes;

/// Two ω² count as one when they differ by less than this share of the larger one, or by less than
/// the rounding error of the eigensolver (some epsilons of the largest ω²).
inline constexpr double repeated_tolerance = 1e-10;

/// Throws base::ComputationError when M is not positive definite (a machine without leg inertia).
NormalModes normal_modes(const LinearModel& model);

/// Rotates every group of repeated modes into its canonical basis and sets the signs; groups are
/// filled in. `mass_diagonal`: the diagonal of M.
void make_canonical(const ModelVector& mass_diagonal, NormalModes& modes);

using spatial::Vector6;

struct EnergyShares {
  Vector6 platform{Vector6::Zero()};  ///< kinetic, x y z rx ry rz
  Vector6 legs{Vector6::Zero()};      ///< kinetic, legs 1…6
  Vector6 base{Vector6::Zero()};      ///< kinetic, x y z rx ry rz of the base itself
  model::LegType leg_type{};          ///< what `oil` is of
  Vector6 oil{Vector6::Zero()};       ///< elastic, along the axes of legs 1…6; of struts theirs
  Vector6 guide_sleeve{Vector6::Zero()};  ///< elastic, legs 1…6
  Vector6 piston_ring{Vector6::Zero()};   ///< elastic, legs 1…6
  Vector6 bending{Vector6::Zero()};       ///< elastic, of rod and case, legs 1…6
  double base_mount{};                    ///< elastic
  double payload{};                       ///< kinetic, of the payload's modes
  double payload_elastic{};               ///< elastic, ω² ξ² of these
  double preload{};                       ///< geometric / elastic, ≥ −1 when stable
};

/// Shares of every column of `shapes` (any normalisation).
std::vector<EnergyShares> energy_shares(const LinearModel& model,
                                        const Eigen::Ref<const ModelMatrix>& shapes);

/// Shares of a complex shape: its energies averaged over a period.
EnergyShares energy_shares(const LinearModel& model, const ModelVector& real,
                           const ModelVector& imaginary);

/// A mode resonates in a direction when it holds this share of (M⁻¹)_dd, the sum of φ_d² over all
/// modes: five per cent is a peak that a frequency response shows beside the main one.
inline constexpr double resonance_share = 0.05;

/// Lowest mode with this share of (M⁻¹)_dd in direction d; −1: none.
int first_resonance(const NormalModes& modes, int d, double share = resonance_share);

/// The rigid mode ψ that holds most of a mode's momentum, rows of M φ for platform, base and
/// payload, and how much of ψ is in φ: (ψᵀ M_r φ)².
struct Counterpart {
  int mode{};
  double share{};
};
Counterpart counterpart(const ModelVector& momentum, const NormalModes& rigid);

/// What a pose comes down to in maps and sweeps [rad/s]; NaN where there is no such mode.
struct Resonances {
  double lowest{};  ///< of the modes with platform motion
  int direction{};  ///< in which it moves most, 0 … 5 for x … rz
  double drop{};    ///< 1 − ω/ω_r, ω_r being the rigid mode ψ that holds most of its momentum
  double share{};   ///< (ψᵀ M_r φ)² of that rigid mode: 1 where nothing else moves like it
  double peak{};  ///< share (ω_r/ω)²: height of its peak over that of ψ, at equal damping ratios
  Vector6 first{};   ///< per direction the first that resonates there
  Vector6 drops{};   ///< of those, against the first one with rigid legs
  Vector6 shares{};  ///< φ_d² over (M⁻¹)_dd: what part of the direction's motion is in them
  /// φ_d²/ω² over that of the first one with rigid legs: height of the peaks of the direct
  /// receptance at equal damping ratios.
  Vector6 peaks{};
};

/// `rigid`: modes of the rigid model at the same pose.
Resonances resonances(const LinearModel& flexible, const NormalModes& modes,
                      const NormalModes& rigid, double share = resonance_share);

}  // namespace hydrapod::modal
