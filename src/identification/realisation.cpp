#include "hydrapod/identification/cross_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "selection.hpp"

namespace hydrapod::identification {

namespace {

constexpr double reliable_taper = 0.3;  // of ρ: lags with less are not used

/// Lags 1, 2, … of matrices given at the lines 0 … K, divided by ρ.
MarkovSequence lags_of(const std::vector<MatrixXcd>& lines, double spacing, const VectorXd& taper,
                       double taper_rate) {
  const auto K = static_cast<int>(lines.size()) - 1;
  numerics::RealFft fft(2 * K);
  MarkovSequence sequence;
  sequence.interval = 1.0 / (2.0 * K * spacing);
  const Index rows = lines[0].rows(), columns = lines[0].cols();
  std::vector<double> factor;  // 1/ρ per lag, as far as it goes
  for (int t = 1; t < K; ++t) {
    double rho = 1.0;
    if (taper.size() > 0) {
      const double at = t * sequence.interval * taper_rate;
      const auto before = static_cast<Index>(at);
      if (before + 1 >= taper.size()) break;
      const double share = at - static_cast<double>(before);
      rho = (1.0 - share) * taper[before] + share * taper[before + 1];
      if (rho < reliable_taper) break;
    }
    factor.push_back(1.0 / rho);
  }
  sequence.values.assign(factor.size(), MatrixXd(rows, columns));
  std::vector<Complex> spectrum(lines.size());
  std::vector<double> samples(2 * static_cast<std::size_t>(K));
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) {
      for (std::size_t k = 0; k < lines.size(); ++k) spectrum[k] = lines[k](i, j);
      spectrum.front() = spectrum.front().real();
      spectrum.back() = spectrum.back().real();
      fft.inverse(spectrum, samples);
      for (std::size_t t = 0; t < factor.size(); ++t)
        sequence.values[t](i, j) = factor[t] * samples[t + 1];
    }
  return sequence;
}

struct Hankel {
  MatrixXd U, V;
  VectorXd s;
  Index rows, columns;  // of one Y
};

Hankel decompose(const MarkovSequence& sequence, int highest) {
  const Index rows = sequence.values[0].rows(), columns = sequence.values[0].cols();
  // enough blocks for twice the highest order, and lags that reach over slow modes
  constexpr Index most = 60;
  const auto available = static_cast<Index>(sequence.values.size());
  const Index wanted = std::max<Index>(2 * highest / std::min(rows, columns) + 2, most);
  const Index blocks = std::min(wanted, (available + 1) / 2);
  MatrixXd H(blocks * rows, blocks * columns);
  for (Index i = 0; i < blocks; ++i)
    for (Index j = 0; j < blocks; ++j)
      H.block(i * rows, j * columns, rows, columns) = sequence.values[static_cast<size_t>(i + j)];
  auto svd = numerics::singular_values(H);
  return {std::move(svd.U), std::move(svd.V), std::move(svd.s), rows, columns};
}

OrderPoles poles_of(const Hankel& h, int order, double interval) {
  const Index up = h.U.rows() - h.rows;
  const VectorXd root = h.s.head(order).cwiseSqrt();
  const MatrixXd O = h.U.leftCols(order) * root.asDiagonal();
  const MatrixXd A = numerics::least_squares(O.topRows(up), O.bottomRows(up));
  const MatrixXd B = root.asDiagonal() * h.V.topLeftCorner(h.columns, order).transpose();
  const auto [values, V, converged] = numerics::eigen_pairs(A);
  OrderPoles found{.order = order, .poles = {}};
  if (!converged) return found;
  const MatrixXcd L = numerics::inverse(V) * B;
  for (Index r = 0; r < order; ++r) {
    const Complex z = values[r];
    if (std::abs(z) < 1e-12 || !(std::arg(z) > 0.0)) continue;
    PoleEstimate e;
    e.pole = std::log(z) / interval;
    e.shape = O.topRows(h.rows) * V.col(r);
    e.participation = L.row(r).transpose();
    if (std::arg(z) < std::numbers::pi * (1.0 - 1e-9) && e.shape.allFinite())
      found.poles.push_back(std::move(e));
  }
  std::ranges::sort(found.poles, {}, [](const PoleEstimate& e) { return e.omega(); });
  return found;
}

}  // namespace

MarkovSequence impulse_response(const FrequencyResponses& r) {
  if (r.lines() < 4) throw base::ComputationError("an impulse response needs at least four lines");
  const double spacing =
      (r.frequency.back() - r.frequency.front()) / static_cast<double>(r.lines() - 1);
  const double first = r.frequency.front() / spacing;
  std::vector<MatrixXcd> lines;
  // below the first line: its real part, as of a static response
  for (Index k = 0; k < std::llround(first); ++k)
    lines.emplace_back(r.H.front().real().cast<Complex>());
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const double expected = r.frequency.front() + static_cast<double>(k) * spacing;
    if (std::abs(r.frequency[k] - expected) > 1e-3 * spacing ||
        std::abs(first - std::round(first)) > 1e-3)
      throw base::ComputationError(
          "an impulse response needs evenly spaced frequencies that are "
          "multiples of their distance");
    lines.push_back(r.H[k]);
  }
  if (!(r.shift > 0.0)) return lags_of(lines, spacing, r.taper, r.sample_rate);
  const double interval = 0.5 / r.frequency.back();
  const auto lags = static_cast<Index>(1.0 / (spacing * interval)) + 2;
  const Eigen::ArrayXd time =
      interval * Eigen::ArrayXd::LinSpaced(lags, 0.0, static_cast<double>(lags - 1));
  return lags_of(lines, spacing, (-r.shift * time).exp().matrix(), 1.0 / interval);
}

std::vector<OrderPoles> realised_poles(const MarkovSequence& sequence, const OrderRange& orders) {
  constexpr std::size_t fewest = 8;
  if (sequence.values.size() < fewest)
    throw base::ComputationError("the responses are too short to realise a model from");
  const Hankel hankel = decompose(sequence, orders.highest);
  std::vector<OrderPoles> all;
  const auto bearable = static_cast<int>(std::min(hankel.s.size(), hankel.U.rows() - hankel.rows));
  for (int n = orders.lowest; n <= std::min(orders.highest, bearable); n += orders.step) {
    if (!(hankel.s[n - 1] > 1e-13 * hankel.s[0])) break;
    all.push_back(poles_of(hankel, n, sequence.interval));
  }
  return all;
}

}  // namespace hydrapod::identification
