/// Modes at amplitudes: limits in closed form. Against simulations: tests/simulation.

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

model::Machine guided_machine() {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.013;
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.gap = 1.7e-4;
    leg.guide_sleeve.guide_stiffness = 4.1e7;
  }
  return machine;
}

std::vector<modal::AmplitudeCurve> curves_of(const model::Machine& machine,
                                             std::vector<double> amplitudes,
                                             ModelKind kind = ModelKind::guide) {
  return modal::modes_at_amplitudes(machine, machine.neutral(), kind, amplitudes);
}

TEST(ModesAtAmplitudes, OfSmallMotionsAreTheLinearOnes) {
  const auto machine = guided_machine();
  const auto normal =
      modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
  const auto curves = curves_of(machine, {1e-7, 1e-5});
  ASSERT_GE(curves.size(), 6U);
  for (const auto& curve : curves) {
    ASSERT_EQ(curve.points.size(), 2U);
    for (const auto& point : curve.points) {
      ASSERT_TRUE(point.converged);
      EXPECT_EQ(point.legs_on_guide, 0);
      EXPECT_NEAR(point.omega, normal.omega(curve.mode), 1e-9 * point.omega);
      EXPECT_NEAR(point.damping_ratio, 0.013, 1e-9);
      EXPECT_NEAR(point.mac, 1.0, 1e-9);
    }
  }
}

/// Long swings lie on the guide for nearly the whole period: k_s + k_c.
TEST(ModesAtAmplitudes, OfLongSwingsApproachThoseOfAStiffGuide) {
  const auto machine = guided_machine();
  auto stiff = machine;
  for (auto& leg : stiff.legs) {
    leg.guide_sleeve.gap.reset();
    leg.guide_sleeve.stiffness += leg.guide_sleeve.guide_stiffness;
  }
  const auto modes_of = [](const model::Machine& of) {
    return modal::normal_modes(dynamics::linear_model(of, of.neutral(), ModelKind::guide));
  };
  const auto limit = modes_of(stiff), linear = modes_of(machine);
  const auto curves = curves_of(machine, {1e-4, 1e-3, 1e-2, 0.1, 1.0, 30.0});
  const auto& lowest = curves.front();
  ASSERT_EQ(lowest.points.size(), 6U);
  double before = linear.omega(lowest.mode);
  for (const auto& point : lowest.points) {
    ASSERT_TRUE(point.converged) << point.amplitude;
    EXPECT_GE(point.omega, before * (1.0 - 1e-9));
    before = point.omega;
  }
  const double whole = limit.omega(0) - linear.omega(lowest.mode);
  EXPECT_NEAR(before - linear.omega(lowest.mode), whole, 0.02 * whole);
  EXPECT_EQ(lowest.points.back().legs_on_guide, 6);
}

/// All springs of a machine with rigid legs soften alike: ω of the oil with bristles beside it.
TEST(ModesAtAmplitudes, HaveTheBristlesOfTheSealsBesideTheOil) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  constexpr double sigma = 2.9e6;
  for (auto& leg : machine.legs)
    leg.hydraulics.friction = {
        .coulomb = 310.0, .breakaway = 310.0, .bristles = model::LuGreBristles{.stiffness = sigma}};
  auto sticking = machine;
  for (auto& leg : sticking.legs) {
    *leg.oil_spring.stiffness += sigma;
    leg.hydraulics.friction = {};
  }
  const auto oil =
      modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid));
  const auto stuck =
      modal::normal_modes(dynamics::linear_model(sticking, machine.neutral(), ModelKind::rigid));
  for (const auto& curve : curves_of(machine, {1e-9, 1e-4, 0.1}, ModelKind::rigid)) {
    ASSERT_EQ(curve.points.size(), 3U);
    EXPECT_NEAR(curve.points[0].omega, stuck.omega(curve.mode), 1e-4 * curve.omega);
    EXPECT_NEAR(curve.points[2].omega, oil.omega(curve.mode), 1e-2 * curve.omega);
    // Most damped where bristles begin to slide; little where they stick or slide for long.
    EXPECT_GT(curve.points[1].damping_ratio, curve.points[0].damping_ratio);
    EXPECT_GT(curve.points[1].damping_ratio, curve.points[2].damping_ratio);
  }
}

/// An elastomer without a softening has the damped frequency of its arms.
TEST(ModesAtAmplitudes, HaveTheComplexStiffnessOfElastomersAtTheirFrequency) {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.5, .loss_factor = 0.1, .frequency = 9.7};
  const auto linear = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto damped = modal::damped_modes(linear, modal::normal_modes(linear), 0.0);
  const auto curves = curves_of(machine, {1e-6});
  for (int k = 0; k < 6; ++k) {
    const auto& point = curves[static_cast<std::size_t>(k)].points[0];
    ASSERT_TRUE(point.converged);
    double nearest = 1e300, damping = 0.0;
    for (const auto& mode : damped)
      if (std::abs(mode.omega - point.omega) < nearest) {
        nearest = std::abs(mode.omega - point.omega);
        damping = mode.damping_ratio;
      }
    // real modes for complex ones: of the order of the damping squared
    EXPECT_LT(nearest, 5e-3 * point.omega);
    EXPECT_NEAR(point.damping_ratio, damping, 0.05 * damping);
  }
}

TEST(ModesAtAmplitudes, SoftenWithElastomersThatAmplitudesSoften) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.5,
                                  .loss_factor = 0.1,
                                  .frequency = 9.7,
                                  .softening = 0.4,
                                  .softening_amplitude = 5e-5};
  for (auto& leg : machine.legs)
    leg.guide_sleeve.stiffness *= 5.3;  // far above the platform's modes
  auto soft = machine;
  for (auto& leg : soft.legs) {
    leg.guide_sleeve.stiffness *= 0.6;
    leg.guide_sleeve.elastomer->softening = 0.0;
  }
  const double limit = curves_of(soft, {1e-6}).front().points[0].omega;
  const auto lowest = curves_of(machine, {1e-7, 1e-3, 10.0}).front();
  ASSERT_EQ(lowest.points.size(), 3U);
  const double whole = lowest.points[0].omega - limit;
  EXPECT_GT(whole, 1e-5 * limit);
  EXPECT_GT(lowest.points[0].omega, lowest.points[1].omega);
  EXPECT_NEAR(lowest.points[2].omega, limit, 0.01 * whole);
}

TEST(ModesAtAmplitudes, MustAscend) {
  const auto machine = guided_machine();
  EXPECT_THROW((void)curves_of(machine, {}), std::invalid_argument);
  EXPECT_THROW((void)curves_of(machine, {0.0, 1e-3}), std::invalid_argument);
  EXPECT_THROW((void)curves_of(machine, {1e-3, 1e-3}), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::test
