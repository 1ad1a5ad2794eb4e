/// Swings of the plant that last, with elastomers that soften, against the harmonic balance.

#include <gtest/gtest.h>

#include <cmath>

#include "support/sustained_swing.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::simulation {
namespace {

constexpr double swing_softening_time = 0.43;

/// Under a weight that its seals carry; no two legs are alike, so that x and y are apart.
model::Machine heavy_machine(bool bends) {
  auto machine = test::symmetric_machine(9.81);
  machine.damping.modal_ratio = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    leg.guide_sleeve.stiffness *= i < 2 ? 1.9 : 2.3 + 0.1 * static_cast<double>(i);
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.4,
                                  .loss_factor = 0.12,
                                  .frequency = 8.3,
                                  .softening = 0.37,
                                  .softening_amplitude = 1.7e-4,
                                  .softening_time = swing_softening_time};
    if (!bends) continue;
    leg.bending = model::LegBending::elastic;
    leg.rod.diameter = 0.036;
    leg.rod.wall = 0.009;
    leg.cylinder_case.diameter = 0.061;
    leg.cylinder_case.wall = 0.0047;
  }
  return machine;
}

/// The softening is built up from nothing by the swing itself.
void expect_harmonic_balance(const model::Machine& machine) {
  constexpr auto kind = ModelKind::guide;
  const std::vector<double> amplitudes{4e-5, 1.3e-4, 4.1e-4};
  const auto balance = [&](const std::vector<double>& at) {
    return modal::modes_at_amplitudes(machine, machine.neutral(), kind, at).front();
  };
  const auto curve = balance(amplitudes);
  for (const auto& point : curve.points) {
    ASSERT_TRUE(point.converged);
    SustainedSwing sustained(machine, kind, point);
    const auto found = sustained.swing(12.0 * swing_softening_time, 40);
    EXPECT_NEAR(found.amplitude, point.amplitude, 0.05 * point.amplitude);
    const auto there = balance({found.amplitude}).points.front();
    ASSERT_TRUE(there.converged);
    const double change = std::abs(there.omega - curve.omega);
    EXPECT_NEAR(found.omega, there.omega, 0.01 * change + 1e-4 * there.omega);
    EXPECT_NEAR(found.damping_ratio, there.damping_ratio, 0.01 * there.damping_ratio);
    testing::Test::RecordProperty("at " + std::to_string(1e6 * found.amplitude) + " um",
                                  std::to_string(there.omega) +
                                      " rad/s (small: " + std::to_string(curve.omega) +
                                      "), swings " + std::to_string(found.omega) + "; ratio " +
                                      std::to_string(there.damping_ratio) + ", swings " +
                                      std::to_string(found.damping_ratio));
  }
}

TEST(SwingsOfElastomers, HaveFrequencyAndLossOfTheHarmonicBalance) {
  expect_harmonic_balance(heavy_machine(false));
}

TEST(SwingsOfElastomers, HaveThemInSeriesWithRodsThatBend) {
  expect_harmonic_balance(heavy_machine(true));
}

}  // namespace
}  // namespace hydrapod::simulation
