#pragma once
/// Windows of spectral estimates, and what they do to statistics and to responses.

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

namespace hydrapod::identification {

enum class Window { hann, rectangular, hamming, blackman_harris, flat_top };

/// "hann", "rectangular", "hamming", "blackman-harris", "flat-top".
std::string_view window_text(Window window);
std::optional<Window> window_from_text(std::string_view text);

/// w_t, t = 0 … n − 1, periodic: w_t = Σ_j (−1)^j a_j cos(2π j t/n).
Eigen::VectorXd window_samples(Window window, int length);

/// Statistics of averages over K blocks of length n whose starts are D samples apart, for noise
/// whose spectrum is flat over a few lines. With
///
///     c(m, d) = Σ_t w_t w_{t + mD} e^(−2πi d t/n) / Σ_t w_t²
///
/// the covariance of a cross spectrum between the lines k and k + d is proportional to
///
///     a_d = 1/K Σ_m (1 − |m|/K) |c(m, d)|²,   |m| < K.
struct AverageStatistics {
  double effective_averages{};          ///< 1/a_0: as many independent blocks would be as good
  std::vector<double> line_covariance;  ///< a_d/a_0, d = 0, 1, … while it is above 1e-4
};
AverageStatistics average_statistics(const Eigen::VectorXd& window, int hop, long blocks);

/// ρ_τ = Σ_t w_t w_{t+τ} / Σ_t w_t², τ = 0 … n − 1. Under white excitation an averaged cross
/// spectrum is, in the mean, the transform of the impulse response times ρ: a window makes
/// resonances wider, by an amount that is known.
Eigen::VectorXd lag_taper(const Eigen::VectorXd& window);

}  // namespace hydrapod::identification
