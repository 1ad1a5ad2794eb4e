#include "hydrapod/numerics/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <vector>

namespace hydrapod::numerics {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

EigenPairs eigen_pairs(const MatrixXd& A) {
  if (!A.allFinite()) return {};  // Eigen may call it converged
  const Eigen::EigenSolver<MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) return {};
  return {solver.eigenvalues(), solver.eigenvectors(), true};
}

namespace {

using Indices = std::vector<Eigen::Index>;

/// States that act on state i, itself among them; more than `most` + 1 are not looked for.
Indices acting_on(const MatrixXd& A, Eigen::Index i, std::size_t most) {
  Indices found{i};
  for (std::size_t next = 0; next < found.size() && found.size() <= most; ++next)
    for (Eigen::Index j = 0; j < A.cols(); ++j)
      if (A(found[next], j) != 0.0 && std::ranges::count(found, j) == 0) found.push_back(j);
  return found;
}

EigenSystem plain_system(const MatrixXd& A) {
  auto pairs = eigen_pairs(A);
  if (!pairs.converged) return {};
  MatrixXcd left = inverse(pairs.vectors);
  return {std::move(pairs.values), std::move(pairs.vectors), std::move(left), true};
}

}  // namespace

EigenSystem eigen_system(const MatrixXd& A) {
  if (!A.allFinite()) return {};
  const auto n = A.rows();
  const auto few = static_cast<std::size_t>(n) / 8;
  Indices first, second;
  for (Eigen::Index i = 0; i < n; ++i)
    (acting_on(A, i, few).size() <= few ? second : first).push_back(i);
  if (second.empty() || first.empty()) return plain_system(A);
  const auto one = plain_system(A(first, first)), two = plain_system(A(second, second));
  if (!one.converged || !two.converged) return {};
  MatrixXcd Z = one.left * A(first, second).cast<std::complex<double>>() * two.right;
  const double coincide =
      1e-10 * std::max(one.values.cwiseAbs().maxCoeff(), two.values.cwiseAbs().maxCoeff());
  for (Eigen::Index k = 0; k < Z.cols(); ++k)
    for (Eigen::Index j = 0; j < Z.rows(); ++j) {
      const auto apart = two.values[k] - one.values[j];
      if (std::abs(apart) < coincide) return plain_system(A);
      Z(j, k) /= apart;
    }
  const auto n1 = one.values.size(), n2 = two.values.size();
  EigenSystem both{.converged = true};
  both.values.resize(n);
  both.values << one.values, two.values;
  both.right.setZero(n, n);
  both.left.setZero(n, n);
  both.right(first, Eigen::seqN(0, n1)) = one.right;
  both.right(first, Eigen::seqN(n1, n2)) = one.right * Z;
  both.right(second, Eigen::seqN(n1, n2)) = two.right;
  both.left(Eigen::seqN(0, n1), first) = one.left;
  both.left(Eigen::seqN(0, n1), second) = -Z * two.left;
  both.left(Eigen::seqN(n1, n2), second) = two.left;
  return both;
}

Eigen::VectorXcd eigenvalues(const MatrixXd& A) {
  if (!A.allFinite()) return {};
  const Eigen::EigenSolver<MatrixXd> solver(A, false);
  if (solver.info() != Eigen::Success) return {};
  return solver.eigenvalues();
}

MatrixXd times(const Eigen::Ref<const MatrixXd>& A, const Eigen::Ref<const MatrixXd>& B) {
  return A * B;
}

void add_transposed_times(const Eigen::Ref<const MatrixXd>& A, const Eigen::Ref<const MatrixXd>& B,
                          MatrixXd& C) {
  C.noalias() += A.transpose() * B;
}

MatrixXcd solve(const MatrixXcd& A, const MatrixXcd& B) {
  return Eigen::PartialPivLU<MatrixXcd>(A).solve(B);
}

MatrixXcd inverse(const MatrixXcd& A) { return Eigen::PartialPivLU<MatrixXcd>(A).inverse(); }

namespace {

/// One over the roots of the diagonal.
VectorXd to_unit_diagonal(const MatrixXd& N) {
  return N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
}

template <class Right>
Right solved_positive(const MatrixXd& N, const Right& B) {
  const VectorXd scale = to_unit_diagonal(N);
  MatrixXd scaled = scale.asDiagonal() * N * scale.asDiagonal();
  scaled.diagonal().array() += 1e-14;
  const Right right = scale.asDiagonal() * B;
  return scale.asDiagonal() * scaled.ldlt().solve(right);
}

}  // namespace

MatrixXd solve_positive(const MatrixXd& N, const MatrixXd& B) { return solved_positive(N, B); }
VectorXd solve_positive(const MatrixXd& N, const VectorXd& b) { return solved_positive(N, b); }

MatrixXd inverse_positive(const MatrixXd& N) {
  const VectorXd scale = to_unit_diagonal(N);
  const MatrixXd scaled = scale.asDiagonal() * N * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled);
  const double least = 1e-13 * solver.eigenvalues().maxCoeff();
  VectorXd inverted = solver.eigenvalues();
  for (double& value : inverted) value = value > least ? 1.0 / value : 0.0;
  const MatrixXd V = scale.asDiagonal() * solver.eigenvectors();
  return V * inverted.asDiagonal() * V.transpose();
}

MatrixXcd inverse_factor(const MatrixXcd& A) {
  const Eigen::LLT<MatrixXcd> factors(A);
  return factors.matrixL().solve(MatrixXcd::Identity(A.rows(), A.cols()));
}

MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(B);
}

SingularValues singular_values(const MatrixXd& A) {
  const Eigen::BDCSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

Eigen::VectorXd balancing(const Eigen::MatrixXd& A) {
  constexpr int sweeps = 50;
  Eigen::VectorXd d = Eigen::VectorXd::Ones(A.rows());
  Eigen::MatrixXd scaled = A.cwiseAbs();
  scaled.diagonal().setZero();
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    bool changed = false;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double column = scaled.col(i).sum(), row = scaled.row(i).sum();
      if (column == 0.0 || row == 0.0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (factor == 1.0) continue;
      changed = true;
      d[i] *= factor;
      scaled.col(i) *= factor;
      scaled.row(i) /= factor;
    }
    if (!changed) break;
  }
  return d;
}

}  // namespace hydrapod::numerics
