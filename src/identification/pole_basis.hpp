#pragma once
/// What a pole contributes at each line. Private to the module.

#include <memory>
#include <vector>

#include "hydrapod/identification/responses.hpp"
#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::identification {

/// g(ω_k, λ), g(ω_k, λ*) and their derivatives to λ and λ*.
struct PoleLines {
  Eigen::VectorXcd g, g_conjugate, slope, slope_conjugate;
};

/// Without taper g = 1/(s − λ), s = a + iω with the responses' shift a. With `taper` of length n (T
/// = n/f_s) all frequencies must be multiples of f_s/n, and
///
///     g = (1 − e^(λT))/(s − λ) + ∫_0^T (ρ(τ) − 1) e^((λ − s) τ) dτ,
///
/// the integral by the trapezoidal rule, whose aliases fall with the third power of the frequency.
/// One per thread: it has the work space of a transform.
class PoleBasis {
 public:
  PoleBasis(const FrequencyResponses& responses, bool taper);
  [[nodiscard]] PoleLines at(std::complex<double> pole) const;

 private:
  [[nodiscard]] Eigen::MatrixXcd tapered(const numerics::RealFft::Block& series) const;
  void add_taper(std::complex<double> pole, PoleLines& lines) const;

  Eigen::VectorXd omega_;
  Eigen::VectorXd taper_;  // (ρ − 1)/f_s; empty: no window
  double shift_, sample_rate_{};
  std::vector<Eigen::Index> line_;
  std::shared_ptr<numerics::RealFft> fft_{};  // none: odd length, or in a page
};

}  // namespace hydrapod::identification
