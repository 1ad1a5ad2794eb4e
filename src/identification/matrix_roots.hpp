#pragma once
/// Roots of matrix polynomials Q(w) = I wⁿ + A_1 wⁿ⁻¹ + … + A_n. Private to the module.

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace hydrapod::identification {

/// A root with Q⁻¹ ≈ right leftᵀ / (w − value) next to it; (right, w right, …, wⁿ⁻¹ right) has
/// length 1, as an eigenvector of the companion matrix.
struct MatrixRoot {
  std::complex<double> value{};
  Eigen::VectorXcd right{}, left{};
};

/// Those with Im w < 0, in any order; conjugates and real roots are left out. Newton's iteration on
/// det Q for all roots at once, which keeps them apart, in less time than the eigenvalues of
/// the companion matrix take. The result is what these would give to rounding: nothing is returned
/// where an iteration does not end, or where Σ w or Σ w² over all roots is not that of the
/// coefficients. Source: D. A. Bini, V. Noferini, Linear Algebra Appl. 439 (2013) 1130.
std::optional<std::vector<MatrixRoot>> iterated_roots(const std::vector<Eigen::MatrixXd>& A);

/// The same from the eigenvalues of the companion matrix; empty where these do not converge.
std::vector<MatrixRoot> companion_roots(const std::vector<Eigen::MatrixXd>& A);

}  // namespace hydrapod::identification
