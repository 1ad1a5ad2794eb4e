#include "record_band.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Σ|rest|² per column after the best combination of the columns of X.
VectorXd rest_of(const MatrixXcd& X, const MatrixXcd& Y) {
  const Eigen::ColPivHouseholderQR<MatrixXcd> qr(X);
  const MatrixXcd turned = qr.householderQ().adjoint() * Y;
  return turned.bottomRows(Y.rows() - qr.rank()).colwise().squaredNorm().transpose();
}

/// Is an output heard in these lines?
bool is_heard(const MatrixXcd& U, const MatrixXcd& Y, double least) {
  const Index w = U.rows(), p = U.cols();
  MatrixXcd X(w, p + 1);
  X << U * U.colwise().norm().cwiseMax(1e-300).cwiseInverse().asDiagonal(),
      MatrixXcd::Constant(w, 1, 1.0 / std::sqrt(static_cast<double>(w)));
  const VectorXd with = rest_of(X, Y), without = rest_of(X.rightCols(1), Y);
  for (Index o = 0; o < Y.cols(); ++o) {
    const double F = (without[o] - with[o]) / static_cast<double>(p) /
                     std::max(with[o] / static_cast<double>(w - p - 1), 1e-300);
    if (without[o] > 0.0 && F > least) return true;
  }
  return false;
}

}  // namespace

std::optional<double> audible_end(const Signals& signals, double chance) {
  std::optional<double> end;
  for (const auto& piece : signals.pieces) {
    const MatrixXcd U = lines_of(piece.inputs), Y = lines_of(piece.outputs);
    const Index p = U.cols(), w = 2 * (p + 1) + 6, step = w / 2, lines = Y.rows() - 1;
    const double spacing =
        signals.sample_rate / static_cast<double>(good_length(piece.outputs.rows()));
    const double tests = static_cast<double>(std::max<Index>(1, (lines - w) / step) * Y.cols());
    const double least = numerics::fisher_quantile(
        1.0 - chance / tests, 2.0 * static_cast<double>(p), 2.0 * static_cast<double>(w - p - 1));
    bool before = true;  // the lowest lines lie in one window only
    for (Index k = 1; k + w <= lines; k += step) {
      const bool heard = is_heard(U.middleRows(k, w), Y.middleRows(k, w), least);
      if (heard && before)
        end = std::max(end.value_or(0.0), static_cast<double>(k + w - 1) * spacing);
      before = heard;
    }
  }
  return end;
}

}  // namespace hydrapod::identification
