/// Energy over one minute of large free motion.

#include <gtest/gtest.h>

#include "support/free_flight.hpp"
#include "support/kinds.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

class OneMinute : public testing::TestWithParam<AxesAndKind> {};

TEST_P(OneMinute, OfFreeMotionKeepsItsEnergy) {
  const auto [axes, kind] = GetParam();
  const FreeFlight flight(axes, kind);
  const double seconds = kind == ModelKind::full ? 6.0 : 60.0;  // piston rings are stiff
  const auto result =
      flight.run(seconds, {.relative_tolerance = 3e-13, .absolute_tolerance = 3e-13});
  EXPECT_LE(result.energy_drift, 1e-8);
  EXPECT_LE(result.kinematic_error, 1e-10);
  EXPECT_GE(result.largest_swing, 0.05);
  RecordProperty("energy_drift", std::to_string(1e12 * result.energy_drift) + "e-12");
}

INSTANTIATE_TEST_SUITE_P(, OneMinute,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
