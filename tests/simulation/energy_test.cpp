/// Energy in large free motions: kept without damping, accounted for with it.

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/free_flight.hpp"
#include "support/kinds.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using simulation::Method;

class FreeMotion : public testing::TestWithParam<AxesAndKind> {};

TEST_P(FreeMotion, KeepsItsEnergyAndTheLegsTheirLengths) {
  const auto [axes, kind] = GetParam();
  const FreeFlight flight(axes, kind);
  const double seconds = kind == ModelKind::full ? 0.4 : 4.0;  // piston rings are stiff
  const auto result =
      flight.run(seconds, {.relative_tolerance = 3e-13, .absolute_tolerance = 3e-13});
  EXPECT_LE(result.energy_drift, 1e-8);
  EXPECT_LE(result.kinematic_error, 1e-10);
  EXPECT_GE(result.largest_swing,
            kind == ModelKind::full ? 0.015 : 0.05);  // [m]: it is a large motion
  RecordProperty("energy_drift", std::to_string(1e12 * result.energy_drift) + "e-12");
}

INSTANTIATE_TEST_SUITE_P(, FreeMotion,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

TEST(FreeMotionByFixedSteps, TheDriftFallsWithTheOrderOfTheIntegrator) {
  const FreeFlight flight(model::FlexibleAxes::gimbal, ModelKind::guide);
  const auto drift = [&](double step) {
    return flight.run(1.2, {.method = Method::fixed, .fixed_step = step}, 4e-3).energy_drift;
  };
  const double coarse = drift(2e-3), fine = drift(1e-3), finest = drift(5e-4);
  EXPECT_LT(coarse, 1e-2);
  // Order 4; the energy error of a Runge–Kutta method of order 4 may be of order 5.
  EXPECT_GT(coarse / fine, 0.8 * 16.0);
  EXPECT_GT(fine / finest, 0.8 * 16.0);
  EXPECT_LT(fine / finest, 1.2 * 32.0);
}

TEST(DampedMotion, WhatIsLostWasDissipated) {
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal}) {
    FreeFlight flight(axes, ModelKind::full);
    flight.damp();
    const auto result =
        flight.run(2.0, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-12}, 2e-4);
    EXPECT_GT(result.lost, 0.05 * result.first_energy);
    EXPECT_NEAR(result.dissipated / result.lost, 1.0, 1e-8);
    EXPECT_GT(result.smallest_dissipation, 0.0);
  }
}

}  // namespace
}  // namespace hydrapod::test
