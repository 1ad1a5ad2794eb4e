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
/// Method. Legs touch each other only through the platform, so M is factored in blocks, one small
/// block per leg and a 6×6 one; a symmetric eigensolver of fixed size follows; ω² are Rayleigh
/// quotients of its shapes. Errors: ω² within some epsilons of itself, next to frequencies 10⁵
/// times higher (seals made rigid by a huge stiffness) still within 1e-9; shapes within some
/// epsilons of the largest ω² over the distance to the next.

#include <vector>

#include "hydrapod/dynamics/normal_modes.hpp"

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

}  // namespace hydrapod::modal
