/// Cylinders, chambers, friction and supply against closed forms; what is assumed where a machine
/// says nothing.

#include "hydrapod/hydraulics/servo_axis.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using hydraulics::atmospheric_pressure;
using hydraulics::ServoAxis;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// −dF/ds of a closed cylinder whose pressures follow dp = −β dV/V.
double closed_stiffness(const ServoAxis& axis, double s, double p_cap, double p_rod) {
  const auto volume = axis.volumes(s);
  return axis.area.piston * axis.area.piston /
             (volume.cap * hydraulics::compressibility(axis.oil, p_cap)) +
         axis.area.annulus * axis.area.annulus /
             (volume.rod * hydraulics::compressibility(axis.oil, p_rod));
}

TEST(EquivalentCylinder, HasTheGivenStiffnessAtMidStroke) {
  auto machine = published_machine();
  machine.legs[3].oil_spring.stiffness = 2.913e6;
  machine.legs[4].hydraulics.equivalent_cylinder = {
      .area_ratio = 0.73, .area = 9.1e-4, .bulk_modulus = 8.7e8};
  machine.legs[5].stroke = model::Stroke{0.31, 0.21};
  for (int i = 0; i < model::leg_count; ++i) {
    const auto axis = hydraulics::servo_axis(machine, i);
    const double e = axis.area.ratio(), A_p = axis.area.piston;
    EXPECT_NEAR(closed_stiffness(axis, axis.s_mid, 7e6, 9e6), *machine.legs[i].oil_spring.stiffness,
                20 * epsilon * 4e6);
    EXPECT_NEAR(axis.oil.bulk_modulus * (1.0 + e * e) * A_p * A_p / axis.volume.cap,
                *machine.legs[i].oil_spring.stiffness, 20 * epsilon * 4e6);  // Eq. 16
    EXPECT_EQ(axis.volume.cap, axis.volume.rod);
    const auto at_ends = {axis.volumes(axis.stops.low).cap, axis.volumes(axis.stops.high).rod};
    for (const double volume : at_ends) EXPECT_GT(volume, 0.05 * axis.volume.cap);
  }
  EXPECT_EQ(hydraulics::servo_axis(machine, 4).area.piston, 9.1e-4);
  EXPECT_EQ(hydraulics::servo_axis(machine, 5).s_mid, 0.415);
}

TEST(EquivalentCylinder, CarriesThePlatformOnASixthOfTheSupplyPressure) {
  auto machine = published_machine();
  machine.hydraulics.supply.pressure = 11.3e6;
  const auto axis = hydraulics::servo_axis(machine, 0);
  const double rise = 0.783 / 0.8734095285480141;
  EXPECT_NEAR(axis.area.piston, 894.0 * 9.80665 / 6.0 / rise / (11.3e6 / 6.0), 1e-15);
  machine.legs[0].stroke = model::Stroke{0.01, 0.6};  // long chambers need a larger piston
  const auto longer = hydraulics::servo_axis(machine, 0);
  EXPECT_NEAR(longer.volume.cap, 1.1 * longer.area.piston * 0.3, 1e-15);
}

TEST(ServoAxis, TakesTheChambersOfAGivenCylinder) {
  Random random(31);
  int cylinders = 0;
  while (cylinders < 20) {
    const auto machine = random_machine(random);
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& leg = machine.legs[i];
      if (!leg.oil_spring.cylinder ||
          leg.oil_spring.cylinder->volumes != model::VolumeRule::chambers)
        continue;
      ++cylinders;
      const auto axis = hydraulics::servo_axis(machine, i);
      const double s = leg.stroke->retracted + 0.3 * leg.stroke->length;
      const auto expected = hydraulics::chamber_volumes(*leg.oil_spring.cylinder, *leg.stroke, s);
      EXPECT_NEAR(axis.volumes(s).cap, expected.cap, 1e-14 * expected.cap);
      EXPECT_NEAR(axis.volumes(s).rod, expected.rod, 1e-14 * expected.rod);
      const double p = leg.oil_spring.cylinder->air ? leg.oil_spring.cylinder->air->pressure : 5e6;
      EXPECT_NEAR(closed_stiffness(axis, s, p, p) / hydraulics::oil_stiffness(leg, s), 1.0, 1e-13);
      EXPECT_EQ(axis.stops.low, leg.stroke->retracted);
    }
  }
}

/// The assumptions of docs/howto/machine-file.md in numbers.
TEST(ServoAxis, WhatTheMachineDoesNotSayIsAssumed) {
  auto machine = published_machine();
  machine.hydraulics.supply.pressure = 9.7e6;
  machine.hydraulics.supply.return_pressure = 6e5;
  auto& leg = machine.legs[2];
  leg.oil_spring.stiffness = 9.3e7;  // short chambers
  leg.hydraulics.friction.coulomb = 37.0;
  leg.hydraulics.valve.rated_flow = 4.1e-4;
  const auto axis = hydraulics::servo_axis(machine, 2);
  EXPECT_NEAR(axis.friction.breakaway, 1.5 * 37.0, 1e-12);
  EXPECT_NEAR(axis.friction.viscous, 10.0 * 37.0, 1e-12);
  EXPECT_NEAR(axis.internal_leakage, 0.01 * 4.1e-4 / 9.7e6, 1e-22);
  const double in = axis.volume.cap / axis.area.piston, out = axis.volume.rod / axis.area.annulus;
  ASSERT_LT(out, leg.guide_sleeve.position - axis.s_mid);
  ASSERT_LT(in, out);
  EXPECT_NEAR(axis.stops.low, axis.s_mid - 0.9 * in, 1e-14);
  EXPECT_NEAR(axis.stops.high, axis.s_mid + 0.9 * out, 1e-14);
}

TEST(ServoAxis, TheForceIsThatOfThePressures) {
  const auto axis = hydraulics::servo_axis(published_machine(), 0);
  EXPECT_NEAR(axis.force(7.1e6, 9.3e6),
              7.1e6 * axis.area.piston - 9.3e6 * axis.area.annulus -
                  101325.0 * (axis.area.piston - axis.area.annulus),
              1e-9);
  EXPECT_NEAR(axis.force(atmospheric_pressure, atmospheric_pressure), 0.0, 1e-12);
}

TEST(ServoAxis, StopsPushBackAndNeverPull) {
  hydraulics::Stops stops{.low = 0.3, .high = 0.5, .stiffness = 1e7, .damping = 0.4};
  EXPECT_EQ(hydraulics::stop_force(stops, 0.4, 3.0), 0.0);
  EXPECT_NEAR(hydraulics::stop_force(stops, 0.502, 0.5), -1e7 * 0.002 * 1.2, 1e-8);
  EXPECT_NEAR(hydraulics::stop_force(stops, 0.299, 0.5), 1e7 * 0.001 * 0.8, 1e-8);
  EXPECT_EQ(hydraulics::stop_force(stops, 0.502, -4.0), 0.0);
}

TEST(Chamber, CompressibilityIsThatOfTheOilWithItsAir) {
  const hydraulics::Oil oil{.bulk_modulus = 1.31e9,
                            .air_fraction = 0.013,
                            .air_exponent = 1.23,
                            .cavitation_pressure = 5e4};
  const model::Cylinder cylinder{
      .bulk_modulus = 1.31e9,
      .air = model::EntrainedAir{.fraction = 0.013, .pressure = 4.7e6, .polytropic = 1.23}};
  EXPECT_NEAR(
      1.0 / hydraulics::compressibility(oil, 4.7e6) / hydraulics::effective_bulk_modulus(cylinder),
      1.0, 1e-14);
  // Oil and air, compressed apart: V(p) = (1 − α) e^(−p/β) + α (p_0/p)^(1/n) near one pressure.
  const auto volume = [&](double p) {
    return (1.0 - 0.013) * (1.0 - (p - 4.7e6) / 1.31e9) +
           0.013 * std::pow(atmospheric_pressure / p, 1.0 / 1.23);
  };
  const double slope = -(volume(4.7e6 + 1e3) - volume(4.7e6 - 1e3)) / 2e3 / volume(4.7e6);
  EXPECT_NEAR(hydraulics::compressibility(oil, 4.7e6) / slope, 1.0, 1e-6);
}

TEST(Chamber, GivesWayAtTheCavitationPressureAndGivesBackWhatItTook) {
  const hydraulics::Oil oil{.bulk_modulus = 1e9, .cavitation_pressure = 5e4};
  // Torn open from 1 MPa to 20 times its volume and closed again, in small steps.
  constexpr int steps = 400'000;
  double p = 1e6, lowest = p;
  const auto step = [&](double relative) {  // midpoint rule for dp = −(1/compressibility) dV/V
    const double half = p - 0.5 * relative / hydraulics::compressibility(oil, p);
    p -= relative / hydraulics::compressibility(oil, half);
    lowest = std::min(lowest, p);
  };
  const double relative = std::log(20.0) / steps;
  for (int k = 0; k < steps; ++k) step(relative);
  EXPECT_GT(lowest, 0.0);
  EXPECT_LT(p, 5.5e4);
  for (int k = 0; k < steps; ++k) step(-relative);
  EXPECT_NEAR(p, 1e6, 2e3);
  EXPECT_NEAR(1e9 * hydraulics::compressibility(oil, 5e4 + 25.0 * 5e3), 1.0, 1e-8);
}

TEST(Friction, HasItsBranches) {
  const hydraulics::Friction friction{.coulomb = 83.0,
                                      .breakaway = 131.0,
                                      .stribeck_velocity = 0.017,
                                      .smoothing_velocity = 1e-4,
                                      .viscous = 610.0};
  EXPECT_EQ(hydraulics::smooth_friction(friction, 0.0), 0.0);
  EXPECT_NEAR(hydraulics::smooth_friction(friction, 1e-3), 131.0, 1.0);  // breaks away
  EXPECT_NEAR(hydraulics::smooth_friction(friction, 0.3), 83.0 + 183.0, 1e-9);
  EXPECT_EQ(hydraulics::smooth_friction(friction, -0.3),
            -hydraulics::smooth_friction(friction, 0.3));
}

TEST(Friction, BristlesEndAtTheSlidingForceAndHoldAtRest) {
  const hydraulics::Friction friction{.coulomb = 83.0,
                                      .breakaway = 131.0,
                                      .stribeck_velocity = 0.017,
                                      .viscous = 610.0,
                                      .bristle_stiffness = 3.1e7,
                                      .bristle_damping = 900.0};
  double z = 0.0;
  constexpr double v = 0.3, h = 1e-8;
  for (int k = 0; k < 20'000; ++k) z += h * hydraulics::bristle_friction(friction, v, z).rate;
  const auto sliding = hydraulics::bristle_friction(friction, v, z);
  EXPECT_NEAR(sliding.rate, 0.0, 1e-9);
  EXPECT_NEAR(sliding.force, 83.0 + 183.0, 1e-6);
  const auto held = hydraulics::bristle_friction(friction, 0.0, 1e-6);
  EXPECT_EQ(held.rate, 0.0);
  EXPECT_DOUBLE_EQ(held.force, 31.0);
}

TEST(Supply, TheAccumulatorsGasFollowsItsLaw) {
  model::Supply supply{.pressure = 14e6, .pump_flow = 1e-3};
  supply.accumulator =
      model::Accumulator{.gas_volume = 4.3e-3, .precharge = 8.7e6, .polytropic = 1.31};
  supply.line_volume = 7e-4;
  // Draw oil without a pump and compare with p V_gasⁿ = constant plus the line's compression.
  const double compressibility = 1e-9;
  double p = 13.9e6, drawn = 0.0;
  constexpr int steps = 20'000;
  const double step = 1.1e-3 / steps;
  const double p_start = p;
  for (int k = 0; k < steps; ++k) {
    const double half = p - 0.5 * step / hydraulics::supply_capacity(supply, p, compressibility);
    p -= step / hydraulics::supply_capacity(supply, half, compressibility);
    drawn += step;
  }
  const auto gas = [&](double q) { return 4.3e-3 * std::pow(8.7e6 / q, 1.0 / 1.31); };
  EXPECT_NEAR(drawn, gas(p) - gas(p_start) + 7e-4 * compressibility * (p_start - p), 1e-10);
  EXPECT_GT(p, 8.7e6);
}

TEST(Supply, ThePumpGivesAllBelowItsBandAndNothingAboveIt) {
  const model::Supply supply{.pressure = 12e6, .pump_flow = 8.3e-4};
  EXPECT_EQ(hydraulics::pump_flow(supply, 11.8e6), 8.3e-4);
  EXPECT_EQ(hydraulics::pump_flow(supply, 12.2e6), 0.0);
  EXPECT_DOUBLE_EQ(hydraulics::pump_flow(supply, 12e6), 4.15e-4);
  EXPECT_NEAR(hydraulics::pump_flow(supply, hydraulics::pressure_at_flow(supply, 1e-4)), 1e-4,
              1e-16);
}

TEST(Rest, BalancesForceAndFlows) {
  Random random(77);
  for (int k = 0; k < 40; ++k) {
    auto machine = published_machine();
    auto& leg = machine.legs[0].hydraulics;
    leg.valve.overlap = random.uniform(-0.03, 0.05);
    leg.valve.leakage = 1e-6 * random.uniform(0.0, 10.0);
    leg.leakage.internal = 1e-13 * random.uniform(0.1, 5.0);
    leg.leakage.external = random.chance(0.5) ? 1e-14 : 0.0;
    const auto axis = hydraulics::servo_axis(machine, 0);
    const auto& supply = machine.hydraulics.supply;
    const double force = random.uniform(-3000.0, 4000.0);
    const auto rest = hydraulics::hydraulic_rest(axis, supply, force);
    ASSERT_TRUE(rest.found) << force;
    EXPECT_NEAR(axis.force(rest.p_cap, rest.p_rod), force, 1e-8);
    const auto flows = hydraulics::valve_flows(
        axis.valve, rest.spool, {supply.pressure, supply.return_pressure, rest.p_cap, rest.p_rod});
    const double across = axis.internal_leakage * (rest.p_cap - rest.p_rod);
    const auto outside = [&](double p) {
      return axis.external_leakage * (p - atmospheric_pressure);
    };
    EXPECT_NEAR(flows.cap - across - outside(rest.p_cap), 0.0, 1e-16);
    EXPECT_NEAR(flows.rod + across - outside(rest.p_rod), 0.0, 1e-16);
  }
}

TEST(Rest, OfASealedCylinderKeepsTheValveShut) {
  auto machine = published_machine();
  auto& leg = machine.legs[0].hydraulics;
  leg.valve.leakage = 0.0;
  leg.leakage.internal = 0.0;
  const auto axis = hydraulics::servo_axis(machine, 0);
  const auto rest = hydraulics::hydraulic_rest(axis, machine.hydraulics.supply, 1000.0);
  ASSERT_TRUE(rest.found);
  EXPECT_EQ(rest.spool, 0.0);
  EXPECT_NEAR(axis.force(rest.p_cap, rest.p_rod), 1000.0, 1e-9);
  EXPECT_GT(rest.p_cap, 1e6);
  EXPECT_GT(rest.p_rod, 1e6);
}

TEST(Rest, ALoadBeyondTheSupplyHasNone) {
  const auto machine = published_machine();
  const auto axis = hydraulics::servo_axis(machine, 0);
  EXPECT_FALSE(hydraulics::hydraulic_rest(axis, machine.hydraulics.supply, 1.1e4).found);
  EXPECT_FALSE(hydraulics::hydraulic_rest(axis, machine.hydraulics.supply, -6e3).found);
}

}  // namespace
}  // namespace hydrapod::test
