// Conditions between numbers that only simulation needs; single numbers are checked by their rows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

void check_valve(const ServoValve& valve, ValueChecks& checks) {
  constexpr double most_leakage = 0.5;  // of the rated flow
  if (!valve.leakage || !valve.rated_flow || !checks.sound("valve.leakage")) return;
  if (*valve.leakage > most_leakage * *valve.rated_flow)
    checks.add_unexpected("valve.leakage", *valve.leakage, "m^3/s",
                          "no more than half the rated flow", most_leakage * *valve.rated_flow);
}

void check_friction(const SealFriction& friction, ValueChecks& checks) {
  if (friction.breakaway && checks.sound("friction.breakaway")) {
    if (!friction.coulomb)
      checks.add("friction.breakaway", "is given alone, expected `coulomb` too");
    else if (checks.sound("friction.coulomb") && *friction.breakaway < *friction.coulomb)
      checks.add_unexpected("friction.breakaway", *friction.breakaway, "N",
                            "no less than `coulomb`", *friction.coulomb);
  }
  if (friction.bristles && friction.coulomb.value_or(0.0) == 0.0)
    checks.add("friction.bristles", friction.coulomb
                                        ? "have no effect with `coulomb` = 0 N, expected more"
                                        : "have no effect without `coulomb`");
}

void check_joint_friction(const JointFriction& friction, ValueChecks& checks) {
  if (friction.bristle_stiffness && friction.coulomb == 0.0)
    checks.warn("joint_friction.bristle_stiffness",
                "has no effect with `coulomb` = 0 N m, expected more");
}

void check_equivalent_cylinder(const Leg& leg, ValueChecks& checks) {
  const auto& cylinder = leg.hydraulics.equivalent_cylinder;
  if (!cylinder.area || !leg.stroke || !leg.oil_spring.stiffness) return;
  for (const auto* key : {"area", "area_ratio", "bulk_modulus"})
    if (!checks.sound(fmt::format("equivalent_cylinder.{}", key))) return;
  const double least = 0.5 * leg.stroke->length * *leg.oil_spring.stiffness /
                       (cylinder.bulk_modulus * (1.0 + cylinder.area_ratio * cylinder.area_ratio));
  if (*cylinder.area < least)
    checks.add("equivalent_cylinder.area",
               fmt::format("is {:.6g} m^2: with the stiffness of the oil spring its chambers would "
                           "be shorter than the stroke, expected more than {:.6g} m^2",
                           *cylinder.area, least));
}

/// The oil of a line with a length has its inertia already. m_a may be of another line, or of the
/// same.
void check_line_inertia(const Leg& leg, ValueChecks& checks) {
  const auto& cylinder = leg.oil_spring.cylinder;
  if (!cylinder || !(leg.added_axial_inertia > 0.0)) return;
  for (const auto& [key, length] : {std::pair{"cap_line_length", cylinder->cap_line_length},
                                    std::pair{"rod_line_length", cylinder->rod_line_length}})
    if (length > 0.0)
      return checks.warn(
          "added_axial_inertia",
          fmt::format("is {:.6g} kg beside `oil_spring.cylinder.{}` = {:.6g} m, from which the oil "
                      "of this line has an inertia: is it counted twice?",
                      leg.added_axial_inertia, key, length));
}

}  // namespace

void check_leg_hydraulics(const Leg& leg, ValueChecks& checks) {
  check_valve(leg.hydraulics.valve, checks);
  check_friction(leg.hydraulics.friction, checks);
  check_joint_friction(leg.hydraulics.joint_friction, checks);
  check_equivalent_cylinder(leg, checks);
  check_line_inertia(leg, checks);
}

void check_supply(const Hydraulics& hydraulics, ValueChecks& checks) {
  const auto& supply = hydraulics.supply;
  const bool back = checks.sound("supply.return_pressure");
  if (back && checks.sound("supply.pressure") && supply.return_pressure >= supply.pressure)
    checks.add_unexpected("supply.return_pressure", supply.return_pressure, "Pa",
                          "less than the supply pressure", supply.pressure);
  const double p_c = hydraulics.cavitation_pressure;
  if (back && checks.sound("supply.cavitation_pressure") && p_c >= supply.return_pressure)
    checks.add_unexpected("supply.cavitation_pressure", p_c, "Pa", "less than the return pressure",
                          supply.return_pressure);
  if (supply.accumulator && !supply.pump_flow)
    checks.add("supply.accumulator",
               "has no effect: without a `pump_flow` the supply pressure is constant, expected "
               "`pump_flow` too");
}

namespace {

/// Lines with waves have lengths, and are taken out of the chambers that hold them. `key`: what
/// asks for the waves, `number` of what.
void check_waves(const Machine& machine, const std::string& key, double number,
                 ValueChecks& checks) {
  if (number != std::floor(number))
    checks.add(key, fmt::format("is {:.6g}, expected a whole number up to {}", number,
                                most_line_segments));
  const auto has_line = [](const Leg& leg) {
    const auto& cylinder = leg.oil_spring.cylinder;
    return cylinder && (cylinder->cap_line_length > 0.0 || cylinder->rod_line_length > 0.0);
  };
  const auto& legs = machine.legs;
  if (std::none_of(legs.begin(), legs.end(), has_line))
    checks.add(key,
               "has no effect: no line has a length, expected "
               "`legs.oil_spring.cylinder.cap_line_length` or `rod_line_length`");
  if (std::any_of(legs.begin(), legs.end(), [&](const Leg& leg) {
        return has_line(leg) && leg.oil_spring.cylinder->volumes == VolumeRule::equal;
      }))
    checks.add(key,
               "takes lines out of the chambers that hold them, expected "
               "`legs.oil_spring.cylinder.volumes` = \"chambers\"");
}

}  // namespace

void check_lines(const Machine& machine, ValueChecks& checks) {
  const auto& [segments, modes, viscosity] = machine.hydraulics.lines;
  const bool of_segments = segments != 0.0 && checks.sound("lines.segments");
  const bool of_modes = modes != 0.0 && checks.sound("lines.modes");
  if (of_segments) check_waves(machine, "lines.segments", segments, checks);
  if (of_modes && of_segments)
    checks.add(
        "lines.modes",
        "stands beside `lines.segments`: a line has modes or segments, expected one of them");
  else if (of_modes)
    check_waves(machine, "lines.modes", modes, checks);
}

void check_sensors(const Sensors& sensors, ValueChecks& checks) {
  const auto check = [&](const char* key, const Sensor& sensor, const char* unit) {
    if (sensor.low && sensor.high && checks.sound(key) && *sensor.low >= *sensor.high)
      checks.add(key, fmt::format("goes from {:.6g} {} to {:.6g} {}, expected the lower end first",
                                  *sensor.low, unit, *sensor.high, unit));
  };
  check("sensors.length.range", sensors.length, "m");
  check("sensors.pressure.range", sensors.pressure, "Pa");
  check("sensors.acceleration.range", sensors.acceleration, "m/s^2");
}

}  // namespace hydrapod::model
