#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "hydrapod/numerics/dense.hpp"
#include "support/random.hpp"

namespace hydrapod::numerics {
namespace {

double least_of_all(const Eigen::MatrixXd& cost) {
  std::vector<int> columns(static_cast<std::size_t>(cost.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  double least = 1e300;
  do {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
      sum += cost(i, columns[static_cast<std::size_t>(i)]);
    least = std::min(least, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return least;
}

TEST(Assignment, IsAsGoodAsTheBestOfAllPermutations) {
  test::Random random(99);
  for (int trial = 0; trial < 40; ++trial) {
    const int rows = 1 + static_cast<int>(5.0 * random.uniform());
    const int columns = rows + static_cast<int>(3.0 * random.uniform());
    Eigen::MatrixXd cost(rows, columns);
    for (auto& c : cost.reshaped()) c = random.uniform(-2.0, 7.0);
    const auto chosen = assign(cost);
    double sum = 0.0;
    std::vector<int> taken = chosen;
    for (int i = 0; i < rows; ++i) sum += cost(i, chosen[i]);
    std::sort(taken.begin(), taken.end());
    EXPECT_EQ(std::adjacent_find(taken.begin(), taken.end()), taken.end());
    EXPECT_NEAR(sum, least_of_all(cost), 1e-12);
  }
}

TEST(Assignment, RefusesMoreRowsThanColumns) {
  EXPECT_THROW(assign(Eigen::MatrixXd::Zero(3, 2)), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::numerics
