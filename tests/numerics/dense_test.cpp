/// Decompositions against what defines them, and against matrices whose spectrum is known.

#include "hydrapod/numerics/dense.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <limits>

#include "support/random.hpp"

namespace hydrapod::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

MatrixXd random_matrix(test::Random& random, Index rows, Index columns) {
  return MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform(-1.3, 1.7); });
}

/// Units of a billion to one in the rows.
TEST(Dense, PositiveSystemsMayBeScaledBadly) {
  test::Random random(19);
  const MatrixXd half = random_matrix(random, 9, 5);
  Eigen::VectorXd scale(5), x(5);
  scale << 3e-5, 7e4, 1.0, 2e2, 5e-3;
  x << 1.7, -0.6, 2.3, 0.9, -1.1;
  const MatrixXd N = scale.asDiagonal() * (half.transpose() * half) * scale.asDiagonal();
  const Eigen::VectorXd wanted = x.cwiseQuotient(scale), b = N * wanted;
  const Eigen::VectorXd found = solve_positive(N, b);
  EXPECT_LT((found - wanted).cwiseQuotient(wanted).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Dense, EigenPairsAreThoseOfTheMatrix) {
  test::Random random(71);
  const MatrixXd A = random_matrix(random, 17, 17);
  const auto pairs = eigen_pairs(A);
  ASSERT_TRUE(pairs.converged);
  const MatrixXcd lack =
      A.cast<Complex>() * pairs.vectors - pairs.vectors * pairs.values.asDiagonal();
  EXPECT_LT(lack.norm(), 1e-12 * A.norm());
  EXPECT_NEAR((pairs.vectors.colwise().norm().array() - 1.0).abs().maxCoeff(), 0.0, 1e-14);
  EXPECT_LT((eigenvalues(A) - pairs.values).norm(), 1e-12 * A.norm());
}

/// As it is, and with two pairs of states that no other acts on, at any place.
TEST(Dense, EigenSystemIsThatOfTheMatrix) {
  test::Random random(79);
  for (const bool cascade : {false, true}) {
    MatrixXd A = random_matrix(random, 29, 29);
    for (const Index first : {3, 17}) {
      if (!cascade) continue;
      A.middleRows(first, 2).setZero();
      A.block(first, first, 2, 2) << 0.0, 1.0, -12.1, -0.37;
    }
    const auto system = eigen_system(A);
    ASSERT_TRUE(system.converged);
    const MatrixXcd& V = system.right;
    EXPECT_LT((A.cast<Complex>() * V - V * system.values.asDiagonal()).norm(),
              1e-10 * A.norm() * V.norm());
    EXPECT_LT((system.left * V - MatrixXcd::Identity(29, 29)).norm(), 1e-10);
    for (Index k = 0; k < 29; ++k)
      if (system.values[k].imag() > 0.0) {
        EXPECT_LT(std::abs(system.values[k + 1] - std::conj(system.values[k])), 1e-13);
        EXPECT_LT((V.col(k + 1) - V.col(k).conjugate()).norm(), 1e-12 * V.col(k).norm());
      }
  }
}

TEST(Dense, EigenvaluesOfAKnownSpectrum) {
  // x˙˙ + 0.37 x˙ + 12.1 x = 0
  MatrixXd A(2, 2);
  A << 0.0, 1.0, -12.1, -0.37;
  const auto values = eigenvalues(A);
  ASSERT_EQ(values.size(), 2);
  const double imaginary = std::sqrt(12.1 - 0.185 * 0.185);
  for (const Complex value : values) {
    EXPECT_NEAR(value.real(), -0.185, 1e-14);
    EXPECT_NEAR(std::abs(value.imag()), imaginary, 1e-14);
  }
}

TEST(Dense, WhatIsNotFiniteDoesNotConverge) {
  MatrixXd A = MatrixXd::Identity(3, 3);
  A(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(eigen_pairs(A).converged);
  EXPECT_FALSE(eigen_system(A).converged);
  EXPECT_EQ(eigenvalues(A).size(), 0);
}

TEST(Dense, SolvesAndInverts) {
  test::Random random(72);
  MatrixXcd A(9, 9);
  A.real() = random_matrix(random, 9, 9);
  A.imag() = random_matrix(random, 9, 9);
  MatrixXcd B(9, 4);
  B.real() = random_matrix(random, 9, 4);
  B.imag() = random_matrix(random, 9, 4);
  EXPECT_LT((A * solve(A, B) - B).norm(), 1e-12 * B.norm());
  EXPECT_LT((A * inverse(A) - MatrixXcd::Identity(9, 9)).norm(), 1e-12);
}

TEST(Dense, LeastSquaresLeaveWhatIsOrthogonal) {
  test::Random random(73);
  const MatrixXd A = random_matrix(random, 23, 7), B = random_matrix(random, 23, 3);
  const MatrixXd rest = B - A * least_squares(A, B);
  EXPECT_GT(rest.norm(), 0.1 * B.norm());
  EXPECT_LT((A.transpose() * rest).norm(), 1e-12 * A.norm() * B.norm());
}

TEST(Dense, SingularValuesBuildTheMatrix) {
  test::Random random(74);
  const MatrixXd A = random_matrix(random, 31, 12);
  const auto [U, V, s] = singular_values(A);
  ASSERT_EQ(s.size(), 12);
  EXPECT_LT((U * s.asDiagonal() * V.transpose() - A).norm(), 1e-12 * A.norm());
  EXPECT_LT((U.transpose() * U - MatrixXd::Identity(12, 12)).norm(), 1e-12);
  for (Index k = 1; k < s.size(); ++k) EXPECT_LE(s[k], s[k - 1]);
  EXPECT_NEAR(s.squaredNorm(), A.squaredNorm(), 1e-12 * A.squaredNorm());
}

}  // namespace
}  // namespace hydrapod::numerics
