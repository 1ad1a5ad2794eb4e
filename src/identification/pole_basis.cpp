#include "pole_basis.hpp"

#include <algorithm>
#include <cmath>

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
  taper_ /= sample_rate_;
  if constexpr (numerics::side_by_side)
    if (taper_.size() % 2 == 0)
      fft_ = std::make_shared<numerics::RealFft>(static_cast<int>(taper_.size()));
}

PoleLines PoleBasis::at(Complex pole) const {
  PoleLines lines;
  const Index n = taper_.size();
  const Eigen::ArrayXcd s = omega_.array() * Complex(0.0, 1.0) + shift_;
  const double T = n == 0 ? 0.0 : static_cast<double>(n) / sample_rate_;
  const Complex end = n == 0 ? 0.0 : std::exp(pole * T);
  const Complex rest = 1.0 - end, rest_c = std::conj(rest), end_c = std::conj(end);
  const Eigen::ArrayXcd r = (s - pole).inverse(), r_c = (s - std::conj(pole)).inverse();
  lines.g = rest * r;
  lines.g_conjugate = rest_c * r_c;
  lines.slope = rest * r.square() - T * end * r;
  lines.slope_conjugate = rest_c * r_c.square() - T * end_c * r_c;
  if (n > 0) add_taper(pole, lines);
  return lines;
}

/// Transforms of the columns, an even number, times the taper, to half the sample rate.
MatrixXcd PoleBasis::tapered(const numerics::RealFft::Block& series) const {
  const Index n = series.rows(), half = n / 2 + 1, columns = series.cols();
  MatrixXcd X(half, columns);
  if constexpr (numerics::side_by_side)
    if (fft_ != nullptr) {
      std::vector<numerics::EightLines> lines(static_cast<size_t>(fft_->line_groups() * columns));
      fft_->forward(series, Eigen::RowVectorXd::Zero(columns), taper_, lines.data(), columns);
      for (Index k = 0; k < half; ++k)
        for (Index c = 0; c < columns; ++c) {
          const auto& eight = lines[static_cast<size_t>(k / 8 * columns + c)];
          const auto lane = static_cast<size_t>(k % 8);
          X(k, c) = {eight.re[lane], eight.im[lane]};
        }
      return X;
    }
  for (Index c = 0; c < columns; c += 2) {  // a + i b at once
    VectorXcd x(n);
    x.real() = taper_.cwiseProduct(series.col(c));
    x.imag() = taper_.cwiseProduct(series.col(c + 1));
    const auto both = numerics::complex_fft({x.begin(), x.end()});
    for (Index k = 0; k < half; ++k) {
      const Complex one = both[static_cast<size_t>(k)],
                    other = std::conj(both[static_cast<size_t>((n - k) % n)]);
      X(k, c) = 0.5 * (one + other);
      X(k, c + 1) = Complex(0.0, -0.5) * (one - other);
    }
  }
  return X;
}

/// e^(λτ) and τ e^(λτ) are transformed as four real series side by side; with A + i B at a line the
/// conjugate has A − i B.
void PoleBasis::add_taper(Complex pole, PoleLines& lines) const {
  const Index n = taper_.size();
  const double dt = 1.0 / sample_rate_, T = static_cast<double>(n) * dt;
  numerics::RealFft::Block series(n, 4);
  constexpr Index anew = 64;  // steps of a product, whose rounding adds up
  const Complex step = std::exp(pole * dt);
  Complex value = 1.0;
  for (Index t = 0; t < n; ++t, value *= step) {
    const double lag = static_cast<double>(t) * dt;
    if (t % anew == 0) value = std::exp(pole * lag);
    series.row(t) << value.real(), value.imag(), lag * value.real(), lag * value.imag();
  }
  const MatrixXcd X = tapered(series);
  // the last point of the trapezoidal rule, at lag T, where e^(−sT) = 1
  const Complex end = std::exp(pole * T), last = -0.5 * dt * end;
  for (Index k = 0; k < omega_.size(); ++k) {
    const Index at = line_[static_cast<size_t>(k)], half = std::min(at, n - at);
    const auto number = [&](Index c) { return at > half ? std::conj(X(half, c)) : X(half, c); };
    const Complex i(0.0, 1.0);
    lines.g[k] += number(0) + i * number(1) + last;
    lines.g_conjugate[k] += number(0) - i * number(1) + std::conj(last);
    lines.slope[k] += number(2) + i * number(3) + T * last;
    lines.slope_conjugate[k] += number(2) - i * number(3) + T * std::conj(last);
  }
}

}  // namespace hydrapod::identification
