#include "fit_system.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "line_weights.hpp"

namespace hydrapod::identification {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

constexpr Complex i_unit{0.0, 1.0};
constexpr Index chunk = 64;  // lines whose derivatives are multiplied at once

/// Real and imaginary rows of complex columns below each other, times `scale`.
void stack(const MatrixXcd& columns, double scale, Eigen::Ref<MatrixXd> rows) {
  rows.topRows(columns.rows()) = scale * columns.real();
  rows.bottomRows(columns.rows()) = scale * columns.imag();
}

}  // namespace

void SharedParameters::step(const VectorXd& change) {
  Index at = 0;
  for (Index r = 0; r < poles.size(); ++r) {
    poles[r] += Complex(change[at], change[at + 1]);
    at += 2;
    for (Index i = 0; i < participations.rows(); ++i) {
      if (i == fixed[static_cast<size_t>(r)]) continue;
      participations(i, r) += Complex(change[at], change[at + 1]);
      at += 2;
    }
  }
}

FitSystem::FitSystem(const FrequencyResponses& r, bool taper)
    : responses_(r),
      pole_basis_(r, taper),
      inputs_(r.H[0].cols()),
      outputs_(r.H[0].rows()),
      lines_(static_cast<Index>(r.lines())),
      omega_scale_(2.0 * std::numbers::pi * r.frequency.back()) {
  // row_weights hold one over the variance averaged over inputs; W takes the inputs' part of it
  deviation_ = row_weights(r, false).cwiseSqrt().cwiseInverse();
  for (Index k = 0; k < lines_; ++k) {
    MatrixXcd W = MatrixXcd::Identity(inputs_, inputs_);
    if (r.has_errors()) {
      MatrixXcd Q = r.input_factor[static_cast<size_t>(k)].transpose();
      Q /= Q.diagonal().real().mean();
      Q.diagonal().array() += 1e-12;
      W = Q.llt().matrixL().solve(W);
    }
    white_.push_back(std::move(W));
  }
}

Basis FitSystem::basis(const SharedParameters& shared) const {
  Basis basis;
  for (const Complex pole : shared.poles) basis.lines.push_back(pole_basis_.at(pole));
  for (const auto& W : white_) {
    basis.u.push_back(W * shared.participations);
    basis.uc.push_back(W * shared.participations.conjugate());
  }
  return basis;
}

void FitSystem::own_columns(const Basis& basis, Index line, Eigen::Ref<MatrixXcd> columns) const {
  const auto k = static_cast<size_t>(line);
  const auto modes = static_cast<Index>(basis.lines.size());
  for (Index r = 0; r < modes; ++r) {
    const auto& lines = basis.lines[static_cast<size_t>(r)];
    const VectorXcd a = lines.g[line] * basis.u[k].col(r);
    const VectorXcd b = lines.g_conjugate[line] * basis.uc[k].col(r);
    columns.col(2 * r) = a + b;
    columns.col(2 * r + 1) = i_unit * (a - b);
  }
  const Complex s =
      Complex(responses_.shift, 2.0 * std::numbers::pi * responses_.frequency[k]) / omega_scale_;
  for (int t = 0; t < residual_terms; ++t)
    columns.middleCols(2 * modes + t * inputs_, inputs_) =
        std::pow(s, t + lowest_residual_power) * white_[k];
}

void FitSystem::shared_columns(const Basis& basis, const SharedParameters& shared,
                               const VectorXcd& phi, Index line,
                               Eigen::Ref<MatrixXcd> columns) const {
  const auto k = static_cast<size_t>(line);
  Index at = 0;
  for (Index r = 0; r < phi.size(); ++r) {
    const auto& lines = basis.lines[static_cast<size_t>(r)];
    const Complex p = phi[r], pc = std::conj(p);
    const VectorXcd a = p * lines.slope[line] * basis.u[k].col(r);
    const VectorXcd b = pc * lines.slope_conjugate[line] * basis.uc[k].col(r);
    columns.col(at++) = a + b;
    columns.col(at++) = i_unit * (a - b);
    const Complex g = p * lines.g[line], gc = pc * lines.g_conjugate[line];
    for (Index i = 0; i < inputs_; ++i) {
      if (i == shared.fixed[static_cast<size_t>(r)]) continue;
      columns.col(at++) = (g + gc) * white_[k].col(i);
      columns.col(at++) = i_unit * (g - gc) * white_[k].col(i);
    }
  }
}

VectorXcd FitSystem::data(Index output, Index line) const {
  const auto k = static_cast<size_t>(line);
  return white_[k] * responses_.H[k].row(output).transpose();
}

FitSystem::OwnFit FitSystem::fit_own(const Basis& basis, Index output) const {
  const auto modes = static_cast<Index>(basis.lines.size());
  const Index own = own_count(modes), rows = 2 * inputs_;
  MatrixXd N = MatrixXd::Zero(own, own), J(rows * chunk, own);
  VectorXd b = VectorXd::Zero(own), y(rows * chunk);
  MatrixXcd columns(inputs_, own);
  double power = 0.0;
  for (Index first = 0; first < lines_; first += chunk) {
    const Index count = std::min(chunk, lines_ - first);
    for (Index k = 0; k < count; ++k) {
      const double scale = 1.0 / deviation_(first + k, output);
      own_columns(basis, first + k, columns);
      stack(columns, scale, J.middleRows(rows * k, rows));
      const VectorXcd x = data(output, first + k);
      y.segment(rows * k, inputs_) = scale * x.real();
      y.segment(rows * k + inputs_, inputs_) = scale * x.imag();
    }
    const auto rows_used = J.topRows(rows * count);
    N.selfadjointView<Eigen::Lower>().rankUpdate(rows_used.transpose());
    b.noalias() += rows_used.transpose() * y.head(rows * count);
    power += y.head(rows * count).squaredNorm();
  }
  N.triangularView<Eigen::StrictlyUpper>() = N.transpose();
  const VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  MatrixXd scaled = scale.asDiagonal() * N * scale.asDiagonal();
  scaled.diagonal().array() += 1e-14;
  OwnFit fit;
  fit.parameters = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * b);
  // ‖y − J x‖² from the normal equations; rounding is far below what is compared
  fit.cost =
      std::max(0.0, power - 2.0 * b.dot(fit.parameters) + fit.parameters.dot(N * fit.parameters));
  return fit;
}

FitSystem::Normal FitSystem::normal(const Basis& basis, const SharedParameters& shared,
                                    Index output, const VectorXd& own) const {
  const auto modes = static_cast<Index>(basis.lines.size());
  const Index shared_size = shared_count(modes), own_size = own_count(modes);
  const Index all = shared_size + own_size, rows = 2 * inputs_;
  const VectorXcd phi = shape_row(own, modes);
  Normal normal{MatrixXd::Zero(all, all), VectorXd::Zero(all)};
  MatrixXd J(rows * chunk, all);
  VectorXd e(rows * chunk);
  MatrixXcd columns(inputs_, all);
  for (Index first = 0; first < lines_; first += chunk) {
    const Index count = std::min(chunk, lines_ - first);
    for (Index k = 0; k < count; ++k) {
      const double scale = 1.0 / deviation_(first + k, output);
      shared_columns(basis, shared, phi, first + k, columns.leftCols(shared_size));
      own_columns(basis, first + k, columns.rightCols(own_size));
      stack(columns, scale, J.middleRows(rows * k, rows));
      const VectorXcd x = data(output, first + k) - columns.rightCols(own_size) * own;
      e.segment(rows * k, inputs_) = scale * x.real();
      e.segment(rows * k + inputs_, inputs_) = scale * x.imag();
    }
    const auto used = J.topRows(rows * count);
    normal.matrix.selfadjointView<Eigen::Lower>().rankUpdate(used.transpose());
    normal.gradient.noalias() += used.transpose() * e.head(rows * count);
  }
  normal.matrix.triangularView<Eigen::StrictlyUpper>() = normal.matrix.transpose();
  return normal;
}

VectorXcd shape_row(const VectorXd& own, Index modes) {
  VectorXcd phi(modes);
  for (Index r = 0; r < modes; ++r) phi[r] = {own[2 * r], own[2 * r + 1]};
  return phi;
}

}  // namespace hydrapod::identification
