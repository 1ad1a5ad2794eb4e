#include "fmu_interface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fmu_outputs.hpp"

namespace hydrapod::exchange {

namespace {

using model::ParameterId;
using simulation::Plant;

/// Of sensors and limits of poses, on which nothing here depends; joints are parameters themselves,
/// not the circle on which they were laid out.
bool concerns(std::string_view path, const FmuMachine& fmu) {
  constexpr std::array never{"sensors.", "legs.joint_limits.", "base.joints.circle",
                             "platform.joints.circle", "legs.stick_stiffness"};
  constexpr std::array of_oil{"supply.", "legs.valve.", "legs.leakage.", "legs.friction."};
  const auto begins = [&](const char* front) { return path.starts_with(front); };
  if (std::ranges::any_of(never, begins)) return false;
  if (path.starts_with("controller.")) return fmu.controlled;
  // The number of segments or modes says which states there are.
  const bool oil = fmu.hydraulics && !fmu.drives();
  const auto& lines = fmu.machine.hydraulics.lines;
  const bool waves = oil && (lines.segments > 0.0 || lines.modes > 0.0);
  if (path.starts_with("lines.")) return waves && path == "lines.viscosity";
  return oil || !std::ranges::any_of(of_oil, begins);
}

/// On them the force of each leg at rest at the reference pose depends.
constexpr std::array of_rest{"environment.gravity",
                             "platform.mass",
                             "legs.case.mass",
                             "legs.rod.mass",
                             "legs.guide_sleeve.stiffness",
                             "legs.piston_ring.stiffness"};

/// What enters the equations of motion and no lengths: masses, inertias, stiffnesses, dampers,
/// valves, friction, leakage, oil and supply, motors.
constexpr std::array of_equations{"environment.gravity",
                                  "platform.mass",
                                  "platform.inertia",
                                  "legs.case.mass",
                                  "legs.case.transverse_inertia",
                                  "legs.case.axial_inertia",
                                  "legs.rod.mass",
                                  "legs.rod.transverse_inertia",
                                  "legs.rod.axial_inertia",
                                  "legs.added_axial_inertia",
                                  "legs.gimbal_cross_inertia",
                                  "legs.guide_sleeve.stiffness",
                                  "legs.guide_sleeve.damping",
                                  "legs.piston_ring.stiffness",
                                  "legs.piston_ring.damping",
                                  "legs.valve.natural_frequency",
                                  "legs.valve.damping_ratio",
                                  "legs.valve.rate_limit",
                                  "legs.valve.leakage",
                                  "legs.valve.overlap",
                                  "legs.valve.laminar_pressure",
                                  "legs.valve.rated_flow",
                                  "legs.valve.rated_pressure_drop",
                                  "legs.leakage.internal",
                                  "legs.leakage.external",
                                  "legs.friction.coulomb",
                                  "legs.friction.breakaway",
                                  "legs.friction.viscous",
                                  "legs.friction.stribeck_velocity",
                                  "legs.friction.smoothing_velocity",
                                  "legs.joint_friction.viscous",
                                  "legs.joint_friction.coulomb",
                                  "legs.joint_friction.smoothing_rate",
                                  "legs.end_stops.stiffness",
                                  "legs.end_stops.damping",
                                  "legs.oil_spring.cylinder.bulk_modulus",
                                  "legs.equivalent_cylinder.bulk_modulus",
                                  "legs.screw.stiffness",
                                  "legs.screw.damping",
                                  "legs.screw.inertia",
                                  "legs.screw.torque_limit",
                                  "legs.screw.speed_limit",
                                  "legs.screw.friction_torque",
                                  "legs.screw.viscous_friction",
                                  "legs.screw.speed_bandwidth",
                                  "legs.screw.speed_integral_time",
                                  "supply.pressure",
                                  "supply.return_pressure",
                                  "supply.pump_flow",
                                  "supply.line_volume",
                                  "damping.rayleigh_mass",
                                  "damping.rayleigh_stiffness",
                                  "damping.modal_ratio"};

/// Can it change during a simulation, with states that mean the same before and after? Where
/// gimbals or the base are compliant, lengths are counted from the rest under the load at the
/// start; so is what elastomers soften from. A cylinder that is not given has an area by the
/// platform's weight and the supply pressure.
bool is_tunable(const model::Machine& machine, std::string_view row) {
  const auto is = [&](std::string_view one) {
    return row == one ||
           (row.starts_with(one) && row.size() > one.size() && row[one.size()] == '.');
  };
  if (std::ranges::none_of(of_equations, is)) return false;
  const auto softens = [](const std::optional<model::Elastomer>& seal) {
    return seal && seal->softening > 0.0;
  };
  const bool counts_from_rest =
      machine.base_mount || std::ranges::any_of(machine.legs, [&](const auto& leg) {
        return leg.gimbal_stiffness || softens(leg.guide_sleeve.elastomer) ||
               (leg.piston_ring && softens(leg.piston_ring->elastomer));
      });
  if (counts_from_rest && std::ranges::any_of(of_rest, is)) return false;
  const bool area_by_load = std::ranges::any_of(machine.legs, [](const auto& leg) {
    return !leg.screw && !leg.oil_spring.cylinder && !leg.hydraulics.equivalent_cylinder.area;
  });
  constexpr std::array of_area{"environment.gravity", "platform.mass", "supply.pressure"};
  return !(area_by_load && std::ranges::any_of(of_area, is));
}

std::vector<ParameterId> parameters_of(const FmuMachine& fmu) {
  std::vector<ParameterId> kept;
  const auto poses = static_cast<int>(fmu.machine.poses.size());
  for (const auto& id : model::parameters(fmu.machine)) {
    const auto path = model::row_of(id).path;
    if (path.starts_with("poses.")) {
      if (id.of == 1 || id.of == poses) kept.push_back(id);
      continue;
    }
    const bool shared = id.of == 0 && path.starts_with(model::of_legs);
    if (!shared && concerns(path, fmu)) kept.push_back(id);
  }
  return kept;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/// May `name` stand in a structured name without quotes?
bool is_plain(std::string_view name) {
  return !name.empty() && is_letter(name.front()) &&
         std::ranges::all_of(name, [](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

/// Of a mode of the payload, as it stands in structured names: one that is no identifier is
/// counted.
std::string mode_name(const model::Machine& machine, std::size_t mode) {
  const auto& name = machine.payload_modes.at(mode).name;
  if (is_plain(name)) return name;
  auto counted = "mode_" + std::to_string(mode + 1);
  const auto is_taken = [&](const auto& other) { return other.name == counted; };
  while (std::ranges::any_of(machine.payload_modes, is_taken)) counted += '_';
  return counted;
}

/// "leg.3.rod.mass" as "leg3.rod.mass"; a pose whose name is no identifier is "reference".
std::string parameter_name(const model::Machine& machine, const ParameterId& id) {
  const auto path = model::path(machine, id);
  const auto row = model::row_of(id).path;
  const auto key = path.substr(path.rfind(model::last_key(row)));
  if (row.starts_with("poses.")) {
    const auto& pose = machine.poses.at(static_cast<std::size_t>(id.of) - 1).name;
    return "poses." + (is_plain(pose) ? pose : std::string("reference")) + '.' + key;
  }
  if (row.starts_with("payload_modes."))
    return "payload_modes." + mode_name(machine, static_cast<std::size_t>(id.of) - 1) + '.' + key;
  return path.starts_with("leg.") ? "leg" + path.substr(4) : path;
}

/// "payload.NAME", "payload.NAME_rate" with the name that parameters have.
std::string state_name(const model::Machine& machine, const std::string& name) {
  constexpr std::string_view front = "payload.", rate = "_rate";
  for (std::size_t k = 0; k < machine.payload_modes.size(); ++k) {
    const auto own = std::string(front) + machine.payload_modes[k].name;
    for (const auto end : {std::string_view(), rate})
      if (name == own + std::string(end))
        return std::string(front) + mode_name(machine, k) + std::string(end);
  }
  return name;
}

/// What the table says, without its marks.
std::string plain_meaning(std::string_view meaning) {
  std::string text(meaning);
  std::erase(text, '`');
  return text;
}

FmuVariable parameter_variable(const model::Machine& machine, const ParameterId& id, int index) {
  const auto& row = model::row_of(id);
  FmuVariable made{.role = FmuRole::parameter,
                   .index = index,
                   .name = parameter_name(machine, id),
                   .unit = std::string(model::unit(machine, id)),
                   .description = std::string(row.path) + ": " + plain_meaning(row.meaning),
                   .tunable = is_tunable(machine, row.path),
                   .start = model::value(machine, id)};
  if (std::isfinite(row.bound.lowest)) made.low = row.bound.lowest;
  if (std::isfinite(row.bound.highest)) made.high = row.bound.highest;
  if (*made.start != 0.0) made.nominal = std::abs(*made.start);
  return made;
}

FmuVariable input_variable(const FmuMachine& fmu, int k) {
  constexpr std::array names{"fx", "fy", "fz", "mx", "my", "mz"};
  FmuVariable made{.role = FmuRole::input, .index = k};
  made.start = fmu.input_start.at(static_cast<std::size_t>(k));
  const auto describe = [&](std::string_view unit, std::string_view description, double nominal) {
    made.unit = unit;
    made.description = description;
    made.nominal = nominal;
  };
  const int wrench = k - fmu.wrench_input();
  if (wrench >= 0) {
    made.name = std::string("wrench.") + names.at(static_cast<std::size_t>(wrench));
    if (wrench < 3)
      describe("N", "force on the platform along a base axis", 1e3);
    else
      describe("N m", "moment on the platform about its mass centre, base axes", 1e3);
    return made;
  }
  if (fmu.controlled) {
    const bool rate = k >= 6, turn = k % 6 >= 3;
    made.name = (rate ? "command_rate." : "command.") + std::string(spatial::direction_name(k % 6));
    describe(turn ? (rate ? "rad/s" : "rad") : (rate ? "m/s" : "m"),
             rate ? "rate of the command, which the controller feeds forward"
                  : "commanded displacement of the platform from the reference pose",
             turn ? 0.1 : 1.0);
    return made;
  }
  made.name =
      "leg" + std::to_string(k + 1) + '.' + (fmu.hydraulics ? fmu.command_name() : "axial_force");
  if (!fmu.hydraulics) {
    describe("N", "force on the piston along the leg, + pushes the leg out", 1e4);
    return made;
  }
  describe("1",
           fmu.drives() ? "command of the motor's speed in shares of the largest, + extends the leg"
                        : "command of the valve in shares of full travel, + extends the leg",
           1.0);
  made.low = -1.0;
  made.high = 1.0;
  return made;
}

/// Is the state one that users look at?
bool shown(const simulation::StateLayout& layout, int k) {
  const auto within = [k](int first, int count) {
    return first >= 0 && k >= first && k < first + count;
  };
  const bool spool_position = within(layout.spools, 12) && (k - layout.spools) % 2 == 0;
  const bool nut = within(layout.nuts, 18) && (k - layout.nuts) % 3 == 0;
  return within(layout.velocity(), 6) || within(layout.pressures, 12) || spool_position || nut ||
         k == layout.supply;
}

std::string state_description(const simulation::StateLayout& layout, int k, bool rate) {
  std::string of = "state of the mechanics";
  if (k < 3) of = "mass centre of the platform in the base frame";
  if (k >= 3 && k < 7) of = "quaternion of the platform in the base frame";
  if (k >= layout.velocity() && k < layout.velocity() + 3) of = "velocity of the mass centre";
  if (k >= layout.velocity() + 3 && k < layout.velocity() + 6)
    of = "angular velocity of the platform, base axes";
  if (layout.pressures >= 0 && k >= layout.pressures) of = "chamber pressure, absolute";
  if (layout.spools >= 0 && k >= layout.spools) of = "spool of the valve, in travels";
  constexpr std::array of_drives{"way of the nut", "speed of the nut",
                                 "integral part of the motor's torque"};
  if (layout.nuts >= 0 && k >= layout.nuts && k < layout.nuts + 3 * model::leg_count)
    of = of_drives.at(static_cast<std::size_t>((k - layout.nuts) % 3));
  if (layout.supply >= 0 && k >= layout.supply) of = "supply pressure, absolute";
  if (layout.bristles >= 0 && k >= layout.bristles) of = "bend of the seal's bristles";
  for (const int first : layout.lines)
    if (first >= 0 && k >= first && k < first + layout.line_states)
      of = k < first + layout.line_states / 2
               ? "pressure in a line, absolute, from the valve on, or of a mode of it"
               : "flow in a line towards the chamber, or of a mode of it";
  if (layout.joints >= 0 && k >= layout.joints) of = "bend of the bristles in a joint";
  if (layout.base >= 0 && k >= layout.base) of = "motion of the base against the ground";
  if (layout.arms >= 0 && k >= layout.arms) of = "way of a damper in an elastomer seal";
  for (const auto& softening : {layout.sleeve_softening, layout.ring_softening})
    for (const int first : softening)
      if (first >= 0 && k >= first && k < first + simulation::StateLayout::softening_states)
        of = k == first ? "square of an elastomer seal's amplitude over its softening amplitude"
                        : "mean position of an elastomer seal";
  return rate ? "rate of: " + of : of;
}

/// "m/s" of "m", "1/s" of "1".
std::string rate_unit(const std::string& unit) {
  if (unit == "m/s" || unit == "rad/s" || unit == "1/s") return unit + "^2";
  return unit + "/s";
}

void add_states(const Plant& plant, std::vector<FmuVariable>& all) {
  auto names = plant.state_names();
  for (auto& name : names) name = state_name(plant.machine(), name);
  const auto units = plant.state_units();
  const auto scales = plant.scales();
  for (const bool rate : {false, true})
    for (std::size_t k = 0; k < names.size(); ++k) {
      const int index = static_cast<int>(k);
      FmuVariable made{.role = rate ? FmuRole::derivative : FmuRole::state, .index = index};
      made.name = rate ? "der(" + names[k] + ")" : names[k];
      made.unit = rate ? rate_unit(units[k]) : units[k];
      made.description = state_description(plant.layout(), index, rate);
      made.is_output = !rate && shown(plant.layout(), index);
      if (!rate) made.nominal = scales[index];
      all.push_back(std::move(made));
    }
}

std::vector<int> indicators_of(const Plant& plant) {
  std::vector<int> kept;
  const auto& layout = plant.layout();
  for (int k = 0; k < plant.event_count(); ++k) {
    const int leg = k / Plant::events_per_leg;
    const auto event = static_cast<Plant::Event>(k % Plant::events_per_leg);
    const bool of_stops = event == Plant::Event::retracted || event == Plant::Event::extended;
    const bool of_oil =
        event == Plant::Event::cavitation_cap || event == Plant::Event::cavitation_rod;
    if (of_stops && !std::isfinite(plant.axis(leg).stops.low)) continue;
    if (of_oil && layout.pressures < 0) continue;
    kept.push_back(k);
  }
  return kept;
}

void add_indicators(const std::vector<int>& events, std::vector<FmuVariable>& all) {
  constexpr std::array<const char*, Plant::events_per_leg> names{
      "retracted", "extended", "cavitation_cap", "cavitation_rod", "unguided"};
  int index = 0;
  for (const int k : events) {
    const auto event = static_cast<Plant::Event>(k % Plant::events_per_leg);
    const bool of_oil =
        event == Plant::Event::cavitation_cap || event == Plant::Event::cavitation_rod;
    all.push_back({.role = FmuRole::indicator,
                   .index = index++,
                   .name = "leg" + std::to_string(k / Plant::events_per_leg + 1) + ".event." +
                           names.at(static_cast<std::size_t>(k % Plant::events_per_leg)),
                   .unit = of_oil ? "Pa" : "m",
                   .description = std::string("below 0: ") + Plant::name(event)});
  }
}

}  // namespace

int FmuInterface::first(FmuRole role) const {
  const auto found = std::ranges::find(variables, role, &FmuVariable::role);
  return static_cast<int>(found - variables.begin());
}

int FmuInterface::count(FmuRole role) const {
  return static_cast<int>(std::ranges::count(variables, role, &FmuVariable::role));
}

FmuInterface fmu_interface(const FmuMachine& fmu, const Plant& plant) {
  FmuInterface result;
  auto& all = result.variables;
  all.push_back({.role = FmuRole::time, .name = "time", .unit = "s", .description = "time"});
  result.wrench_input = fmu.wrench_input();
  result.controlled = fmu.controlled;
  for (int k = 0; k < fmu.inputs(); ++k) all.push_back(input_variable(fmu, k));
  add_states(plant, all);
  int index = 0;
  for (const auto& one : fmu_output_table(plant))
    all.push_back({.role = FmuRole::output,
                   .index = index++,
                   .name = one.name,
                   .unit = one.unit,
                   .description = one.description,
                   .nominal = one.nominal});
  result.indicators = indicators_of(plant);
  add_indicators(result.indicators, all);
  result.parameters = parameters_of(fmu);
  index = 0;
  for (const auto& id : result.parameters)
    all.push_back(parameter_variable(fmu.machine, id, index++));
  for (int leg = 0; leg < model::leg_count && fmu.controlled; ++leg)
    all.push_back({.role = FmuRole::drive,
                   .index = leg,
                   .name = "leg" + std::to_string(leg + 1) + '.' + fmu.command_name(),
                   .unit = "1",
                   .description = std::string("command of the ") +
                                  (fmu.drives() ? "motor's speed" : "valve") +
                                  " by the controller, + extends the leg",
                   .nominal = 1.0});
  return result;
}

std::vector<double> fmu_indicators(const FmuInterface& interface, const Plant& plant,
                                   const double* x) {
  std::vector<double> all(static_cast<std::size_t>(plant.event_count())), kept;
  plant.events(x, all.data());
  for (const int k : interface.indicators) kept.push_back(all[static_cast<std::size_t>(k)]);
  return kept;
}

simulation::PlantInput fmu_plant_input(const FmuMachine& machine, const std::vector<double>& inputs,
                                       const spatial::Vector6& drives) {
  simulation::PlantInput input;
  const Eigen::Map<const spatial::Vector6> actuators(inputs.data());
  (machine.hydraulics ? input.command : input.axial) = actuators;
  if (machine.controlled) input.command = drives;
  input.wrench = Eigen::Map<const spatial::Vector6>(inputs.data() + machine.wrench_input());
  return input;
}

namespace {

/// Of one symbol, "m" or "Pa".
FmuUnit base_unit(std::string_view symbol) {
  struct Named {
    std::string_view symbol;
    FmuUnit unit;
  };
  constexpr std::array<Named, 8> known{Named{"1", {}},
                                       Named{"Hz", {.s = -1}},
                                       Named{"kg", {.kg = 1}},
                                       Named{"m", {.m = 1}},
                                       Named{"s", {.s = 1}},
                                       Named{"rad", {.rad = 1}},
                                       Named{"N", {.kg = 1, .m = 1, .s = -2}},
                                       Named{"Pa", {.kg = 1, .m = -1, .s = -2}}};
  const auto found = std::ranges::find(known, symbol, &Named::symbol);
  if (found == known.end())
    throw std::invalid_argument("no SI powers are known of the unit \"" + std::string(symbol) +
                                '"');
  return found->unit;
}

}  // namespace

/// Symbols with powers, blanks between them; what stands behind a stroke divides: one symbol, or
/// those in parentheses.
FmuUnit fmu_unit(std::string_view unit) {
  FmuUnit sum;
  int sign = 1;
  bool grouped = false;
  for (std::size_t i = 0; i < unit.size();) {
    const char c = unit[i];
    if (c == ' ' || c == '(' || c == ')' || c == '/') {
      if (c == '/') sign = -1;
      if (c == '(') grouped = true;
      if (c == ')' || (c == ' ' && !grouped)) sign = 1;
      ++i;
      continue;
    }
    const auto end = std::min(unit.find_first_of(" ()/^", i), unit.size());
    const auto one = base_unit(unit.substr(i, end - i));
    i = end;
    int power = sign;
    if (i + 1 < unit.size() && unit[i] == '^') {
      power *= unit[i + 1] - '0';
      i += 2;
    }
    sum.kg += power * one.kg;
    sum.m += power * one.m;
    sum.s += power * one.s;
    sum.rad += power * one.rad;
  }
  return sum;
}

}  // namespace hydrapod::exchange
