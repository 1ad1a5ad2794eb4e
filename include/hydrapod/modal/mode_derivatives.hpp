#pragma once
/// How undamped modes move with a parameter p of the model: (K − ω² M) φ = 0, φᵀ M φ = 1.
///
/// With dM, dK the model's derivatives and λ = ω²,
///
///     dλ = φᵀ (dK − λ dM) φ
///     dφ = Σ_k φ_k [φ_kᵀ (dK − λ dM) φ] / (λ − λ_k) − ½ φ (φᵀ dM φ),   λ_k ≠ λ
///
/// exact, since all modes are known. A group of repeated λ has no derivative mode by mode: along a
/// direction in parameter space its λ split as the eigenvalues of the small symmetric matrix
/// G = Φᵀ (dK − λ dM) Φ of that direction. The basis Φ of a group is therefore turned once so that
/// it diagonalises the parameter that splits the group most; if nothing splits it, every basis is
/// right and the one of the modes stays.
///
/// Sources: Fox & Kapoor, AIAA J. 6 (1968) 2426; for repeated values Lancaster, Numer. Math. 6
/// (1964) 377.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "hydrapod/dynamics/normal_modes.hpp"

namespace hydrapod::modal {

using dynamics::LinearModel;
using dynamics::ModelMatrix;
using dynamics::ModelVector;
using dynamics::NormalModes;

/// Change of a model per change of a parameter.
struct ModelDerivative {
  ModelMatrix M{}, K{}, C{};
};

/// G of the group of `size` modes from `first` on [rad²/s² per unit of the parameter].
ModelMatrix group_derivative(const NormalModes& modes, int first, int size,
                             const ModelDerivative& derivative);

/// Turns the basis of every group of repeated modes to the one in which its modes part along the
/// parameter that splits it most, the lowest first. `scales`: how much of each parameter counts as
/// equally much.
void turn_repeated(NormalModes& modes, std::span<const ModelDerivative> derivatives,
                   const Eigen::VectorXd& scales);

/// dω²/dp: a row per mode, a column per parameter. In a group of repeated modes these are the
/// diagonals of G in the basis of the group (see turn_repeated).
Eigen::MatrixXd omega2_derivatives(const NormalModes& modes,
                                   std::span<const ModelDerivative> derivatives);

/// Modes whose ω² differs from that of mode k by no more than the share `together` of it; those of
/// its group always.
std::vector<int> neighbours(const NormalModes& modes, int k, double together = 0.0);

/// dφ/dp of mode k, a column per parameter; what turns its neighbours and it into each other is
/// left out.
Eigen::MatrixXd shape_derivatives(const NormalModes& modes, int k,
                                  std::span<const ModelDerivative> derivatives,
                                  double together = 0.0);

}  // namespace hydrapod::modal
