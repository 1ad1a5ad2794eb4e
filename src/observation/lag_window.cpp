#include "hydrapod/observation/targets.hpp"

#include <Eigen/QR>
#include <cmath>

#include "hydrapod/base/units.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;
constexpr Complex two_pi_i{0.0, base::two_pi};

/// (e^z − 1)/z and (e^z (z − 1) + 1)/z² = ∫ e^{zx} dx and ∫ x e^{zx} dx over 0 … 1.
struct Moments {
  Complex zeroth, first;
};
Moments moments(Complex z, Complex exp_z) {
  constexpr double small = 0.05;
  if (std::abs(z) > small) return {(exp_z - 1.0) / z, (exp_z * (z - 1.0) + 1.0) / (z * z)};
  // Σ z^k/k! 1/(k + 1) and 1/(k + 2); what is left is below 1e-17
  Moments sum{1.0, 0.5};
  Complex term = 1.0;
  for (int k = 1; k < 10; ++k) {
    term *= z / static_cast<double>(k);
    sum.zeroth += term / static_cast<double>(k + 1);
    sum.first += term / static_cast<double>(k + 2);
  }
  return sum;
}

}  // namespace

Complex LagWindow::transform(Complex pole, Complex s) const {
  const Complex at = (pole - s) * duration, exp_z = std::exp(at);
  Complex sum = 0.0;
  for (int j = -most_periods; j <= most_periods; ++j) {
    const auto a = constant[j + most_periods], b = slope[j + most_periods];
    if (a == 0.0 && b == 0.0) continue;
    const auto [zeroth, first] = moments(at + two_pi_i * static_cast<double>(j), exp_z);
    sum += a * zeroth + b * first;
  }
  return duration * sum;
}

Complex LagWindow::of_pole(Complex pole, Complex s) const {
  const Complex at_once = derivative == 2 ? pole : 0.0;
  return (std::pow(pole, derivative) * transform(pole, s) + at_once) / std::pow(s, derivative);
}

std::optional<LagWindow> lag_window(const Eigen::VectorXd& rho, double sample_rate,
                                    int derivative) {
  constexpr int periods = LagWindow::most_periods, columns = 4 * periods + 2;
  constexpr double exact = 1e-6, negligible = 1e-9;
  const auto n = rho.size();
  if (n < 2 * columns || !(sample_rate > 0.0)) return std::nullopt;
  // 1, cos, sin of up to four periods, and the same times t/T
  Eigen::MatrixXd basis(n, columns);
  for (Eigen::Index t = 0; t < n; ++t) {
    const double x = static_cast<double>(t) / static_cast<double>(n);
    for (int j = 0; j <= periods; ++j) {
      const double angle = base::two_pi * j * x;
      basis(t, j) = std::cos(angle);
      if (j > 0) basis(t, periods + j) = std::sin(angle);
    }
    basis.row(t).tail(columns / 2) = x * basis.row(t).head(columns / 2);
  }
  const Eigen::VectorXd found = basis.colPivHouseholderQr().solve(rho);
  if ((basis * found - rho).cwiseAbs().maxCoeff() > exact) return std::nullopt;
  LagWindow window{.derivative = derivative, .duration = static_cast<double>(n) / sample_rate};
  const auto terms = [&](const Eigen::VectorXd& real) {
    LagWindow::Terms all = LagWindow::Terms::Zero();
    all[periods] = real[0];
    for (int j = 1; j <= periods; ++j) {
      const Complex half(0.5 * real[j], -0.5 * real[periods + j]);
      if (std::abs(half) < negligible) continue;
      all[periods + j] = half;
      all[periods - j] = std::conj(half);
    }
    return all;
  };
  window.constant = terms(found.head(columns / 2));
  window.slope = terms(found.tail(columns / 2));
  return window;
}

}  // namespace hydrapod::observation
