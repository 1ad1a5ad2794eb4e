#pragma once
/// Power spectral densities by Welch's method, from samples that stream past.
///
/// Segments of n samples overlap by half; of each its mean is taken off and a periodic Hann window
/// laid over it. One-sided density S(f_k), f_k = k f_s/n, k = 0 … n/2:
///
///     S(f_k) = c_k / (f_s Σ w²) · mean over segments of |Σ_j w_j x_j e^(−2πi jk/n)|²,
///
/// c = 1 at f = 0 and at f_s/2, else 2, so that Σ S Δf is the variance. With m segments the
/// standard error of S is about S·√(1.1/m) for noise (overlap counted in). Missing samples (NaN)
/// are replaced by the last good one. Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15
/// (1967) 70.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

struct Spectrum {
  Eigen::VectorXd frequency{};  ///< [Hz]
  Eigen::MatrixXd density{};    ///< line × channel [unit²/Hz]
  std::int64_t segments{};      ///< averaged
};

class WelchSpectrum {
 public:
  /// `segment`: samples per segment, even, at least 8. Throws std::invalid_argument.
  WelchSpectrum(std::size_t channels, double sample_rate, std::size_t segment);
  ~WelchSpectrum();
  WelchSpectrum(WelchSpectrum&&) noexcept;
  WelchSpectrum& operator=(WelchSpectrum&&) noexcept;

  void add(const Eigen::Ref<const Samples>& samples);
  /// Of what has come so far; zero segments where that is less than one.
  [[nodiscard]] Spectrum result() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hydrapod::data
