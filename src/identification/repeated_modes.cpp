#include "repeated_modes.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "line_weights.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr double apart = 3.0;  // standard deviations

bool cannot_be_told_apart(const FittedMode& a, const FittedMode& b) {
  return std::abs(a.omega() - b.omega()) <=
             apart * std::hypot(a.omega_deviation, b.omega_deviation) &&
         std::abs(a.damping_ratio() - b.damping_ratio()) <=
             apart * std::hypot(a.damping_deviation, b.damping_deviation);
}

/// Real basis of the space that the columns of `shapes` span; empty when there is none.
MatrixXd real_basis(const MatrixXcd& shapes) {
  const Index count = shapes.cols();
  const Eigen::HouseholderQR<MatrixXcd> qr(shapes);
  const MatrixXcd Q = qr.householderQ() * MatrixXcd::Identity(shapes.rows(), count);
  MatrixXd parts(shapes.rows(), 2 * count);
  parts << Q.real(), Q.imag();
  const Eigen::JacobiSVD<MatrixXd> svd(parts, Eigen::ComputeThinU);
  constexpr double real_enough = 0.3;
  const auto& s = svd.singularValues();
  if (s.size() > count && s[count] > real_enough * s[count - 1]) return {};
  return svd.matrixU().leftCols(count);
}

/// Rows that tell the columns apart, ascending: the first ones that do so nearly as well as the
/// best.
std::vector<Index> pivots(const MatrixXd& basis) {
  MatrixXd rest = basis;
  std::vector<Index> rows;
  for (Index r = 0; r < basis.cols(); ++r) {
    constexpr double nearly = 0.5;
    const VectorXd left = rest.rowwise().squaredNorm();
    Index at = 0;
    while (left[at] < nearly * left.maxCoeff()) ++at;
    rows.push_back(at);
    const Eigen::RowVectorXd along = rest.row(at).normalized();
    rest -= (rest * along.transpose()) * along;
  }
  std::ranges::sort(rows);
  return rows;
}

/// Which column of `along` goes to which of the modes with the fitted `shapes`.
std::vector<Index> order_of(const MatrixXcd& shapes, const MatrixXd& along) {
  constexpr double clearly = 0.3;
  std::vector<Index> order(static_cast<std::size_t>(along.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  const auto likeness = [&](const std::vector<Index>& some) {
    double sum = 0.0;
    for (std::size_t r = 0; r < some.size(); ++r)
      sum +=
          mac(shapes.col(static_cast<Index>(r)), along.col(some[r]).cast<std::complex<double>>());
    return sum;
  };
  auto best = order, trial = order;
  double most = likeness(order) + clearly;
  while (std::ranges::next_permutation(trial).found)
    if (const double sum = likeness(trial); sum > most) {
      most = sum;
      best = trial;
    }
  return best;
}

/// Modes from `first` on of which each two cannot be told apart: one past the last.
std::size_t end_of_group(const std::vector<IdentifiedMode>& modes, std::size_t first) {
  std::size_t end = first + 1;
  const auto joins = [&](std::size_t candidate) {
    for (std::size_t r = first; r < candidate; ++r)
      if (!cannot_be_told_apart(modes[r].fit, modes[candidate].fit)) return false;
    return true;
  };
  while (end < modes.size() && joins(end)) ++end;
  return end;
}

}  // namespace

void untangle_repeated(const FrequencyResponses& responses, std::vector<IdentifiedMode>& modes) {
  const VectorXd size = row_sizes(responses);
  for (std::size_t first = 0, end = 0; first < modes.size(); first = end) {
    end = end_of_group(modes, first);
    const auto count = static_cast<Index>(end - first);
    if (count < 2 || count >= size.size()) continue;
    MatrixXcd shapes(size.size(), count);
    for (Index r = 0; r < count; ++r) {
      const auto& shape = modes[first + static_cast<std::size_t>(r)].displacement;
      shapes.col(r) = shape.cwiseQuotient(size);
      shapes.col(r).normalize();
    }
    const MatrixXd basis = real_basis(shapes);
    if (basis.size() == 0) continue;
    const auto rows = pivots(basis);
    const MatrixXd along = basis * MatrixXd(basis(rows, Eigen::all)).inverse();
    const auto order = order_of(shapes, along);
    for (Index r = 0; r < count; ++r) {
      auto& mode = modes[first + static_cast<std::size_t>(r)];
      const Index column = order[static_cast<std::size_t>(r)];
      mode.displacement =
          (along.col(column).cwiseProduct(size) / size[rows[static_cast<std::size_t>(column)]])
              .cast<std::complex<double>>();
      mode.repeated = static_cast<int>(count);
    }
  }
}

}  // namespace hydrapod::identification
