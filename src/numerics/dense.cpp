#include "numerics/dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace hydrapod::numerics {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

EigenPairs eigen_pairs(const MatrixXd& A) {
  if (!A.allFinite()) return {};  // Eigen may call it converged
  const Eigen::EigenSolver<MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) return {};
  return {solver.eigenvalues(), solver.eigenvectors(), true};
}

Eigen::VectorXcd eigenvalues(const MatrixXd& A) {
  if (!A.allFinite()) return {};
  const Eigen::EigenSolver<MatrixXd> solver(A, false);
  if (solver.info() != Eigen::Success) return {};
  return solver.eigenvalues();
}

MatrixXcd solve(const MatrixXcd& A, const MatrixXcd& B) {
  return Eigen::PartialPivLU<MatrixXcd>(A).solve(B);
}

MatrixXcd inverse(const MatrixXcd& A) { return Eigen::PartialPivLU<MatrixXcd>(A).inverse(); }

MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(B);
}

SingularValues singular_values(const MatrixXd& A) {
  const Eigen::BDCSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

}  // namespace hydrapod::numerics
