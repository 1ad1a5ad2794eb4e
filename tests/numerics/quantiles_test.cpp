/// Quantiles against printed tables and closed forms.

#include "hydrapod/numerics/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hydrapod::numerics {
namespace {

constexpr double rounding = 1e-13;

TEST(Quantiles, UpperMedianIsTheHigherOfTheTwoInTheMiddle) {
  EXPECT_EQ(upper_median({7.0, -1.5, 3.0, 2.0}), 3.0);
  EXPECT_EQ(upper_median({7.0, -1.5, 3.0}), 3.0);
}

TEST(Quantiles, StudentAgreesWithClosedForms) {
  EXPECT_NEAR(student_half_width(1), std::tan(0.475 * std::numbers::pi), 20.0 * rounding);
  EXPECT_NEAR(student_half_width(2), 0.95 * std::sqrt(2.0 / (4.0 * 0.975 * 0.025)), 10 * rounding);
}

TEST(Quantiles, StudentAgreesWithTheTable) {
  constexpr double digit = 5.1e-5;  // the table has four digits
  EXPECT_NEAR(student_half_width(3), 3.1824, digit);
  EXPECT_NEAR(student_half_width(4), 2.7764, digit);
  EXPECT_NEAR(student_half_width(10), 2.2281, digit);
  EXPECT_NEAR(student_half_width(30), 2.0423, digit);
}

TEST(Quantiles, StudentOfManyDegreesIsNormal) {
  EXPECT_EQ(student_half_width(0), normal_half_width);
  EXPECT_NEAR(std::erf(normal_half_width / std::numbers::sqrt2), 0.95, rounding);
  EXPECT_NEAR(student_half_width(100'000'000), normal_half_width, 1e-7);
}

TEST(Quantiles, ChiSquaredOfOneDegreeIsTheSquareOfTheNormal) {
  EXPECT_NEAR(chi_squared_quantile(0.95, 1), normal_half_width * normal_half_width, 10 * rounding);
  EXPECT_NEAR(chi_squared_quantile(0.37, 2), -2.0 * std::log(0.63), 10 * rounding);
}

TEST(Quantiles, FisherOfTwoNumeratorDegreesHasAClosedForm) {
  // F(2, 2n): n ((1 - p)^(-1/n) - 1)
  for (const double n : {0.7, 3.0, 41.0})
    for (const double p : {0.05, 0.5, 0.95})
      EXPECT_NEAR(fisher_quantile(p, 2.0, 2.0 * n) / (n * (std::pow(1.0 - p, -1.0 / n) - 1.0)), 1.0,
                  1e-11);
}

}  // namespace
}  // namespace hydrapod::numerics
