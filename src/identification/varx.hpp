#pragma once
/// A vector autoregression with exogenous inputs, and what it says of responses and poles. Private
/// to the module.
///
///     y_t = Σ_(k = 1 … n) A_k y_(t−k) + Σ_(k = 0 … n) B_k u_(t−k) + e_t,   cov e = Σ,
///
/// by least squares: the regressors of all orders and y are triangularised once (QR), and the
/// leading parts of R belong to the lower orders. n has the least corrected criterion of Akaike,
///
///     N ln det Σ̂ + N q (N + k)/(N − k − q − 1),
///
/// N rows, q outputs, k regressors. G = A⁻¹ B, A = I − Σ A_k z^(−k), has to first order the errors
///
///     δG = A⁻¹ δΘ w,   w = (I, z⁻¹ G, z⁻¹ I, z⁻² G, …),   cov δΘ = Σ ⊗ (R ᵀR)⁻¹.
///
/// Sources: L. Ljung, System Identification: Theory for the User, 2nd ed. (1999), ch. 7 and 10; C.
/// M. Hurvich, C.-L. Tsai, J. Time Ser. Anal. 14 (1993) 271 (criterion).

#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/responses.hpp"
#include "signals.hpp"

namespace hydrapod::identification {

struct VarxOptions {
  Index highest_order{40};
  Index most_coefficients{400};  ///< k ≤ this: the time goes with its square
  double most_share{0.3};        ///< … and ≤ most_share · N: more follow the noise
  /// Added to the mean squares of channels of variance 1: less than the noise of any sensor, and
  /// enough for signals that end within the band.
  double ridge{1e-10};
  bool direct{true};  ///< B_0; without it inputs act a sample later
  Index order{};      ///< 0: by the criterion
};

struct Varx {
  Index order{};
  double interval{};  ///< [s]
  /// Of channels of variance 1, in the order of the regressors: u_t, then y_(t−k), u_(t−k).
  MatrixXd theta{};       ///< k × q
  MatrixXd root{};        ///< R, k × k
  MatrixXd innovation{};  ///< Σ
  VectorXd input_size{}, output_size{};
  double rows{};  ///< N
  bool direct{true};
};

/// What is predicted from what. `inputs` may have no column.
struct Regression {
  MatrixXd inputs{}, outputs{};
};

/// Throws base::ComputationError where there are too few samples for order 1.
Varx fit_varx(const std::vector<Regression>& pieces, double sample_rate, Index touched,
              const VarxOptions& options = {});

/// Outputs from inputs.
Varx fit_varx(const Signals& signals, const VarxOptions& options = {});

/// Density of what the inputs do not explain of the outputs, A⁻¹ Σ A⁻ᴴ: variance per sample.
MatrixXcd noise_at(const Varx& model, double frequency);

/// Poles of all orders of realisations of its impulse response.
std::vector<OrderPoles> realised_poles(const Varx& model, const OrderRange& orders);

/// G with its errors at multiples of `spacing` [Hz] up to `to`. Channels are left empty.
FrequencyResponses responses_of(const Varx& model, double spacing, double to);

}  // namespace hydrapod::identification
