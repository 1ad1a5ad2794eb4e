#pragma once
/// Errors of what is computed from half spectra. Private to the module.
///
/// To first order an estimate's error is linear in those of the half spectra,
///
///     δθ = Re Σ c_oi(ω)* δS⁺_oi(ω),
///
/// and so in those of the covariances, and so, with B the transform of their factors, the mean over
/// all ω of tr(B δS). The sample spectrum of N Gaussian samples has
///
///     var δθ = 2/N · mean over ω of tr(B S B S),   B = Bᴴ.
///
/// S is the spectrum averaged over K blocks; tr(B Ŝ B Ŝ) is expected to be tr(B S B S) + (tr B
/// S)²/K, of which this is corrected. Neither the errors' dependence between lines nor that between
/// entries is neglected.
///
/// The window widens Ŝ, and so takes from its square what it does not take from its sum: within a
/// resonance of decay σ the square is multiplied by Σ e^(−2στ)/Σ ρ_τ² e^(−2στ).
///
/// Sources: E. Reynders, R. Pintelon, G. De Roeck, Mech. Syst. Signal Process. 22 (2008) 948;
/// M. Döhler, L. Mevel, Mech. Syst. Signal Process. 37 (2013) 74 (first-order propagation);
/// P. J. Brockwell, R. A. Davis, Time Series: Theory and Methods, 2nd ed. (1991), ch. 7 and 10.

#include "hydrapod/identification/responses.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"

namespace hydrapod::identification {

class OutputErrors {
 public:
  /// `half` must have `whole`, and outlive this. `poles`: of the resonances.
  OutputErrors(const FrequencyResponses& half, const VectorXcd& poles);
  /// var δθ; c: lines of `half` × entries, column o p + i.
  [[nodiscard]] double variance(const MatrixXcd& c) const;

 private:
  [[nodiscard]] MatrixXcd factors_of_spectra(const MatrixXcd& c) const;

  const FrequencyResponses& half_;
  std::vector<std::size_t> line_;      // of `half`, on the grid of L lags
  VectorXd narrowing_;                 // per line, of the square of S
  VectorXd level_;                     // tr S per line
  std::vector<MatrixXcd> references_;  // S between references
};

}  // namespace hydrapod::identification
