#pragma once
/// What is observed of the plant or of the machine under control beside a point, to first order.
///
/// With A V = V Λ, W = V⁻¹ and a change dA of the state matrix, G = W dA V gives
///
///     dλ_k = G_kk,   dV = V X,   dW = −X W,   X_jk = G_jk / (λ_k − λ_j),   X_kk = 0
///
/// (perturbation theory of a simple eigenvalue; Wilkinson, The Algebraic Eigenvalue Problem, 1965,
/// chapter 2). Poles closer than 1e-5 |λ| count as one repeated pole. The basis of a repeated pole
/// is turned until its block of G is diagonal; X is zero within the block.
///
/// dA, dB and dC are central differences of the linear system. One decomposition serves all
/// parameters; differences of the poles need two for each.

#include "hydrapod/observation/observation.hpp"
#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::observation {

/// The linear system behind an observation.
struct ObservedSystem {
  spatial::Pose X_BP{};
  spatial::Vector3 p_BC{};
  spatial::Matrix6 platform_mass{};  ///< about the mass centre
  simulation::LinearSystem linear{};
  /// Motion of the mass centre per state, against the ground less against the base; the latter is
  /// the first six states.
  Eigen::MatrixXd carried{};
};

/// `observed`: plant or system. Throws as observe() does.
ObservedSystem observed_system(const model::Machine& machine, const spatial::Pose& X_BP,
                               dynamics::ModelKind kind, Observed observed,
                               const control::ControllerParameters* controller = nullptr);

class Tangent {
 public:
  /// `below`, `above`: the systems of two values of a parameter that are `width` apart; `center`
  /// observes the plant or the system of the value in the middle.
  Tangent(const Observation& center, const ObservedSystem& below, const ObservedSystem& above,
          double width);

  /// What is observed `step` beside the centre: the same modes in the same order, their shapes
  /// without the legs' coordinates.
  [[nodiscard]] Observation at(double step) const;
  /// Was the basis of a repeated pole turned? Its modes are then others than those of the centre.
  [[nodiscard]] bool turned() const { return turned_; }

 private:
  Observation center_{}, change_{};
  bool turned_{};
};

}  // namespace hydrapod::observation
