#include "varx.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::identification {

namespace {

/// RMS per column over all pieces.
VectorXd sizes(const std::vector<Regression>& pieces, MatrixXd Regression::*part) {
  VectorXd sum = VectorXd::Zero((pieces.front().*part).cols());
  double count = 0.0;
  for (const auto& piece : pieces) {
    sum += (piece.*part).colwise().squaredNorm().transpose();
    count += static_cast<double>((piece.*part).rows());
  }
  return (sum / std::max(count, 1.0)).cwiseSqrt().cwiseMax(1e-300);
}

/// Regressors of one order, and how they are laid out.
struct Layout {
  Index p{}, q{};
  bool direct{};
  [[nodiscard]] Index head() const { return direct ? p : 0; }
  [[nodiscard]] Index count(Index order) const { return head() + order * (p + q); }
};

Index rows_of(const std::vector<Regression>& pieces, Index order, Index touched) {
  Index rows = 0;
  for (const auto& piece : pieces)
    rows += std::max<Index>(0, piece.outputs.rows() - order - 2 * touched);
  return rows;
}

Index highest_order(const std::vector<Regression>& pieces, const Layout& layout, Index touched,
                    const VarxOptions& options) {
  for (Index n = options.highest_order; n > 0; --n) {
    const Index k = layout.count(n);
    const auto N = static_cast<double>(rows_of(pieces, n, touched));
    if (k <= std::max(options.most_coefficients, layout.count(1)) &&
        static_cast<double>(k) <= options.most_share * N)
      return n;
  }
  return 0;
}

/// Rows (regressors, y), all channels by their sizes; below them the ridge.
MatrixXd stacked(const std::vector<Regression>& pieces, const Layout& layout, Index order,
                 Index touched, const Varx& model, double ridge) {
  const Index k = layout.count(order), rows = rows_of(pieces, order, touched);
  MatrixXd Z = MatrixXd::Zero(rows + k, k + layout.q);
  Index at = 0;
  for (const auto& piece : pieces) {
    const Index count = piece.outputs.rows() - order - 2 * touched, first = order + touched;
    if (count <= 0) continue;
    const MatrixXd u = piece.inputs * model.input_size.cwiseInverse().asDiagonal(),
                   y = piece.outputs * model.output_size.cwiseInverse().asDiagonal();
    auto part = Z.middleRows(at, count);
    if (layout.direct) part.leftCols(layout.p) = u.middleRows(first, count);
    for (Index lag = 1, c = layout.head(); lag <= order; ++lag, c += layout.p + layout.q) {
      part.middleCols(c, layout.q) = y.middleRows(first - lag, count);
      part.middleCols(c + layout.q, layout.p) = u.middleRows(first - lag, count);
    }
    part.rightCols(layout.q) = y.middleRows(first, count);
    at += count;
  }
  Z.block(rows, 0, k, k).diagonal().setConstant(std::sqrt(ridge * static_cast<double>(rows)));
  return Z;
}

/// The order with the least criterion. `R`: triangle of regressors and y.
Index best_order(const MatrixXd& R, const Layout& layout, Index highest, double N, double ridge) {
  const auto q = static_cast<double>(layout.q);
  Index best = 1;
  double least = 0.0;
  for (Index n = 1; n <= highest; ++n) {
    const auto k = static_cast<double>(layout.count(n));
    const auto rest = R.bottomRightCorner(R.rows() - layout.count(n), layout.q);
    MatrixXd S = rest.transpose() * rest / N;
    S.diagonal().array() += ridge;
    const double value = N * 2.0 * S.llt().matrixLLT().diagonal().array().log().sum() +
                         N * q * (N + k) / std::max(1.0, N - k - q - 1.0);
    if (n > 1 && value >= least) continue;
    least = value;
    best = n;
  }
  return best;
}

Complex delay(const Varx& model, double frequency) {
  return std::polar(1.0, -two_pi * frequency * model.interval);
}

/// A and G of channels of variance 1 at a line.
struct Scaled {
  MatrixXcd A_inverse, G, w;  // w: k × p
};

Scaled scaled_at(const Varx& model, double frequency) {
  const Index q = model.output_size.size(), p = model.input_size.size(),
              head = model.direct ? p : 0;
  const Complex z = delay(model, frequency);
  MatrixXcd A = MatrixXcd::Identity(q, q), B = MatrixXcd::Zero(q, p);
  if (model.direct) B = model.theta.topRows(p).transpose().cast<Complex>();
  Complex power = z;
  for (Index lag = 1, at = head; lag <= model.order; ++lag, at += p + q, power *= z) {
    A -= power * model.theta.middleRows(at, q).transpose();
    B += power * model.theta.middleRows(at + q, p).transpose();
  }
  Scaled result{.A_inverse = numerics::inverse(A), .G = {}, .w = {}};
  result.G = result.A_inverse * B;
  result.w = MatrixXcd::Zero(model.theta.rows(), p);
  if (model.direct) result.w.topRows(p).setIdentity();
  power = z;
  for (Index lag = 1, at = head; lag <= model.order; ++lag, at += p + q, power *= z) {
    result.w.middleRows(at, q) = power * result.G;
    result.w.middleRows(at + q, p).diagonal().setConstant(power);
  }
  return result;
}

/// The largest modulus of a pole.
double spectral_radius(const Varx& model) {
  const Index q = model.output_size.size(), p = model.input_size.size(),
              head = model.direct ? p : 0, n = model.order * q;
  MatrixXd A = MatrixXd::Zero(n, n);
  A.bottomLeftCorner(n - q, n - q).setIdentity();
  for (Index lag = 0; lag < model.order; ++lag)
    A.block(0, lag * q, q, q) = model.theta.middleRows(head + lag * (p + q), q).transpose();
  const auto values = numerics::eigenvalues(A);
  return values.size() > 0 ? values.cwiseAbs().maxCoeff() : 1.0;
}

/// h_1, h_2, … of channels of variance 1, times `factor`^k.
MarkovSequence impulse_response(const Varx& model, Index count, double factor) {
  const Index q = model.output_size.size(), p = model.input_size.size(),
              head = model.direct ? p : 0;
  std::vector<MatrixXd> h{model.direct ? MatrixXd(model.theta.topRows(p).transpose())
                                       : MatrixXd(MatrixXd::Zero(q, p))};
  for (Index k = 1; k <= count; ++k) {
    MatrixXd next = MatrixXd::Zero(q, p);
    double share = factor;
    for (Index lag = 1, at = head; lag <= std::min(k, model.order);
         ++lag, at += p + q, share *= factor) {
      next +=
          share * model.theta.middleRows(at, q).transpose() * h[static_cast<std::size_t>(k - lag)];
      if (lag == k) next += share * model.theta.middleRows(at + q, p).transpose();  // the pulse
    }
    h.push_back(std::move(next));
  }
  MarkovSequence sequence{.values = {}, .interval = model.interval};
  sequence.values.assign(h.begin() + 1, h.end());
  return sequence;
}

}  // namespace

Varx fit_varx(const std::vector<Regression>& pieces, double sample_rate, Index touched,
              const VarxOptions& options) {
  Varx model{.interval = 1.0 / sample_rate,
             .input_size = sizes(pieces, &Regression::inputs),
             .output_size = sizes(pieces, &Regression::outputs),
             .direct = options.direct};
  const Layout layout{model.input_size.size(), model.output_size.size(), options.direct};
  const Index highest =
      options.order > 0 ? options.order : highest_order(pieces, layout, touched, options);
  const Index rows = rows_of(pieces, highest, touched);
  if (highest == 0 || rows <= layout.count(highest) + layout.q)
    throw base::ComputationError(
        "the record is too short: it has too few samples for a model of the time record");
  const MatrixXd Z = stacked(pieces, layout, highest, touched, model, options.ridge);
  const Index most = layout.count(highest);
  const Eigen::HouseholderQR<MatrixXd> qr(Z);
  const MatrixXd R = qr.matrixQR().topRows(most + layout.q).template triangularView<Eigen::Upper>();
  model.rows = static_cast<double>(rows);
  model.order =
      options.order > 0 ? options.order : best_order(R, layout, highest, model.rows, options.ridge);
  const Index k = layout.count(model.order);
  model.root = R.topLeftCorner(k, k);
  model.theta = model.root.triangularView<Eigen::Upper>().solve(
      R.topRightCorner(R.rows(), layout.q).topRows(k));
  const auto rest = R.bottomRightCorner(R.rows() - k, layout.q);
  model.innovation = rest.transpose() * rest / (model.rows - static_cast<double>(k));
  return model;
}

Varx fit_varx(const Signals& signals, const VarxOptions& options) {
  std::vector<Regression> pieces;
  for (const auto& piece : signals.pieces) pieces.push_back({piece.inputs, piece.outputs});
  return fit_varx(pieces, signals.sample_rate, signals.touched, options);
}

MatrixXcd noise_at(const Varx& model, double frequency) {
  const MatrixXcd shape = model.output_size.asDiagonal() * scaled_at(model, frequency).A_inverse;
  return shape * model.innovation * shape.adjoint();
}

std::vector<OrderPoles> realised_poles(const Varx& model, const OrderRange& orders) {
  // an unstable pole of noise would hide all others: the response is brought to one that decays
  const double radius = std::max(1.0, spectral_radius(model));
  constexpr Index lags = 120;
  auto chart = realised_poles(impulse_response(model, lags, 1.0 / radius), orders);
  for (auto& order : chart) {
    for (auto& e : order.poles) {
      e.pole += std::log(radius) / model.interval;
      e.shape = model.output_size.asDiagonal() * e.shape;
      e.participation = model.input_size.cwiseInverse().asDiagonal() * e.participation;
    }
    std::erase_if(order.poles, [](const PoleEstimate& e) { return e.pole.real() >= 0.0; });
  }
  return chart;
}

FrequencyResponses responses_of(const Varx& model, double spacing, double to) {
  FrequencyResponses r;
  const MatrixXcd root = model.root.transpose().cast<Complex>();
  const MatrixXd by_input = model.input_size.cwiseInverse().asDiagonal();
  const auto lines = static_cast<Index>(to / spacing * (1.0 + 1e-12));
  for (Index k = 1; k <= lines; ++k) {
    const double f = static_cast<double>(k) * spacing;
    const auto at = scaled_at(model, f);
    const MatrixXcd shape = model.output_size.asDiagonal() * at.A_inverse;
    const MatrixXcd x = root.triangularView<Eigen::Lower>().solve(at.w);
    const MatrixXcd factor = x.adjoint() * x;
    r.frequency.push_back(f);
    r.H.push_back(model.output_size.asDiagonal() * at.G *
                  model.input_size.cwiseInverse().asDiagonal());
    r.noise.push_back(shape * model.innovation * shape.adjoint());
    r.input_factor.push_back(by_input * factor * by_input);
  }
  r.degrees = model.rows - static_cast<double>(model.theta.rows());
  r.sample_rate = 1.0 / model.interval;
  return r;
}

}  // namespace hydrapod::identification
