/// Which poles of a table grow, where the sampled loop decides.

#include <gtest/gtest.h>

#include <vector>

#include "hydrapod/report/model_results.hpp"

namespace hydrapod::test {
namespace {

/// Two equal poles of the approximation are two poles; the exact ones may lie on the other side.
TEST(Growing, ArePolesOfTheSampledLoop) {
  simulation::SystemPoles poles;
  poles.poles = {
      {.pole = {0.3, 0.0}}, {.pole = {-0.1, 7.1}}, {.pole = {-0.1, 7.1}}, {.pole = {-2.0, 9.3}}};
  EXPECT_EQ(report::growing(poles), (std::vector{true, false, false, false}));
  poles.sampled = {{0.2, 7.2}, {0.1, 7.2}, {-0.4, 0.0}, {-2.1, 9.1}};
  EXPECT_EQ(report::growing(poles), (std::vector{false, true, true, false}));
  poles.poles.clear();
  EXPECT_TRUE(report::growing(poles).empty());
}

}  // namespace
}  // namespace hydrapod::test
