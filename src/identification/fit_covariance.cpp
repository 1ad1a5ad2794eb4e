#include "fit_covariance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <deque>
#include <numbers>

namespace hydrapod::identification {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Inverse of a symmetric positive matrix; directions that the data do not tell at all (two equal
/// poles may share their shapes in any way) count as known, not as infinitely uncertain.
MatrixXd inverse(const MatrixXd& N) {
  const VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scale.asDiagonal() * N * scale.asDiagonal());
  const double least = 1e-13 * solver.eigenvalues().maxCoeff();
  VectorXd inverted = solver.eigenvalues();
  for (double& value : inverted) value = value > least ? 1.0 / value : 0.0;
  const MatrixXd V = scale.asDiagonal() * solver.eigenvectors();
  return V * inverted.asDiagonal() * V.transpose();
}

/// The outputs' noise, each to its own deviation: cov(e_o, e_p*) per line.
MatrixXcd noise_coherence(const FitSystem& system, const FrequencyResponses& r, Index line) {
  MatrixXcd C = MatrixXcd::Identity(system.outputs(), system.outputs());
  if (!r.has_errors()) return C;
  const auto& S = r.noise[static_cast<size_t>(line)];
  const double Q = r.input_factor[static_cast<size_t>(line)].diagonal().real().mean();
  for (Index o = 0; o < C.rows(); ++o)
    for (Index p = 0; p < C.cols(); ++p)
      C(o, p) = S(o, p) * Q / (system.deviation()(line, o) * system.deviation()(line, p));
  return C;
}

/// Jᵀ cov(e) J of the shared parameters, own ones eliminated by `X`.
class Meat {
 public:
  Meat(const FitSystem& system, const FrequencyResponses& responses, const FittedState& state,
       const std::vector<MatrixXd>& X)
      : system_(system), responses_(responses), state_(state), X_(X) {}

  MatrixXd sum() {
    const Index shared = system_.shared_count(state_.shared.poles.size());
    const auto& a = responses_.line_covariance;
    const auto reach = static_cast<Index>(a.size()) - 1;
    MatrixXd total = MatrixXd::Zero(shared, shared);
    std::deque<MatrixXcd> near;  // of the lines from `first` on
    Index first = 0, next = 0;
    for (Index k = 0; k < system_.lines(); ++k) {
      for (; next < system_.lines() && next <= k + reach; ++next) near.push_back(derivatives(next));
      for (; first < k - reach; ++first) near.pop_front();
      MatrixXcd smooth = MatrixXcd::Zero(near[0].rows(), shared);
      for (Index j = first; j < next; ++j)
        smooth +=
            (j < k ? std::conj(a[static_cast<size_t>(k - j)]) : a[static_cast<size_t>(j - k)]) *
            near[static_cast<size_t>(j - first)];
      add(near[static_cast<size_t>(k - first)], smooth, noise_coherence(system_, responses_, k),
          total);
    }
    return total;
  }

 private:
  /// All outputs' derivatives at a line below each other.
  MatrixXcd derivatives(Index line) const {
    const Index modes = state_.shared.poles.size(), p = system_.inputs();
    const Index shared = system_.shared_count(modes);
    MatrixXcd all(p * system_.outputs(), shared), own(p, system_.own_count(modes)),
        columns(p, shared);
    system_.own_columns(state_.basis, line, own);
    for (Index o = 0; o < system_.outputs(); ++o) {
      const auto at = static_cast<size_t>(o);
      system_.shared_columns(state_.basis, state_.shared, shape_row(state_.own[at], modes), line,
                             columns);
      all.middleRows(o * p, p) = (columns - own * X_[at]) / system_.deviation()(line, o);
    }
    return all;
  }

  /// ½ Re(Gᴴ (C ⊗ I) G'), in real numbers.
  void add(const MatrixXcd& G, const MatrixXcd& smooth, const MatrixXcd& C, MatrixXd& total) const {
    const Index p = system_.inputs(), outputs = system_.outputs();
    MatrixXcd mixed = MatrixXcd::Zero(G.rows(), G.cols());
    for (Index o = 0; o < outputs; ++o)
      for (Index q = 0; q < outputs; ++q)
        mixed.middleRows(o * p, p) += C(o, q) * smooth.middleRows(q * p, p);
    total.noalias() += 0.5 * G.real().transpose() * mixed.real();
    total.noalias() += 0.5 * G.imag().transpose() * mixed.imag();
  }

  const FitSystem& system_;
  const FrequencyResponses& responses_;
  const FittedState& state_;
  const std::vector<MatrixXd>& X_;
};

void pole_deviations(const MatrixXd& covariance, Index at, FittedMode& mode) {
  const Complex l = mode.pole;
  const double w = std::abs(l);
  const Eigen::RowVector2d omega(l.real() / w, l.imag() / w);
  // ζ = −Re/|λ|
  const Eigen::RowVector2d zeta(-std::pow(l.imag(), 2) / std::pow(w, 3),
                                l.real() * l.imag() / std::pow(w, 3));
  const Eigen::Matrix2d block = covariance.block<2, 2>(at, at);
  mode.omega_deviation = std::sqrt(std::max(0.0, (omega * block * omega.transpose()).value()));
  mode.damping_deviation = std::sqrt(std::max(0.0, (zeta * block * zeta.transpose()).value()));
}

}  // namespace

MatrixXd own_by_shared(const MatrixXd& normal, Index shared) {
  const Index own = normal.rows() - shared;
  MatrixXd N = normal.bottomRightCorner(own, own);
  const VectorXd scale = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  N = scale.asDiagonal() * N * scale.asDiagonal();
  N.diagonal().array() += 1e-14;
  return scale.asDiagonal() *
         N.ldlt().solve(scale.asDiagonal() * normal.bottomLeftCorner(own, shared));
}

VectorXd row_sizes(const FrequencyResponses& responses) {
  VectorXd sum = VectorXd::Zero(responses.H[0].rows());
  for (const auto& H : responses.H) sum += H.rowwise().squaredNorm();
  return (sum / static_cast<double>(responses.lines())).cwiseSqrt().cwiseMax(1e-300);
}

MatrixXcd modelled(const ModalModel& model, const std::vector<PoleLines>& lines, Index line,
                   const FrequencyResponses& responses) {
  const double omega = 2.0 * std::numbers::pi * responses.frequency[static_cast<size_t>(line)];
  const Complex s = Complex(responses.shift, omega) / model.omega_scale;
  MatrixXcd H = MatrixXcd::Zero(responses.H[0].rows(), responses.H[0].cols());
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    const MatrixXcd A = model.modes[r].shape * model.modes[r].participation.transpose();
    H += lines[r].g[line] * A + lines[r].g_conjugate[line] * A.conjugate();
  }
  for (int t = 0; t < residual_terms; ++t)
    H += std::pow(s, t + lowest_residual_power) * model.residuals[static_cast<size_t>(t)];
  return H;
}

void add_deviations(const FitSystem& system, const FrequencyResponses& responses,
                    const FittedState& state, double misfit, ModalModel& model) {
  const Index modes = state.shared.poles.size(), shared = system.shared_count(modes);
  MatrixXd N = MatrixXd::Zero(shared, shared);
  std::vector<MatrixXd> X, own_inverse;
  for (Index o = 0; o < system.outputs(); ++o) {
    const auto normal =
        system.normal(state.basis, state.shared, o, state.own[static_cast<size_t>(o)]);
    const Index own = normal.matrix.rows() - shared;
    X.push_back(own_by_shared(normal.matrix, shared));
    own_inverse.push_back(inverse(normal.matrix.bottomRightCorner(own, own)));
    N += normal.matrix.topLeftCorner(shared, shared) -
         normal.matrix.topRightCorner(shared, own) * X.back();
  }
  const double scale = responses.has_errors() ? std::max(1.0, misfit) : misfit;
  const MatrixXd N_inverse = inverse(N);
  const MatrixXd covariance =
      scale * N_inverse * Meat(system, responses, state, X).sum() * N_inverse;
  double neighbours = 1.0;  // noise that neighbouring lines share counts that often
  for (std::size_t d = 1; d < responses.line_covariance.size(); ++d)
    neighbours += 2.0 * responses.line_covariance[d].real();
  for (Index r = 0; r < modes; ++r) {
    auto& mode = model.modes[static_cast<size_t>(r)];
    pole_deviations(covariance, r * 2 * system.inputs(), mode);
    mode.shape_deviation.resize(system.outputs());
    for (Index o = 0; o < system.outputs(); ++o) {
      const auto at = static_cast<size_t>(o);
      const auto rows = X[at].middleRows(2 * r, 2);
      const double variance =
          (rows * covariance * rows.transpose()).trace() +
          0.5 * scale * neighbours * own_inverse[at].block<2, 2>(2 * r, 2 * r).trace();
      mode.shape_deviation[o] = std::sqrt(std::max(0.0, variance));
    }
  }
}

}  // namespace hydrapod::identification
