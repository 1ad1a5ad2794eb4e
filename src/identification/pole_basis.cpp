#include "pole_basis.hpp"

#include <cmath>

#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"

namespace hydrapod::identification {

PoleBasis::PoleBasis(const FrequencyResponses& responses, bool taper)
    : omega_(two_pi *
             VectorXd::Map(responses.frequency.data(), static_cast<Index>(responses.lines()))),
      shift_(responses.shift),
      sample_rate_(responses.sample_rate) {
  if (!taper || responses.taper.size() == 0) return;
  taper_ = responses.taper.array() - 1.0;
  const double step = sample_rate_ / static_cast<double>(taper_.size());
  for (const double f : responses.frequency) {
    const auto line = static_cast<Index>(std::llround(f / step));
    if (std::abs(f - static_cast<double>(line) * step) > 1e-6 * step) {  // another grid
      taper_.resize(0);
      return;
    }
    line_.push_back(line % taper_.size());  // the transform repeats
  }
}

PoleLines PoleBasis::at(Complex pole) const {
  PoleLines lines;
  const Index count = omega_.size(), n = taper_.size();
  const Eigen::ArrayXcd s = omega_.array() * Complex(0.0, 1.0) + shift_;
  const double T = n == 0 ? 0.0 : static_cast<double>(n) / sample_rate_;
  const Complex end = n == 0 ? 0.0 : std::exp(pole * T);
  const Complex rest = 1.0 - end, rest_c = std::conj(rest), end_c = std::conj(end);
  const Eigen::ArrayXcd r = (s - pole).inverse(), r_c = (s - std::conj(pole)).inverse();
  lines.g = rest * r;
  lines.g_conjugate = rest_c * r_c;
  lines.slope = rest * r.square() - T * end * r;
  lines.slope_conjugate = rest_c * r_c.square() - T * end_c * r_c;
  if (n == 0) return lines;
  const double dt = 1.0 / sample_rate_;
  std::vector<Complex> value(static_cast<size_t>(n)), slope(value.size());
  for (Index t = 0; t < n; ++t) {
    const double lag = static_cast<double>(t) * dt;
    const Complex v = dt * taper_[t] * std::exp(pole * lag);
    value[static_cast<size_t>(t)] = v;
    slope[static_cast<size_t>(t)] = lag * v;
  }
  // the last point of the trapezoidal rule, at lag T, where e^(−sT) = 1
  value[0] -= 0.5 * dt * end;
  slope[0] -= 0.5 * dt * T * end;
  const auto value_lines = numerics::complex_fft(value), slope_lines = numerics::complex_fft(slope);
  for (Index k = 0; k < count; ++k) {
    const auto at = static_cast<size_t>(line_[static_cast<size_t>(k)]);
    const auto mirrored = (static_cast<size_t>(n) - at) % static_cast<size_t>(n);
    lines.g[k] += value_lines[at];
    lines.slope[k] += slope_lines[at];
    lines.g_conjugate[k] += std::conj(value_lines[mirrored]);
    lines.slope_conjugate[k] += std::conj(slope_lines[mirrored]);
  }
  return lines;
}

}  // namespace hydrapod::identification
