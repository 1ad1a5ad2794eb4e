/// Values per line: a vector, of which copies and parts take no memory until they are changed.

#include "hydrapod/data/frequency_response.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace hydrapod::data {
namespace {

PerLine<int> odd_numbers() { return std::vector<int>{3, 5, 7, 11, 13}; }

std::vector<int> list(const PerLine<int>& values) { return {values.begin(), values.end()}; }

TEST(PerLine, CopiesShareUntilOneIsChanged) {
  const PerLine<int> first = odd_numbers();
  PerLine<int> second = first;
  EXPECT_EQ(std::as_const(second).data(), first.data());
  second[1] = 17;
  EXPECT_NE(std::as_const(second).data(), first.data());
  EXPECT_EQ(list(first), (std::vector{3, 5, 7, 11, 13}));
  EXPECT_EQ(list(second), (std::vector{3, 17, 7, 11, 13}));
}

TEST(PerLine, WhoIsAloneIsChangedInPlace) {
  PerLine<int> values = odd_numbers();
  const int* const place = std::as_const(values).data();
  values[4] = 2;
  for (int& x : values) x *= 10;
  EXPECT_EQ(std::as_const(values).data(), place);
  EXPECT_EQ(list(values), (std::vector{30, 50, 70, 110, 20}));
}

TEST(PerLine, PartsShareAndAreChangedAlone) {
  const PerLine<int> all = odd_numbers();
  PerLine<int> part = all.part(1, 3);
  EXPECT_EQ(std::as_const(part).data(), all.data() + 1);
  EXPECT_EQ(list(part), (std::vector{5, 7, 11}));
  EXPECT_EQ(list(part.part(2, 1)), std::vector{11});
  EXPECT_EQ(std::as_const(part).back(), 11);
  part.push_back(23);
  part.front() = 1;
  EXPECT_EQ(list(part), (std::vector{1, 7, 11, 23}));
  EXPECT_EQ(list(all), (std::vector{3, 5, 7, 11, 13}));
}

TEST(PerLine, APartOutlivesTheWhole) {
  PerLine<int> part;
  {
    const PerLine<int> all = odd_numbers();
    part = all.part(3, 2);
  }
  part[0] = -1;
  EXPECT_EQ(list(part), (std::vector{-1, 13}));
}

TEST(PerLine, IsAVector) {
  PerLine<Eigen::MatrixXd> matrices;
  EXPECT_TRUE(matrices.empty());
  matrices.reserve(2);
  matrices.emplace_back(Eigen::MatrixXd::Constant(2, 1, 4.5));
  matrices.push_back(Eigen::MatrixXd::Zero(1, 2));
  EXPECT_EQ(matrices.size(), 2U);
  const auto same = matrices;
  EXPECT_EQ(same, matrices);
  matrices.resize(3);
  EXPECT_EQ(matrices.size(), 3U);
  EXPECT_EQ(matrices[2].size(), 0);
  EXPECT_FALSE(same == matrices);
  matrices.clear();
  EXPECT_TRUE(matrices.empty());
  EXPECT_EQ(same.size(), 2U);
  matrices.assign(2, Eigen::MatrixXd::Identity(1, 1));
  EXPECT_EQ(matrices[1](0, 0), 1.0);
  const auto moved = std::move(matrices);
  EXPECT_EQ(moved.size(), 2U);
  EXPECT_TRUE(matrices.empty());  // NOLINT(bugprone-use-after-move): it is empty, as promised
}

}  // namespace
}  // namespace hydrapod::data
