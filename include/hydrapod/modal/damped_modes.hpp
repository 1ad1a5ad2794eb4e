#pragma once
/// Damping of a model and its damped modes.
///
/// C = C_legs + α M + β K + M Φ diag(2 ζ ω) Φᵀ M: the legs' viscous dampers and Rayleigh damping
/// (both already in LinearModel::C) and a ratio ζ for every undamped mode. In the coordinates of
/// the undamped modes, y = Φ z, this reads z̈ + Γ ż + Ω² z = 0 with Γ = Φᵀ C Φ. Where Γ is diagonal
/// the modes are real; else they are complex, the eigenvectors of [0 I; −Ω² −Γ].
///
/// Damped modes come as pairs of poles λ = −ζω ± iω√(1 − ζ²): ω = |λ|, ζ = −Re λ/|λ|. An overdamped
/// mode has two real poles; the two whose shapes match best are reported as one mode with ζ > 1.

#include <complex>

#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::modal {

/// Used for every mode where a machine gives no damping of any kind; every output says so.
using model::default_modal_ratio;

/// The modal ratio ζ a model is given, and why.
struct ModalRatio {
  double value{};
  bool is_default{};  ///< nothing in the machine says anything about damping
};
ModalRatio modal_ratio(const model::Machine& machine);

struct DampedMode {
  std::complex<double> pole{};  ///< λ [1/s], the one with Im ≥ 0; for ζ > 1 the slower one
  double omega{};               ///< |λ| [rad/s], 0 when unstable without oscillation
  double damping_ratio{};       ///< ζ
  bool stable{true};
  ModelVector real{};       ///< shape; for real modes the whole of it, φᵀ M φ = 1
  ModelVector imaginary{};  ///< zero for real modes; together φᴴ M φ = 1
  int group{};              ///< same number for modes that repeat
  [[nodiscard]] bool is_complex() const { return !imaginary.isZero(0.0); }
};

/// Damped modes, ascending in ω. `ratio`: ζ given to every mode on top of the model's C.
std::vector<DampedMode> damped_modes(const LinearModel& model, const NormalModes& modes,
                                     double ratio);

/// Γ = Φᵀ C Φ + diag(2 ζ ω).
ModelMatrix modal_damping_matrix(const LinearModel& model, const NormalModes& modes, double ratio);

}  // namespace hydrapod::modal
