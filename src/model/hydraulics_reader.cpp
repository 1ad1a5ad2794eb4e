#include "hydraulics_reader.hpp"

namespace hydrapod::model {

namespace {

ServoValve read_valve(const Section& leg) {
  const Section table = leg.optional_table("valve");
  const ServoValve standard;
  return {
      .rated_flow = table.optional_number("rated_flow", "m^3/s"),
      .rated_pressure_drop =
          table.number("rated_pressure_drop", "Pa", standard.rated_pressure_drop),
      .overlap = table.number("overlap", "1", standard.overlap),
      .laminar_pressure = table.number("laminar_pressure", "Pa", standard.laminar_pressure),
      .natural_frequency = table.number("natural_frequency", "rad/s", standard.natural_frequency),
      .damping_ratio = table.number("damping_ratio", "1", standard.damping_ratio),
      .rate_limit = table.number("rate_limit", "1/s", standard.rate_limit),
      .leakage = table.optional_number("leakage", "m^3/s")};
}

CylinderLeakage read_leakage(const Section& leg) {
  const Section table = leg.optional_table("leakage");
  constexpr std::string_view unit = "m^3/(s Pa)";
  return {table.optional_number("internal", unit), table.number("external", unit, 0.0)};
}

std::optional<LuGreBristles> read_bristles(const Section& friction) {
  const Section table = friction.optional_table("bristles");
  if (!table.exists()) return std::nullopt;
  return LuGreBristles{table.number("stiffness", "N/m"), table.number("damping", "N s/m", 0.0)};
}

SealFriction read_friction(const Section& leg) {
  const Section table = leg.optional_table("friction");
  const SealFriction standard;
  return {
      .coulomb = table.optional_number("coulomb", "N"),
      .breakaway = table.optional_number("breakaway", "N"),
      .stribeck_velocity = table.number("stribeck_velocity", "m/s", standard.stribeck_velocity),
      .smoothing_velocity = table.number("smoothing_velocity", "m/s", standard.smoothing_velocity),
      .viscous = table.optional_number("viscous", "N s/m"),
      .bristles = read_bristles(table)};
}

JointFriction read_joint_friction(const Section& leg) {
  const Section table = leg.optional_table("joint_friction");
  const JointFriction standard;
  return {table.number("viscous", "N m s/rad", standard.viscous),
          table.number("coulomb", "N m", standard.coulomb),
          table.number("smoothing_rate", "rad/s", standard.smoothing_rate)};
}

EndStops read_end_stops(const Section& leg) {
  const Section table = leg.optional_table("end_stops");
  return {table.optional_number("stiffness", "N/m"),
          table.number("damping", "s/m", EndStops{}.damping)};
}

EquivalentCylinder read_equivalent_cylinder(const Section& leg) {
  const Section table = leg.optional_table("equivalent_cylinder");
  const EquivalentCylinder standard;
  return {table.number("area_ratio", "1", standard.area_ratio),
          table.optional_number("area", "m^2"),
          table.number("bulk_modulus", "Pa", standard.bulk_modulus)};
}

std::optional<Accumulator> read_accumulator(const Section& supply) {
  const Section table = supply.optional_table("accumulator");
  if (!table.exists()) return std::nullopt;
  return Accumulator{table.number("gas_volume", "m^3"), table.number("precharge", "Pa"),
                     table.number("polytropic", "1", Accumulator{}.polytropic)};
}

}  // namespace

LegHydraulics read_leg_hydraulics(const Section& leg) {
  return {.valve = read_valve(leg),
          .leakage = read_leakage(leg),
          .friction = read_friction(leg),
          .joint_friction = read_joint_friction(leg),
          .end_stops = read_end_stops(leg),
          .equivalent_cylinder = read_equivalent_cylinder(leg)};
}

Hydraulics read_hydraulics(const Section& root) {
  const Section table = root.optional_table("supply");
  const Hydraulics standard;
  const Supply& supply = standard.supply;
  return {
      .supply = {.pressure = table.number("pressure", "Pa", supply.pressure),
                 .return_pressure = table.number("return_pressure", "Pa", supply.return_pressure),
                 .pump_flow = table.optional_number("pump_flow", "m^3/s"),
                 .accumulator = read_accumulator(table),
                 .line_volume = table.number("line_volume", "m^3", supply.line_volume)},
      .cavitation_pressure =
          table.number("cavitation_pressure", "Pa", standard.cavitation_pressure)};
}

}  // namespace hydrapod::model
