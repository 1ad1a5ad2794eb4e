#pragma once
/// The modal model of frequency responses, and its maximum-likelihood fit.
///
///     H(ω) = Σ_r [ φ_r L_rᵀ g(ω, λ_r) + conj. ] + Σ_k C_k s^k,   s = iω, k = −2 … K,
///
/// g = 1/(s − λ), or what averaging with a window makes of it under white excitation (the
/// transform of ρ(τ) e^(λτ), see lag_taper): so the widening of resonances by the window is
/// part of the model and not an error of the damping. C_k, real, stand for all modes below (−2, −1)
/// and above (0 … K; 1 unless said otherwise) the band.
///
/// Fit. Rows of H are independent given λ and L: minimised is Σ over lines and outputs of
///
///     ‖(Ĥ_o − H_o) W‖²/σ_o²,   W Wᴴ = Q⁻¹  (transposed as the row needs it),
///
/// σ_o² and Q being those of the responses' errors; by Gauss-Newton steps with Levenberg's damping
/// over λ and L, with φ and C eliminated exactly. Without known errors they are taken in proportion
/// to the response, see line_weights.hpp, and their size from the residual.
///
/// Errors. Estimates are θ̂ − θ = N⁻¹ Jᵀ e with N = Jᵀ J; the covariance is N⁻¹ Jᵀ cov(e) J N⁻¹ with
/// what the responses say of cov(e), between outputs and between neighbouring lines. Where nothing
/// is known, cov(e) is taken from the residual.
///
/// Sources: P. Guillaume, P. Verboven, S. Vanlanduit, ISMA 23 (1998) 359 (maximum likelihood); M.
/// El-Kafafy, P. Guillaume, B. Peeters, Mech. Syst. Signal Process. 37 (2013) 1 (modal model).

#include "hydrapod/identification/selection.hpp"

namespace hydrapod::identification {

struct FittedMode {
  std::complex<double> pole{};
  Eigen::VectorXcd shape{};          ///< φ
  Eigen::VectorXcd participation{};  ///< L, its largest element is 1
  /// Standard deviations, from the responses' errors.
  double omega_deviation{}, damping_deviation{};  ///< of ω [rad/s] and ζ
  Eigen::VectorXd shape_deviation{};              ///< of φ_o: √E|φ̂ − φ|²
  /// Σ over lines and entries of |contribution|²/variance, over the number of its parameters: what
  /// the mode is above the noise. Around 1 it is nothing.
  double significance{};
  [[nodiscard]] double omega() const { return std::abs(pole); }
  [[nodiscard]] double damping_ratio() const { return -pole.real() / std::abs(pole); }
};

inline constexpr int lowest_residual_power = -2;

struct ModalModel {
  std::vector<FittedMode> modes{};
  /// C_k for k = −2 … K, outputs × inputs, with s/ω_scale for s.
  std::vector<Eigen::MatrixXd> residuals{};
  double omega_scale{1.0};
  double cost{};   ///< the sum of squares that is minimised
  double error{};  ///< √(Σ|Ĥ − H|²/Σ|Ĥ|²) over lines and entries
  /// Mean of |residual|²/variance, less the parameters: about 1 when the model is right and the
  /// variances are; 0 where errors are not known.
  double misfit{};
  int iterations{};
  bool converged{};
};

/// What standard deviations are asked for; those of shapes take several times as long.
enum class Deviations { none, poles, all };

struct FitOptions {
  int max_iterations{30};
  double tolerance{1e-9};  ///< relative fall of the sum of squares at which it stops
  bool taper{true};        ///< model the window, where the responses tell it
  Deviations deviations{Deviations::all};
  int highest_residual_power{1};  ///< K
};

/// Starting from `start`. Throws std::invalid_argument without poles.
ModalModel fit_modes(const FrequencyResponses& responses, const std::vector<PoleEstimate>& start,
                     const FitOptions& options = {});

/// H of the model at s = shift + iω: without the window's effect.
Eigen::MatrixXcd synthesised(const ModalModel& model, double frequency, double shift = 0.0);

}  // namespace hydrapod::identification
