/// Balanced truncation (Moore, IEEE Trans. Autom. Control 26 (1981) 17) by the square-root method,
/// with the bound of Glover (Int. J. Control 39 (1984) 1115) and Enns (1984).

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::exchange {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// X of A X + X Aᵀ + F Fᵀ = 0, by the complex Schur form of A, column by column (Bartels and
/// Stewart, Comm. ACM 15 (1972) 820).
class Lyapunov {
 public:
  explicit Lyapunov(const MatrixXd& A) : schur_(A.cast<std::complex<double>>()) {}

  [[nodiscard]] MatrixXd solve(const MatrixXd& F) const {
    const MatrixXcd &U = schur_.matrixU(), &T = schur_.matrixT();
    const MatrixXcd G = U.adjoint() * F.cast<std::complex<double>>();
    const Index n = T.rows();
    MatrixXcd X = MatrixXcd::Zero(n, n);
    for (Index k = n; k-- > 0;) {
      VectorXcd right = -G * G.row(k).adjoint();
      const Index after = n - 1 - k;
      if (after > 0) right -= X.rightCols(after) * T.row(k).tail(after).adjoint();
      MatrixXcd shifted = T;
      shifted.diagonal().array() += std::conj(T(k, k));
      X.col(k) = shifted.triangularView<Eigen::Upper>().solve(right);
    }
    const MatrixXd real = (U * X * U.adjoint()).real();
    return 0.5 * (real + real.transpose());
  }

 private:
  Eigen::ComplexSchur<MatrixXcd> schur_;
};

/// L of L Lᵀ for a symmetric matrix without negative eigenvalues but by rounding.
MatrixXd square_root(const MatrixXd& gramian) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gramian);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// The part of a system whose poles are not in the left half-plane, in real coordinates
/// z = left x: ż = A z + …, x = right z + what is stable.
struct Unstable {
  MatrixXd A{}, left{}, right{};
  double largest{};  ///< |λ| of the whole system
};

Unstable unstable_part(const MatrixXd& A) {
  const auto all = numerics::eigen_system(A);
  if (!all.converged) throw base::ComputationError("the poles of the system were not found");
  Unstable part;
  part.largest = all.values.cwiseAbs().maxCoeff();
  const double rounding = 1e-12 * part.largest;
  std::vector<Index> found;
  for (Index k = 0; k < all.values.size(); ++k)
    if (all.values[k].real() >= -rounding) found.push_back(k);
  const Index n = A.rows(), count = static_cast<Index>(found.size());
  part.A = MatrixXd::Zero(count, count);
  part.left.resize(count, n);
  part.right.resize(n, count);
  for (Index i = 0; i < count; ++i) {
    const Index k = found[static_cast<std::size_t>(i)];
    const std::complex<double> pole = all.values[k];
    part.A(i, i) = pole.real();
    part.right.col(i) = all.right.col(k).real();
    part.left.row(i) = all.left.row(k).real();
    if (pole.imag() == 0.0) continue;
    // v = a + i b with its conjugate: A (a, b) = (a, b) [Re λ, Im λ; −Im λ, Re λ]
    part.right.col(i + 1) = all.right.col(k).imag();
    part.left.row(i) *= 2.0;
    part.left.row(i + 1) = -2.0 * all.left.row(k).imag();
    part.A(i + 1, i + 1) = pole.real();
    part.A(i, i + 1) = pole.imag();
    part.A(i + 1, i) = -pole.imag();
    ++i;
  }
  return part;
}

/// Magnitudes of inputs and outputs for which every entry of the response is 1 or less in the norm
/// of the impulse response, and one of each row and column is about 1.
struct Scales {
  VectorXd outputs{}, inputs{};
};

Scales scales_of(const MatrixXd& C, const MatrixXd& B, const Lyapunov& controllability) {
  MatrixXd sizes(C.rows(), B.cols());
  for (Index j = 0; j < B.cols(); ++j) {
    const MatrixXd of_input = controllability.solve(B.col(j));
    for (Index i = 0; i < C.rows(); ++i)
      sizes(i, j) = std::sqrt(std::max(0.0, (C.row(i) * of_input * C.row(i).transpose()).value()));
  }
  const auto or_one = [](double size) { return size > 0.0 ? size : 1.0; };
  Scales scales{VectorXd::Ones(C.rows()), VectorXd::Ones(B.cols())};
  constexpr int sweeps = 4;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (Index i = 0; i < C.rows(); ++i)
      scales.outputs[i] = or_one(sizes.row(i).cwiseQuotient(scales.inputs.transpose()).maxCoeff());
    for (Index j = 0; j < B.cols(); ++j)
      scales.inputs[j] = or_one(sizes.col(j).cwiseQuotient(scales.outputs).maxCoeff());
  }
  return scales;
}

std::vector<double> list(const VectorXd& numbers) { return {numbers.begin(), numbers.end()}; }

struct Part {
  MatrixXd A{}, B{}, C{};
  Reduction reduction{};
};

/// The stable part, its states still among n: the others decay and are neither driven nor seen.
Part without(const Unstable& part, const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
  const Index n = A.rows();
  const MatrixXd others = part.right * part.left;
  const MatrixXd own = MatrixXd::Identity(n, n) - others;
  return {own * A * own - part.largest * others, own * B, C * own, {}};
}

/// Of at most `states`, fewer where the rest does not act at all.
Part truncated(const Part& system, Index states) {
  const Index n = system.A.rows();
  const Lyapunov controllability(system.A), observability(system.A.transpose());
  const auto scales = scales_of(system.C, system.B, controllability);
  // A response of size s_i q_j is 1 here.
  const MatrixXd P =
      square_root(controllability.solve(system.B * scales.inputs.cwiseInverse().asDiagonal()));
  const MatrixXd Q = square_root(
      observability.solve(system.C.transpose() * scales.outputs.cwiseInverse().asDiagonal()));
  const auto hankel = numerics::singular_values(Q.transpose() * P);
  const double noise = static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  Index kept = 0;
  while (kept < states && hankel.s[kept] > noise * hankel.s[0]) ++kept;
  const VectorXd root = hankel.s.head(kept).cwiseSqrt().cwiseInverse();
  const MatrixXd right = P * hankel.V.leftCols(kept) * root.asDiagonal();
  const MatrixXd left = root.asDiagonal() * hankel.U.leftCols(kept).transpose() * Q.transpose();
  return {left * system.A * right,
          left * system.B,
          system.C * right,
          {.from = static_cast<int>(n),
           .bound = 2.0 * hankel.s.tail(n - kept).sum() + noise * hankel.s[0],
           .hankel = list(hankel.s),
           .output_scales = list(scales.outputs),
           .input_scales = list(scales.inputs)}};
}

}  // namespace

StateSpace reduced(const StateSpace& system, int states) {
  const Index n = system.A.rows();
  if (states < 1 || states > n)
    base::refuse(fmt::format("--reduce {}", states),
                 fmt::format("the system has {} states, expected 1 to {}", n, n));
  if (system.sample_time > 0.0)
    throw std::invalid_argument("reduced: the system is sampled, expected a continuous one");
  const VectorXd d = numerics::balancing(system.A);
  const MatrixXd A = d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal();
  const MatrixXd B = d.cwiseInverse().asDiagonal() * system.B, C = system.C * d.asDiagonal();
  const auto kept_whole = unstable_part(A);
  const Index apart = kept_whole.A.rows();
  if (apart >= states)
    base::refuse(
        fmt::format("--reduce {}", states),
        fmt::format("the system has {} poles that are not in the left half-plane; they are "
                    "kept whole, so expected {} to {} states",
                    apart, apart + 1, n));
  const auto stable = truncated(without(kept_whole, A, B, C), states - apart);
  const Index kept = stable.A.rows();
  StateSpace result = system;
  result.A = MatrixXd::Zero(kept + apart, kept + apart);
  result.A.topLeftCorner(kept, kept) = stable.A;
  result.A.bottomRightCorner(apart, apart) = kept_whole.A;
  result.B.resize(kept + apart, B.cols());
  result.B << stable.B, kept_whole.left * B;
  result.C.resize(C.rows(), kept + apart);
  result.C << stable.C, C * kept_whole.right;
  result.states.clear();
  for (Index k = 0; k < kept; ++k)
    result.states.push_back({fmt::format("balanced{}", k + 1), "1", 0.0});
  for (Index k = 0; k < apart; ++k)
    result.states.push_back({fmt::format("unstable{}", k + 1), "1", 0.0});
  result.reduction = stable.reduction;
  return result;
}

}  // namespace hydrapod::exchange
