/// Pairs of two lists of modes.

#include <gmock/gmock.h>

#include <cmath>

#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::observation {
namespace {

std::complex<double> pole(double omega, double zeta) {
  return omega * std::complex<double>(-zeta, std::sqrt(1.0 - zeta * zeta));
}

/// Three orthogonal shapes on three outputs.
ModeList three(double first, double second, double third) {
  return {{pole(first, 0.013), pole(second, 0.021), pole(third, 0.017)},
          Eigen::MatrixXcd::Identity(3, 3)};
}

TEST(PairLists, ModesThatPassEachOtherAreFollowedByTheirShape) {
  const auto before = three(31.7, 36.1, 71.3);
  auto after = three(37.3, 33.9, 71.3);  // the first two have changed places
  std::swap(after.poles[0], after.poles[1]);
  after.shapes.col(0).swap(after.shapes.col(1));
  const auto pairs = pair_lists(before, after);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0].second, 1);
  EXPECT_EQ(pairs[1].second, 0);
  EXPECT_EQ(pairs[2].second, 2);
  for (const auto& pair : pairs) EXPECT_NEAR(*pair.mac, 1.0, 1e-12);
}

TEST(PairLists, AnyBasisOfARepeatedModeIsTheSame) {
  const double angle = 0.61;
  auto before = three(31.7, 31.7, 71.3), after = three(30.2, 30.2, 71.3);
  before.poles[1] = before.poles[0];
  after.poles[1] = after.poles[0];
  after.shapes.topLeftCorner(2, 2) << std::cos(angle), -std::sin(angle), std::sin(angle),
      std::cos(angle);
  for (const auto& pairs : {pair_lists(before, after), pair_lists(after, before)}) {
    ASSERT_EQ(pairs.size(), 3U);
    for (const auto& pair : pairs) EXPECT_NEAR(*pair.mac, 1.0, 1e-9);
  }
  after.poles[1] = pole(33.0, 0.021);  // no longer one group, but `before` still is
  EXPECT_NEAR(*pair_lists(before, after).front().mac, 1.0, 1e-9);
}

TEST(PairLists, AModeOfAnotherShapeOrFarAwayHasNoPartner) {
  const auto before = three(31.7, 36.1, 71.3);
  auto after = three(31.7, 36.1, 171.3);
  after.shapes.col(0) << 0.3, 0.2, 0.93;  // MAC 0.09 with the first
  const auto pairs = pair_lists(before, after);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].first, 1);
  EXPECT_EQ(pairs[0].second, 1);
}

TEST(PairLists, WithoutShapesFrequenciesDecide) {
  auto before = three(31.7, 36.1, 71.3), after = three(30.9, 37.0, 72.0);
  before.shapes.resize(0, 0);
  after.shapes.resize(0, 0);
  const auto pairs = pair_lists(before, after);
  ASSERT_EQ(pairs.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(pairs[static_cast<std::size_t>(k)].second, k);
    EXPECT_FALSE(pairs[static_cast<std::size_t>(k)].mac);
  }
}

TEST(PairLists, ShapesOfDifferentOutputsAreRefused) {
  auto before = three(31.7, 36.1, 71.3), after = before;
  after.shapes.conservativeResize(2, 3);
  EXPECT_THROW(pair_lists(before, after), std::invalid_argument);
  after.shapes.conservativeResize(3, 2);
  EXPECT_THROW(pair_lists(before, after), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::observation
