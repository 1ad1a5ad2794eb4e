#pragma once
/// Dense linear algebra of dynamic size, compiled once.
///
/// Eigen's decompositions take expressions, and every file that hands one over compiles the
/// algorithm anew: 5 to 20 s a file. These take and give plain matrices.

#include <Eigen/Core>

namespace hydrapod::numerics {

/// A V = V diag(values) of a real matrix; complex values come as pairs of conjugates, vectors with
/// length 1.
struct EigenPairs {
  Eigen::VectorXcd values{};
  Eigen::MatrixXcd vectors{};
  bool converged = false;  ///< else, and where A is not finite, values and vectors are empty
};
EigenPairs eigen_pairs(const Eigen::MatrixXd& A);

/// The same with the inverse of the vectors' matrix: A = right diag(values) left. States that only
/// a few others act on, as those of filters and valves in front of a machine, are solved apart:
///
///     A = [A₁ B; 0 A₂],   right = [V₁ V₁Z; 0 V₂],   left = [V₁⁻¹ −Z V₂⁻¹; 0 V₂⁻¹],
///     Z_jk = (V₁⁻¹ B V₂)_jk / (μ_k − λ_j)
struct EigenSystem {
  Eigen::VectorXcd values{};  ///< conjugates are neighbours, Im > 0 first
  Eigen::MatrixXcd right{}, left{};
  bool converged = false;  ///< else, and where A is not finite, all is empty
};
EigenSystem eigen_system(const Eigen::MatrixXd& A);

/// Scales d, powers of two, for which rows and columns of D⁻¹ A D have like norms (Osborne, J. ACM 7
/// (1960) 338). Eigenvalues of a matrix of states in SI units, 1e7 Pa beside 1e-5 m, keep some six
/// more digits.
Eigen::VectorXd balancing(const Eigen::MatrixXd& A);

/// The eigenvalues alone; empty where A is not finite or the iteration did not converge.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// A⁻¹ B, by elimination with partial pivoting. Whether A can be inverted is not checked.
Eigen::MatrixXcd solve(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B);
Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& A);

/// A B, and C += Aᵀ B: every shape of a product that a file writes is compiled there.
Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& A,
                      const Eigen::Ref<const Eigen::MatrixXd>& B);
void add_transposed_times(const Eigen::Ref<const Eigen::MatrixXd>& A,
                          const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::MatrixXd& C);

/// N⁻¹ B of a symmetric positive N by LDLᵀ. N is scaled to a diagonal of 1, to which 1e-14 is
/// added: rows may be of very different size, and directions that N hardly determines stay finite.
Eigen::MatrixXd solve_positive(const Eigen::MatrixXd& N, const Eigen::MatrixXd& B);
Eigen::VectorXd solve_positive(const Eigen::MatrixXd& N, const Eigen::VectorXd& b);

/// N⁻¹ of such a matrix. Where an eigenvalue of the scaled matrix is below 1e-13 of the largest,
/// its direction is left out: the inverse has nothing there instead of nearly infinity.
Eigen::MatrixXd inverse_positive(const Eigen::MatrixXd& N);

/// L⁻¹ of A = L Lᴴ, A Hermitian and positive, L lower triangular.
Eigen::MatrixXcd inverse_factor(const Eigen::MatrixXcd& A);

/// X with the least ‖A X − B‖, by QR with column pivoting.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// A = U diag(s) Vᵀ with as many columns as A has singular values; s descends.
struct SingularValues {
  Eigen::MatrixXd U{}, V{};
  Eigen::VectorXd s{};
};
SingularValues singular_values(const Eigen::MatrixXd& A);

}  // namespace hydrapod::numerics
