#include "predictor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "bridge.hpp"

namespace hydrapod::identification {

namespace {

/// Last rows of pieces of p + 1 rows, of those that miss the fewest samples, and whether any does.
struct FitRows {
  std::vector<Index> last{};
  bool whole{true};
};

FitRows choose_rows(const Mask& missing, Index order, Index most) {
  std::vector<int> own, counts;
  int running = 0;
  for (Index t = 0; t < missing.rows(); ++t) {
    own.push_back(missing.row(t).cast<int>().sum());
    running += own.back();
    if (t > order) running -= own[static_cast<std::size_t>(t - order - 1)];
    if (t >= order) counts.push_back(running);
  }
  FitRows chosen;
  if (counts.empty()) return chosen;
  auto sorted = counts;
  const auto at = std::min(sorted.size(), static_cast<std::size_t>(most)) - 1;
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(at));
  const int limit = sorted[at];
  chosen.whole = limit == 0;
  std::vector<Index> all;
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (counts[k] <= limit) all.push_back(static_cast<Index>(k) + order);
  // evenly over the record
  const std::size_t count = std::min(all.size(), static_cast<std::size_t>(most));
  for (std::size_t k = 0; k < count; ++k) chosen.last.push_back(all[k * all.size() / count]);
  return chosen;
}

}  // namespace

Predictor::Predictor(Rows& z, const Mask& missing, Index given, const PredictorOptions& options)
    : given_(given), targets_(z.cols() - given) {
  const Index longest = std::max<Index>(1, z.rows() / 4);
  order_ = std::clamp<Index>(options.most_coefficients / z.cols(), 1,
                             std::min(options.highest_order, longest));
  const auto rows = choose_rows(missing, order_, options.most_rows);
  for (Index c = given; c < z.cols(); ++c)
    bridge(z.col(c), [&](Index t) { return missing(t, c) != 0; });
  for (int round = 0; round < (rows.whole ? 1 : options.rounds); ++round) {
    fit(z, rows.last, options.ridge);
    fill(z, missing);
  }
}

void Predictor::fit(const Rows& z, const std::vector<Index>& rows, double ridge) {
  const Index D = z.cols(), n = (order_ + 1) * D, past = n - targets_;
  constexpr Index at_once = 256;
  MatrixXd S = MatrixXd::Zero(n, n), piece(n, at_once);
  Index held = 0;
  const auto add = [&] {
    if (held == 0) return;  // Eigen divides by it
    S.selfadjointView<Eigen::Lower>().rankUpdate(piece.leftCols(held));
    held = 0;
  };
  for (const Index t : rows) {
    piece.col(held++) = VectorXd::Map(&z(t - order_, 0), n);
    if (held == at_once) add();
  }
  add();
  S /= static_cast<double>(std::max<std::size_t>(rows.size(), 1));
  S.diagonal().array() += ridge;
  const MatrixXd of_past = S.topLeftCorner(past, past).selfadjointView<Eigen::Lower>();
  const MatrixXd cross = S.bottomLeftCorner(targets_, past);
  const MatrixXd A = of_past.ldlt().solve(cross.transpose()).transpose();
  MatrixXd rest = S.bottomRightCorner(targets_, targets_).selfadjointView<Eigen::Lower>();
  rest -= A * cross.transpose();
  rest.diagonal() = rest.diagonal().cwiseMax(ridge);
  G_.resize(targets_, n);
  G_.leftCols(past) = -A;
  G_.rightCols(targets_).setIdentity();
  const Eigen::LLT<MatrixXd> root(rest);
  if (root.info() == Eigen::Success)
    root.matrixL().solveInPlace(G_);
  else
    G_ = rest.diagonal().cwiseSqrt().cwiseInverse().asDiagonal() * G_;
  coupling_.assign(static_cast<std::size_t>(order_) + 1, MatrixXd::Zero(targets_, targets_));
  const auto at_lag = [&](Index k) { return G_.middleCols((order_ - k) * D + given_, targets_); };
  for (Index d = 0; d <= order_; ++d)
    for (Index k = 0; k + d <= order_; ++k)
      coupling_[static_cast<std::size_t>(d)] += at_lag(k + d).transpose() * at_lag(k);
}

/// W e_t for t = first … last, a column each.
MatrixXd Predictor::errors(const Rows& z, Index first, Index last) const {
  const Index D = z.cols();
  MatrixXd e(targets_, last - first + 1);
  for (Index t = first; t <= last; ++t) {
    const Index from = std::max<Index>(0, t - order_), to = std::min(t, z.rows() - 1);
    const Index count = (to - from + 1) * D;
    e.col(t - first) =
        G_.middleCols((from - t + order_) * D, count) * VectorXd::Map(&z(from, 0), count);
  }
  return e;
}

std::vector<Predictor::Piece> Predictor::pieces_of(Rows& z, const Mask& missing,
                                                   Index first) const {
  std::vector<Piece> pieces(static_cast<std::size_t>((z.rows() + order_ - 1) / order_));
  for (Index t = first; t < z.rows(); ++t)
    for (Index c = given_; c < z.cols(); ++c) {
      if (!missing(t, c)) continue;
      z(t, c) = 0.0;
      pieces[static_cast<std::size_t>(t / order_)].unknowns.push_back({t, c - given_});
    }
  return pieces;
}

MatrixXd Predictor::products(const std::vector<Unknown>& a, const std::vector<Unknown>& b) const {
  MatrixXd M(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Index apart = b[j].row - a[i].row, d = std::abs(apart);
      const auto& P = coupling_[static_cast<std::size_t>(std::min(d, order_))];
      M(static_cast<Index>(i), static_cast<Index>(j)) = d > order_   ? 0.0
                                                        : apart >= 0 ? P(a[i].column, b[j].column)
                                                                     : P(b[j].column, a[i].column);
    }
  return M;
}

VectorXd Predictor::right_side(const Rows& z, const std::vector<Unknown>& unknowns) const {
  const Index from = unknowns.front().row, to = unknowns.back().row;
  const MatrixXd e = errors(z, from, to + order_);
  VectorXd v(unknowns.size());
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto& x = unknowns[i];
    double sum = 0.0;
    for (Index k = 0; k <= order_; ++k)
      sum -= G_.col((order_ - k) * z.cols() + given_ + x.column).dot(e.col(x.row + k - from));
    v[static_cast<Index>(i)] = sum;
  }
  return v;
}

void Predictor::eliminate(const Rows& z, const Piece& before, Piece& own) const {
  own.v = right_side(z, own.unknowns);
  MatrixXd S = products(own.unknowns, own.unknowns);
  if (!before.unknowns.empty()) {
    own.C = before.L.triangularView<Eigen::Lower>()
                .solve(products(before.unknowns, own.unknowns))
                .transpose();
    S.noalias() -= own.C * own.C.transpose();
    own.v -= own.C * before.v;
  }
  own.L = Eigen::LLT<MatrixXd>(S).matrixL();
  own.L.triangularView<Eigen::Lower>().solveInPlace(own.v);
}

void Predictor::fill(Rows& z, const Mask& missing, Index first, numerics::Gaussian* random) const {
  auto pieces = pieces_of(z, missing, first);
  const Piece none;
  for (std::size_t w = 0; w < pieces.size(); ++w)
    if (!pieces[w].unknowns.empty()) eliminate(z, w > 0 ? pieces[w - 1] : none, pieces[w]);
  for (std::size_t w = pieces.size(); w-- > 0;) {
    auto& own = pieces[w];
    if (own.unknowns.empty()) continue;
    if (random != nullptr)
      for (double& x : own.v) x += (*random)();
    if (w + 1 < pieces.size() && !pieces[w + 1].unknowns.empty())
      own.v -= pieces[w + 1].C.transpose() * pieces[w + 1].v;
    own.L.transpose().triangularView<Eigen::Upper>().solveInPlace(own.v);
    for (std::size_t i = 0; i < own.unknowns.size(); ++i)
      z(own.unknowns[i].row, given_ + own.unknowns[i].column) = own.v[static_cast<Index>(i)];
  }
}

}  // namespace hydrapod::identification
