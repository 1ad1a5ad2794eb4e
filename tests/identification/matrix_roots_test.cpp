/// Roots of matrix polynomials: the polynomial is singular there, and both ways find the same.

#include "identification/matrix_roots.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "support/random.hpp"

namespace hydrapod::identification {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

std::vector<MatrixXd> polynomial(Index side, int degree, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<MatrixXd> A;
  for (int k = 0; k < degree; ++k) {
    A.emplace_back(side, side);
    for (double& a : A.back().reshaped()) a = random.uniform(-1.3, 1.1);
  }
  return A;
}

MatrixXcd value(const std::vector<MatrixXd>& A, Complex w) {
  MatrixXcd Q = MatrixXcd::Identity(A[0].rows(), A[0].rows());
  for (const auto& a : A) Q = Q * w + a;
  return Q;
}

/// det Q by w: real where w is, so that its roots come as conjugates.
void sort(std::vector<MatrixRoot>& roots) {
  std::ranges::sort(roots, {}, [](const MatrixRoot& r) { return r.value.real(); });
}

TEST(MatrixRoots, AreThoseOfTheCompanionMatrix) {
  for (const Index side : {1, 2, 3, 6, 7})
    for (const int degree : {1, 2, 3, 9, 24}) {
      const auto A = polynomial(side, degree, static_cast<std::uint64_t>(100 * side + degree));
      auto iterated = iterated_roots(A);
      ASSERT_TRUE(iterated) << side << ' ' << degree;
      auto expected = companion_roots(A);
      ASSERT_EQ(iterated->size(), expected.size()) << side << ' ' << degree;
      sort(*iterated);
      sort(expected);
      for (std::size_t r = 0; r < expected.size(); ++r) {
        const auto &a = (*iterated)[r], &b = expected[r];
        EXPECT_LT(std::abs(a.value - b.value), 1e-10) << side << ' ' << degree;
        const MatrixXcd residue = b.right * b.left.transpose();
        EXPECT_LT((a.right * a.left.transpose() - residue).norm(), 1e-8 * residue.norm());
      }
    }
}

TEST(MatrixRoots, ResidueIsThatOfTheInverse) {
  const auto A = polynomial(3, 6, 4);
  const auto roots = iterated_roots(A);
  ASSERT_TRUE(roots);
  ASSERT_FALSE(roots->empty());
  for (const auto& root : *roots) {
    const Complex aside(1e-6, 2e-6);
    const MatrixXcd near = aside * value(A, root.value + aside).inverse();
    const MatrixXcd residue = root.right * root.left.transpose();
    EXPECT_LT((near - residue).norm(), 1e-3 * residue.norm());  // the other roots' share
    Eigen::VectorXcd powers(6);
    for (int k = 0; k < 6; ++k) powers[k] = std::pow(root.value, k);
    EXPECT_NEAR(powers.norm() * root.right.norm(), 1.0, 1e-12);
  }
}

/// Two independent copies of one scalar polynomial, seen in other coordinates: every root is
/// double. Whatever comes out is right, and each way says when it is not.
TEST(MatrixRoots, DoubleRootsAreFoundTwiceOrNotAtAll) {
  const auto scalar = polynomial(1, 4, 9);
  const MatrixXd T = (MatrixXd(2, 2) << 1.0, 0.37, -0.61, 1.4).finished();
  std::vector<MatrixXd> A;
  for (const auto& a : scalar) A.emplace_back(a(0, 0) * (T * T.inverse()));
  const auto expected = companion_roots(scalar);
  for (const auto& roots : {iterated_roots(A), std::optional(companion_roots(A))}) {
    if (!roots) continue;
    EXPECT_EQ(roots->size(), 2 * expected.size());
    for (const auto& one : expected)
      EXPECT_EQ(std::ranges::count_if(
                    *roots, [&](const auto& r) { return std::abs(r.value - one.value) < 1e-6; }),
                2);
  }
}

TEST(MatrixRoots, RealRootsAreLeftOut) {
  const MatrixXd one = MatrixXd::Identity(2, 2);
  // (w − 2)(w + 0.7) and (w − 0.3)(w + 1.1)
  const MatrixXd A1 = Eigen::Vector2d(-1.3, 0.8).asDiagonal(),
                 A2 = Eigen::Vector2d(-1.4, -0.33).asDiagonal();
  const auto roots = iterated_roots({A1 * one, A2 * one});
  ASSERT_TRUE(roots);
  EXPECT_TRUE(roots->empty());
}

}  // namespace
}  // namespace hydrapod::identification
