#include "output_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace hydrapod::identification {

namespace {

/// Per line of the spectra what their square is to be multiplied by.
VectorXd narrowing_of(const FrequencyResponses& half, const VectorXcd& poles) {
  const Index L = half.taper.size();
  const double interval = 1.0 / half.sample_rate,
               spacing = 0.5 * half.sample_rate / static_cast<double>(L);
  VectorXd rho(L * 9 / 10);  // beyond, both numbers are nearly 0
  for (Index k = 0; k < rho.size(); ++k) {
    const double lag =
        std::cos(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(L));
    rho[k] = half.taper[k] / (lag * lag);
  }
  VectorXd factor = VectorXd::Ones(static_cast<Index>(half.whole->S.size()));
  VectorXd nearest = VectorXd::Constant(factor.size(), 1.0);
  for (const Complex pole : poles) {
    double plain = 0.0, widened = 0.0;
    for (Index k = 0; k < L; ++k) {
      const double left =
          (k == 0 ? 0.5 : 1.0) * std::exp(2.0 * pole.real() * static_cast<double>(k) * interval);
      plain += left;
      if (k < rho.size()) widened += left * rho[k] * rho[k];
    }
    constexpr double widths = 4.0, of_window = 0.7;  // half widths; [lines] that a window adds
    const double width = widths * (-pole.real() / two_pi + of_window * spacing);
    for (Index k = 0; k < factor.size(); ++k) {
      const double apart =
          std::abs(static_cast<double>(k) * spacing - pole.imag() / two_pi) / width;
      if (apart >= nearest[k]) continue;
      nearest[k] = apart;
      factor[k] = plain / widened;
    }
  }
  return factor;
}

}  // namespace

OutputErrors::OutputErrors(const FrequencyResponses& half, const VectorXcd& poles)
    : half_(half), narrowing_(narrowing_of(half, poles)) {
  const double step = half.sample_rate / static_cast<double>(half.taper.size());
  for (const double f : half.frequency)
    line_.push_back(static_cast<std::size_t>(std::llround(f / step)));
  const auto& whole = *half.whole;
  level_.resize(static_cast<Index>(whole.S.size()));
  for (std::size_t k = 0; k < whole.S.size(); ++k) {
    level_[static_cast<Index>(k)] = whole.S[k].trace().real();
    references_.emplace_back(whole.S[k](whole.references, whole.references));
  }
}

/// B: references × outputs at every line, entry i q + o.
MatrixXcd OutputErrors::factors_of_spectra(const MatrixXcd& c) const {
  const Index L = half_.taper.size(), q = half_.H[0].rows(), p = half_.H[0].cols();
  const auto length = static_cast<std::size_t>(L);
  numerics::RealFft back(static_cast<int>(L)), forward(2 * static_cast<int>(L));
  std::vector<Complex> on_grid(static_cast<std::size_t>(back.lines())),
      lines(static_cast<std::size_t>(forward.lines()));
  std::vector<double> factors(2 * length, 0.0);
  // Re Σ c_k* e^(−iω_k τ) T ε τ_k: half of an inverse transform without its 1/L
  const VectorXd weights = half_.taper * (0.5 * static_cast<double>(L) / half_.sample_rate);
  MatrixXcd B(static_cast<Index>(lines.size()), p * q);
  for (Index o = 0; o < q; ++o)
    for (Index i = 0; i < p; ++i) {
      for (std::size_t k = 0; k < line_.size(); ++k)
        on_grid[line_[k]] = c(static_cast<Index>(k), o * p + i);
      back.inverse(on_grid, std::span(factors).first(length));
      VectorXd::Map(factors.data(), L).array() *= weights.array();
      factors[0] *= 0.5;
      forward.forward(factors, lines);
      B.col(i * q + o) = VectorXcd::Map(lines.data(), B.rows()).conjugate();
    }
  return B;
}

double OutputErrors::variance(const MatrixXcd& c) const {
  const auto& whole = *half_.whole;
  const MatrixXcd B = factors_of_spectra(c);
  const Index q = half_.H[0].rows(), p = half_.H[0].cols();
  const VectorXd size = B.rowwise().norm().cwiseProduct(level_);
  // so little that all lines together would not change the deviation by 1 %
  const double least = 1e-3 * size.maxCoeff();
  const double K = whole.averages;
  double sum = 0.0;
  MatrixXcd b(p, q), bS(p, q), square(p, p), across(p, p);
  for (Index k = 1; k + 1 < B.rows(); ++k) {
    if (size[k] < least) continue;
    const auto& S = whole.S[static_cast<std::size_t>(k)];
    const auto& S_rr = references_[static_cast<std::size_t>(k)];
    for (Index i = 0; i < p; ++i) b.row(i) = B.row(k).segment(i * q, q);
    // with B_h = (B + Bᴴ)/2: tr(B_h S B_h S) = Re [tr(B S B S) + tr(B S Bᴴ S)]/2
    bS.noalias() = b.lazyProduct(S);
    across.noalias() = bS.lazyProduct(b.adjoint());
    for (Index i = 0; i < p; ++i) square.col(i) = bS.col(whole.references[static_cast<size_t>(i)]);
    const double both = 0.5 * (square.cwiseProduct(square.transpose()).sum() +
                               across.cwiseProduct(S_rr.transpose()).sum())
                                  .real();
    const double alone = square.trace().real();
    sum += narrowing_[k] * std::max(0.0, both - alone * alone / K);
  }
  sum /= 1.0 - 1.0 / (K * K);
  // twice the half circle over n = 2 L lines
  return 2.0 / whole.samples * sum / static_cast<double>(half_.taper.size());
}

}  // namespace hydrapod::identification
