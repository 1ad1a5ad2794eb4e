/// Oil springs against hand calculation and against the pressures they stand for.

#include "hydrapod/hydraulics/servo_axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hydrapod::hydraulics {
namespace {

/// 80 mm bore, 56 mm rod: A_p = 1600π mm², A_rod = 784π mm², e = 0.51.
model::Cylinder cylinder() {
  return {.bore = 0.080,
          .rod_diameter = 0.056,
          .cap_dead_volume = 20e-6,
          .rod_dead_volume = 30e-6,
          .cap_line_volume = 200e-6,
          .rod_line_volume = 100e-6,
          .bulk_modulus = 700e6};
}

model::Leg leg_with(const model::Cylinder& cylinder) {
  model::Leg leg;
  leg.stroke = model::Stroke{.retracted = 0.4, .length = 0.5};
  leg.oil_spring.cylinder = cylinder;
  return leg;
}

constexpr double rounding = 1e-14;  // relative

TEST(CylinderAreas, AreThoseOfCircles) {
  const auto [piston, annulus] = areas(cylinder());
  EXPECT_NEAR(piston, 1600e-6 * std::numbers::pi, rounding * piston);
  EXPECT_NEAR(annulus, 816e-6 * std::numbers::pi, rounding * annulus);
  EXPECT_NEAR(areas(cylinder()).ratio(), 0.51, rounding);
}

TEST(ChamberVolumes, AreTheSweptDeadAndLineVolumes) {
  // Piston 0.1 m out of its stroke of 0.5 m.
  const auto volume = chamber_volumes(cylinder(), *leg_with(cylinder()).stroke, 0.5);
  EXPECT_NEAR(volume.cap, 160e-6 * std::numbers::pi + 220e-6, rounding * volume.cap);
  EXPECT_NEAR(volume.rod, 326.4e-6 * std::numbers::pi + 130e-6, rounding * volume.rod);
}

TEST(OilStiffness, OfTrueChambersIsTheSumOfBoth) {
  // 700 MPa × (A_p²/V_1 + (0.51 A_p)²/V_2), all in mm: V_1 = 722654.8, V_2 = 1155415.8 mm³.
  const double k_h = oil_stiffness(leg_with(cylinder()), 0.5);
  const double A_p = 1600e-6 * std::numbers::pi;
  const double by_hand =
      700e6 * (A_p * A_p / 722654.8245743669e-9 + 0.2601 * A_p * A_p / 1155415.842131709e-9);
  EXPECT_NEAR(k_h, by_hand, 1e-13 * by_hand);
  EXPECT_NEAR(k_h, 28.456e6, 0.5e3);
}

TEST(OilStiffness, OfEqualVolumesIsEquation16AtEveryExtension) {
  auto equal = cylinder();
  equal.volumes = model::VolumeRule::equal;
  equal.control_volume = 1.0e-3;
  const double A_p = 1600e-6 * std::numbers::pi;
  const double by_hand = 700e6 * (1.0 + 0.51 * 0.51) * A_p * A_p / 1.0e-3;
  for (double l_m : {0.4, 0.5, 0.9})
    EXPECT_NEAR(oil_stiffness(leg_with(equal), l_m), by_hand, rounding * by_hand);
}

TEST(OilStiffness, OfEqualVolumesTakesTheMeanVolumeAtMidStroke) {
  auto equal = cylinder();
  equal.volumes = model::VolumeRule::equal;
  // Mid stroke: V_1 = 400π mm² m + 220 cm³, V_2 = 204π mm² m + 130 cm³.
  const double by_hand = 0.5 * (604e-6 * std::numbers::pi + 350e-6);
  EXPECT_NEAR(control_volume(leg_with(equal)), by_hand, rounding * by_hand);
}

TEST(OilStiffness, GivenDirectlyIsTakenAsItIs) {
  model::Leg leg;
  leg.oil_spring.stiffness = 3.8535e6;
  EXPECT_EQ(oil_stiffness(leg, 0.5), 3.8535e6);
}

/// Stiff at both ends, and least where A_p³/V_1² = (e A_p)³/V_2².
TEST(OilStiffness, OfTrueChambersIsLeastBetweenTheEnds) {
  const auto leg = leg_with(cylinder());
  const double balance = std::pow(areas(cylinder()).ratio(), 1.5);
  const auto volume_ratio = [&](double l_m) {
    const auto volume = chamber_volumes(cylinder(), *leg.stroke, l_m);
    return volume.rod / volume.cap;
  };
  double least = 0.4, end = 0.9;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (least + end);
    (volume_ratio(middle) > balance ? least : end) = middle;
  }
  EXPECT_GT(least, 0.45);
  EXPECT_LT(least, 0.85);
  for (double away : {-1e-3, 1e-3})
    EXPECT_GT(oil_stiffness(leg, least + away), oil_stiffness(leg, least));
}

TEST(OilStiffness, WithoutWhatItNeedsIsAnError) {
  const auto message = [](const model::Leg& leg) -> std::string {
    try {
      oil_stiffness(leg, 0.5);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  EXPECT_EQ(message({}), "oil spring: neither stiffness nor cylinder is given");
  auto leg = leg_with(cylinder());
  leg.stroke.reset();
  EXPECT_EQ(message(leg), "oil spring: chamber volumes need a stroke");
  leg.oil_spring.cylinder->volumes = model::VolumeRule::equal;
  EXPECT_EQ(message(leg), "oil spring: control volume needs a stroke");
}

model::Cylinder with_air(double fraction, double pressure, double polytropic = 1.4) {
  auto aerated = cylinder();
  aerated.air =
      model::EntrainedAir{.fraction = fraction, .pressure = pressure, .polytropic = polytropic};
  return aerated;
}

TEST(EntrainedAir, OfNothingLeavesTheOilAsItIs) {
  EXPECT_EQ(effective_bulk_modulus(cylinder()), 700e6);
  EXPECT_NEAR(effective_bulk_modulus(with_air(0.0, 5e6)), 700e6, rounding * 700e6);
  // …and its effect vanishes in proportion.
  const double softer = 1.0 - effective_bulk_modulus(with_air(1e-6, 5e6)) / 700e6;
  const double softest = 1.0 - effective_bulk_modulus(with_air(1e-5, 5e6)) / 700e6;
  EXPECT_NEAR(softest / softer, 10.0, 0.01);
}

/// Almost only air: its own adiabatic stiffness n p.
TEST(EntrainedAir, AloneIsAsStiffAsAGas) {
  const double n = 1.4, p = 2e6;
  EXPECT_NEAR(effective_bulk_modulus(with_air(1.0 - 1e-9, p, n)), n * p, 1e-6 * n * p);
}

/// At atmospheric pressure, shares (1 − α) and α of the volume are springs in series.
TEST(EntrainedAir, IsASpringInSeriesWithTheOil) {
  const double alpha = 0.02, n = 1.3;
  const double compliance =
      (1.0 - alpha) / 700e6 + alpha / (n * atmospheric_pressure);  // per unit volume
  const double expected = 1.0 / compliance;
  EXPECT_NEAR(effective_bulk_modulus(with_air(alpha, atmospheric_pressure, n)), expected,
              rounding * expected);
}

TEST(EntrainedAir, MattersLessUnderPressure) {
  double last = effective_bulk_modulus(with_air(0.01, 2e5));
  for (double p : {1e6, 5e6, 1e7, 3e7}) {
    const double now = effective_bulk_modulus(with_air(0.01, p));
    EXPECT_GT(now, last);
    EXPECT_LT(now, 700e6);
    last = now;
  }
}

/// A closed chamber of a volume V, filled with oil and air at p: how its pressure answers to a
/// change of volume, by bisection on the mixture's equation of state.
double closed_chamber_pressure(double V_start, double p_start, double V, double alpha, double n) {
  constexpr double beta = 700e6, p0 = atmospheric_pressure;
  // Volume of the filling at p, per atmospheric volume: oil with constant bulk modulus, air
  // polytropic.
  const auto filling = [&](double p) {
    return (1.0 - alpha) * std::exp(-(p - p_start) / beta) + alpha * std::pow(p0 / p, 1.0 / n);
  };
  const double amount = V_start / filling(p_start);
  double low = 1e3, high = 1e9;
  for (int i = 0; i < 200; ++i) {
    const double p = 0.5 * (low + high);
    (amount * filling(p) > V ? low : high) = p;
  }
  return 0.5 * (low + high);
}

class OilSpring : public testing::TestWithParam<double> {};

/// k_h is the derivative of the force of two closed chambers by the piston's position.
TEST_P(OilSpring, IsTheDerivativeOfTheForceOfClosedChambers) {
  const double alpha = GetParam(), n = 1.4, p = 6e6, l_m = 0.55;
  const auto leg = leg_with(with_air(alpha, p, n));
  const auto [A_p, A_annulus] = areas(*leg.oil_spring.cylinder);
  const auto start = chamber_volumes(*leg.oil_spring.cylinder, *leg.stroke, l_m);
  const auto force = [&](double x) {  // that the oil pushes the piston outwards with
    const auto volume = chamber_volumes(*leg.oil_spring.cylinder, *leg.stroke, l_m + x);
    return A_p * closed_chamber_pressure(start.cap, p, volume.cap, alpha, n) -
           A_annulus * closed_chamber_pressure(start.rod, p, volume.rod, alpha, n);
  };
  constexpr double h = 1e-5;  // [m]; pressures change by 1e-3 of themselves
  const double slope =
      (8.0 * (force(h) - force(-h)) - (force(2.0 * h) - force(-2.0 * h))) / (12.0 * h);
  EXPECT_NEAR(oil_stiffness(leg, l_m) / -slope, 1.0, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(WithAir, OilSpring, testing::Values(0.0, 0.001, 0.01, 0.1));

}  // namespace
}  // namespace hydrapod::hydraulics
