/// Which poles of a table grow, where the sampled loop decides.

#include <gtest/gtest.h>

#include <vector>

#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::test {
namespace {

/// Two equal poles of the approximation are two poles; the exact ones may lie on the other side.
TEST(Growing, ArePolesOfTheSampledLoop) {
  simulation::SystemPoles poles;
  poles.poles = {
      {.pole = {0.3, 0.0}}, {.pole = {-0.1, 7.1}}, {.pole = {-0.1, 7.1}}, {.pole = {-2.0, 9.3}}};
  const auto marked = [&] {
    mark_growing(poles);
    std::vector<bool> stable;
    for (const auto& pole : poles.poles) stable.push_back(pole.stable);
    return stable;
  };
  EXPECT_EQ(marked(), (std::vector{false, true, true, true}));
  poles.sampled = {{0.2, 7.2}, {0.1, 7.2}, {-0.4, 0.0}, {-2.1, 9.1}};
  EXPECT_EQ(marked(), (std::vector{true, false, false, true}));
  poles.poles.clear();
  EXPECT_TRUE(marked().empty());
}

}  // namespace
}  // namespace hydrapod::test
