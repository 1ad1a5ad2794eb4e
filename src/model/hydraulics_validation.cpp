#include <fmt/format.h>

#include <cmath>

#include "validate_values.hpp"
#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

void check_valve(const ServoValve& valve, ValueChecks& checks) {
  if (valve.rated_flow) checks.positive("valve.rated_flow", *valve.rated_flow, "m^3/s");
  checks.positive("valve.rated_pressure_drop", valve.rated_pressure_drop, "Pa");
  constexpr double most_overlap = 0.5;  // of the travel
  if (checks.finite("valve.overlap", valve.overlap, "1") && std::abs(valve.overlap) > most_overlap)
    checks.add("valve.overlap",
               fmt::format("is {:.6g} of the travel, expected -0.5 (underlap) to 0.5 (overlap)",
                           valve.overlap));
  checks.positive("valve.laminar_pressure", valve.laminar_pressure, "Pa");
  checks.positive("valve.natural_frequency", valve.natural_frequency, "rad/s");
  checks.positive("valve.damping_ratio", valve.damping_ratio, "1");
  checks.positive("valve.rate_limit", valve.rate_limit, "1/s");
  if (!valve.leakage || !checks.not_negative("valve.leakage", *valve.leakage, "m^3/s")) return;
  constexpr double most_leakage = 0.5;  // of the rated flow
  if (valve.rated_flow && *valve.leakage > most_leakage * *valve.rated_flow)
    checks.add(
        "valve.leakage",
        fmt::format("is {:.6g} m^3/s, expected no more than half the rated flow, {:.6g} m^3/s",
                    *valve.leakage, most_leakage * *valve.rated_flow));
}

void check_friction(const SealFriction& friction, ValueChecks& checks) {
  const bool coulomb =
      friction.coulomb && checks.not_negative("friction.coulomb", *friction.coulomb, "N");
  if (friction.breakaway && checks.not_negative("friction.breakaway", *friction.breakaway, "N")) {
    if (!friction.coulomb)
      checks.add("friction.breakaway", "is given alone, expected `coulomb` beside it");
    else if (coulomb && *friction.breakaway < *friction.coulomb)
      checks.add("friction.breakaway",
                 fmt::format("is {:.6g} N, expected no less than `coulomb`, {:.6g} N",
                             *friction.breakaway, *friction.coulomb));
  }
  checks.positive("friction.stribeck_velocity", friction.stribeck_velocity, "m/s");
  checks.positive("friction.smoothing_velocity", friction.smoothing_velocity, "m/s");
  if (friction.viscous) checks.not_negative("friction.viscous", *friction.viscous, "N s/m");
  if (!friction.bristles) return;
  checks.positive("friction.bristles.stiffness", friction.bristles->stiffness, "N/m");
  checks.not_negative("friction.bristles.damping", friction.bristles->damping, "N s/m");
  if (coulomb && *friction.coulomb == 0.0)
    checks.add("friction.bristles", "have nothing to slide at with `coulomb` = 0 N, expected more");
}

void check_equivalent_cylinder(const Leg& leg, ValueChecks& checks) {
  const auto& cylinder = leg.hydraulics.equivalent_cylinder;
  const std::string key = "equivalent_cylinder";
  const bool ratio = checks.positive(key + ".area_ratio", cylinder.area_ratio, "1");
  if (ratio && cylinder.area_ratio > 1.0)
    checks.add(key + ".area_ratio",
               fmt::format("is {:.6g}, expected no more than 1", cylinder.area_ratio));
  const bool modulus = checks.positive(key + ".bulk_modulus", cylinder.bulk_modulus, "Pa");
  if (!cylinder.area || !checks.positive(key + ".area", *cylinder.area, "m^2")) return;
  if (!ratio || !modulus || !leg.stroke || !leg.oil_spring.stiffness) return;
  const double least = 0.5 * leg.stroke->length * *leg.oil_spring.stiffness /
                       (cylinder.bulk_modulus * (1.0 + cylinder.area_ratio * cylinder.area_ratio));
  if (*cylinder.area < least)
    checks.add(key + ".area",
               fmt::format("is {:.6g} m^2: with the stiffness of the oil spring its chambers would "
                           "be shorter than the stroke, expected more than {:.6g} m^2",
                           *cylinder.area, least));
}

}  // namespace

void check_leg_hydraulics(const Leg& leg, ValueChecks& checks) {
  const auto& hydraulics = leg.hydraulics;
  check_valve(hydraulics.valve, checks);
  const auto& leakage = hydraulics.leakage;
  if (leakage.internal) checks.not_negative("leakage.internal", *leakage.internal, "m^3/(s Pa)");
  checks.not_negative("leakage.external", leakage.external, "m^3/(s Pa)");
  check_friction(hydraulics.friction, checks);
  const auto& joints = hydraulics.joint_friction;
  checks.not_negative("joint_friction.viscous", joints.viscous, "N m s/rad");
  checks.not_negative("joint_friction.coulomb", joints.coulomb, "N m");
  checks.positive("joint_friction.smoothing_rate", joints.smoothing_rate, "rad/s");
  const auto& stops = hydraulics.end_stops;
  if (stops.stiffness) checks.positive("end_stops.stiffness", *stops.stiffness, "N/m");
  checks.not_negative("end_stops.damping", stops.damping, "s/m");
  check_equivalent_cylinder(leg, checks);
}

void check_supply(const Hydraulics& hydraulics, ValueChecks& checks) {
  const auto& supply = hydraulics.supply;
  const bool pressure = checks.positive("supply.pressure", supply.pressure, "Pa");
  const bool back = checks.positive("supply.return_pressure", supply.return_pressure, "Pa");
  if (pressure && back && supply.return_pressure >= supply.pressure)
    checks.add("supply.return_pressure",
               fmt::format("is {:.6g} Pa, expected less than the supply pressure, {:.6g} Pa",
                           supply.return_pressure, supply.pressure));
  const double p_c = hydraulics.cavitation_pressure;
  if (checks.positive("supply.cavitation_pressure", p_c, "Pa") && back &&
      p_c >= supply.return_pressure)
    checks.add("supply.cavitation_pressure",
               fmt::format("is {:.6g} Pa, expected less than the return pressure, {:.6g} Pa", p_c,
                           supply.return_pressure));
  checks.positive("supply.line_volume", supply.line_volume, "m^3");
  if (supply.pump_flow) checks.positive("supply.pump_flow", *supply.pump_flow, "m^3/s");
  if (!supply.accumulator) return;
  const auto& gas = *supply.accumulator;
  checks.positive("supply.accumulator.gas_volume", gas.gas_volume, "m^3");
  checks.positive("supply.accumulator.precharge", gas.precharge, "Pa");
  if (checks.finite("supply.accumulator.polytropic", gas.polytropic, "1") &&
      (gas.polytropic < 1.0 || gas.polytropic > 2.0))
    checks.add("supply.accumulator.polytropic",
               fmt::format("is {:.6g}, expected 1 (slow) to about 1.4 (fast)", gas.polytropic));
  if (!supply.pump_flow)
    checks.add("supply.accumulator",
               "has nothing to do: without a `pump_flow` the supply holds its pressure whatever is "
               "drawn, expected `pump_flow` beside it");
}

}  // namespace hydrapod::model
