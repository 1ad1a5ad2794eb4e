#include "hydrapod/identification/responses.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <vector>

#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

struct Shape {
  std::string_view name;
  std::array<double, 5> a;  // of cosines
};

// Blackman-Harris: F. J. Harris, Proc. IEEE 66 (1978) 51. Flat top: G. D'Antona, A. Ferrero,
// Digital Signal Processing for Measurement Systems (2006), as in SciPy and MATLAB.
constexpr std::array<Shape, 7> shapes{
    {{"hann", {0.5, 0.5, 0.0, 0.0, 0.0}},
     {"rectangular", {1.0, 0.0, 0.0, 0.0, 0.0}},
     {"hamming", {0.54, 0.46, 0.0, 0.0, 0.0}},
     {"blackman-harris", {0.35875, 0.48829, 0.14128, 0.01168, 0.0}},
     {"flat-top", {0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368}},
     {"blackman", {0.42, 0.5, 0.08, 0.0, 0.0}},
     {"tukey", {}}}};

/// Flanks of a quarter of the length, as half as long a Hann window has them.
VectorXd tukey_samples(int length) {
  VectorXd w(length);
  for (int t = 0; t < length; ++t)
    w[t] = 0.5 -
           0.5 * std::cos(two_pi * std::min({2.0 * t, 0.5 * length, 2.0 * (length - t)}) / length);
  return w;
}

}  // namespace

std::string_view window_text(Window window) { return shapes[static_cast<size_t>(window)].name; }

std::optional<Window> window_from_text(std::string_view text) {
  for (size_t i = 0; i < shapes.size(); ++i)
    if (shapes[i].name == text) return static_cast<Window>(i);
  return {};
}

VectorXd window_samples(Window window, int length) {
  if (window == Window::tukey) return tukey_samples(length);
  const auto& a = shapes[static_cast<size_t>(window)].a;
  VectorXd w(length);
  for (int t = 0; t < length; ++t) {
    w[t] = a[0];
    for (int j = 1; j < 5; ++j)
      w[t] += (j % 2 == 0 ? a[j] : -a[j]) * std::cos(two_pi * j * t / length);
  }
  return w;
}

namespace {

/// dw/dt of a window that ends as it begins.
VectorXd slopes_of(const VectorXd& window) {
  const Index n = window.size();
  VectorXd slope(n);
  for (Index t = 0; t < n; ++t) slope[t] = 0.5 * (window[(t + 1) % n] - window[(t + n - 1) % n]);
  return slope;
}

}  // namespace

AverageStatistics average_statistics(const VectorXd& window, int hop, long blocks) {
  constexpr int most_lines = 12;
  constexpr double negligible = 1e-4;
  const auto n = static_cast<int>(window.size());
  const double power = window.squaredNorm(), count = static_cast<double>(blocks);
  const VectorXd slope = slopes_of(window);
  const double slope_power = slope.squaredNorm();
  AverageStatistics result;
  result.leakage_rate = slope_power / power;
  double own = 0.0;
  for (int d = 0; d < most_lines; ++d) {
    double sum = 0.0, let_in = 0.0, turned_in = 0.0;
    for (long m = 0; m < blocks && m * hop < n; ++m) {
      const auto shift = static_cast<int>(m * hop);
      Complex c = 0.0, of_slopes = 0.0, later = 0.0, earlier = 0.0;
      for (int t = 0; t + shift < n; ++t) {
        const Complex turned = std::polar(1.0, -two_pi * d * t / n);
        c += window[t] * window[t + shift] * turned;
        of_slopes += slope[t] * slope[t + shift] * turned;
        later += window[t] * slope[t + shift] * turned;
        earlier += slope[t] * window[t + shift] * turned;
      }
      const double both = m == 0 ? 1.0 : 2.0;  // m and −m
      const double share = both * (1.0 - static_cast<double>(m) / count);
      sum += share * std::norm(c / power);
      if (!(slope_power > 0.0)) continue;
      let_in += share * (of_slopes / slope_power * std::conj(c / power)).real();
      turned_in -= share * (later / slope_power * std::conj(earlier / power)).real();
    }
    if (d == 0) own = sum;
    if (sum < negligible * own) break;
    result.line_covariance.push_back(sum / own);
    result.leakage_covariance.push_back(let_in / own);
    result.leakage_relation.push_back(turned_in / own);
  }
  result.effective_averages = count / own;
  return result;
}

VectorXd lag_taper(const VectorXd& window, const VectorXd& power) {
  const auto n = static_cast<int>(window.size());
  const int length = static_cast<int>(std::bit_ceil(static_cast<unsigned>(2 * n)));
  numerics::RealFft fft(length);
  std::vector<double> samples(static_cast<size_t>(length), 0.0);
  const auto transform = [&](const VectorXd& x) {
    VectorXd::Map(samples.data(), n) = x;
    std::vector<std::complex<double>> lines(static_cast<size_t>(fft.lines()));
    fft.forward(samples, lines);
    return lines;
  };
  auto lines = transform(window);
  const auto excited = power.size() > 0 ? transform(window.cwiseProduct(power)) : lines;
  for (size_t k = 0; k < lines.size(); ++k) lines[k] *= std::conj(excited[k]);
  fft.inverse(lines, samples);
  return VectorXd::Map(samples.data(), n) / samples[0];
}

}  // namespace hydrapod::identification
