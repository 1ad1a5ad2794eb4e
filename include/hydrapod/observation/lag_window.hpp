#pragma once
/// What averaging over windowed blocks makes of a response.
///
/// Under white excitation an averaged response is, in the mean, the transform of the impulse
/// response times ρ(t), the autocorrelation of the window, 0 ≤ t ≤ T: resonances get wider. For the
/// windows in use, sums of cosines with at most four periods,
///
///     ρ(t) = Σ_j (a_j + b_j t/T) e^{2πi j t/T},   |j| ≤ 4
///
/// and a pole's 1/(s − λ) becomes, with z_j = (λ − s) T + 2πi j,
///
///     g(λ) = T Σ_j a_j (e^z − 1)/z + b_j (e^z (z − 1) + 1)/z²
///
/// Where speeds (d = 1) or accelerations (d = 2) were averaged, λ^d/(s − λ) does that, and what
/// acts at once, Σ λ over the poles, stays: divided by s^d the displacement shows
/// (λ^d g(λ) + (d = 2: λ))/s^d.

#include <Eigen/Core>
#include <complex>
#include <optional>

namespace hydrapod::observation {

struct LagWindow {
  static constexpr int most_periods = 4;
  using Terms = Eigen::Matrix<std::complex<double>, 2 * most_periods + 1, 1>;
  int derivative{};               ///< d
  double duration{};              ///< T [s]
  Terms constant{Terms::Zero()};  ///< a_j, j = −4 … 4
  Terms slope{Terms::Zero()};     ///< b_j

  /// g = ∫ ρ(t) e^{(λ − s) t} dt over 0 … T [s].
  [[nodiscard]] std::complex<double> transform(std::complex<double> pole,
                                               std::complex<double> s) const;
  /// What stands for 1/(s − λ) in a displacement.
  [[nodiscard]] std::complex<double> of_pole(std::complex<double> pole,
                                             std::complex<double> s) const;
};

/// From samples of ρ at `sample_rate` [Hz], from lag 0 on up to T; none where they are no such sum.
std::optional<LagWindow> lag_window(const Eigen::VectorXd& rho, double sample_rate,
                                    int derivative = 0);

}  // namespace hydrapod::observation
