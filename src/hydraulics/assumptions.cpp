#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equivalent_cylinder.hpp"
#include "hydrapod/hydraulics/lines.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

namespace {

using model::leg_count;

constexpr double litres_per_minute = 6e4;  // per m³/s

std::string flow_text(double flow) { return fmt::format("{:.3g} l/min", litres_per_minute * flow); }

const char* rule_text(EquivalentArea::Rule rule) {
  switch (rule) {
    case EquivalentArea::Rule::given:
      return "given";
    case EquivalentArea::Rule::roomy:
      return "chambers as long as the stroke; a sixth of the supply pressure would carry the "
             "platform with less";
    case EquivalentArea::Rule::carrying:
      break;
  }
  return "a sixth of the supply pressure carries the platform";
}

void assume_cylinder(const model::Machine& machine, const model::Leg& leg, const ServoAxis& axis,
                     std::vector<Assumption>& all) {
  if (leg.oil_spring.cylinder) return;
  all.push_back(
      {"equivalent_cylinder",
       fmt::format("A_p = {:.3g} cm^2 ({}), e = {:.3g}, {:.3g} l in both chambers at mid stroke: "
                   "the given oil spring at {:.3g} GPa (Eq. 16)",
                   1e4 * axis.area.piston, rule_text(equivalent_area(machine, leg).rule),
                   axis.area.ratio(), 1e3 * axis.volume.cap, 1e-9 * axis.oil.bulk_modulus)});
}

void assume_stroke(const model::Leg& leg, const ServoAxis& axis, std::vector<Assumption>& all) {
  if (leg.stroke) return;
  all.push_back({"stroke", fmt::format("the piston may go from {:.1f} to {:.1f} mm from the base "
                                       "joint: 90 % of what chambers and guide sleeve allow",
                                       1e3 * axis.stops.low, 1e3 * axis.stops.high)});
}

void assume_valve(const model::Leg& leg, const ServoAxis& axis, double supply, double back,
                  std::vector<Assumption>& all) {
  const auto& given = leg.hydraulics.valve;
  if (!given.rated_flow)
    all.push_back({"valve.rated_flow", flow_text(0.5 * axis.area.piston) +
                                           " at full opening: the piston moves at 0.5 m/s"});
  if (!given.leakage)
    all.push_back({"valve.leakage", flow_text(null_leakage(axis.valve, supply, back)) +
                                        ": 1 % of the rated flow, through the middle"});
}

void assume_losses(const model::Leg& leg, const ServoAxis& axis, double supply,
                   std::vector<Assumption>& all) {
  const auto& friction = leg.hydraulics.friction;
  if (!leg.hydraulics.leakage.internal)
    all.push_back(
        {"leakage.internal", flow_text(axis.internal_leakage * supply) +
                                 " past the piston at the supply pressure: 1 % of the rated flow"});
  if (!friction.coulomb)
    all.push_back({"friction.coulomb", "none: friction would add damping to small motions"});
  if (friction.coulomb && !friction.viscous)
    all.push_back({"friction.viscous",
                   fmt::format("{:.3g} N s/m: 10 times coulomb per m/s", axis.friction.viscous)});
}

std::vector<Assumption> of_leg(const model::Machine& machine, int i) {
  const auto& leg = machine.legs[i];
  const auto& supply = machine.hydraulics.supply;
  const auto axis = servo_axis(machine, i);
  std::vector<Assumption> all;
  assume_cylinder(machine, leg, axis, all);
  assume_stroke(leg, axis, all);
  assume_valve(leg, axis, supply.pressure, supply.return_pressure, all);
  assume_losses(leg, axis, supply.pressure, all);
  return all;
}

/// "1.3" or "1.3 to 4.5".
std::string range_text(const std::vector<double>& values, double unit) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const auto low = fmt::format("{:.3g}", unit * *least), high = fmt::format("{:.3g}", unit * *most);
  return low == high ? low : low + " to " + high;
}

/// Of lines with waves: the pipes that their volumes and lengths stand for, and c/4L.
void assume_lines(const model::Machine& machine, std::vector<Assumption>& all) {
  std::vector<double> diameters, waves;
  for (int i = 0; i < leg_count; ++i) {
    const auto& given = machine.legs[i].oil_spring.cylinder;
    if (!given) continue;
    const auto lines = leg_lines(machine, i);
    const auto add = [&](const Line& line, double length, double volume, double of_wall) {
      if (states(line) == 0) return;
      const double section = volume / length;
      const double compliance = volume / effective_bulk_modulus(*given) + of_wall;
      diameters.push_back(2.0 * std::sqrt(section / std::numbers::pi));
      waves.push_back(0.25 / std::sqrt(given->density * length / section * compliance));
    };
    add(lines.cap, given->cap_line_length, given->cap_line_volume, given->cap_line_compliance);
    add(lines.rod, given->rod_line_length, given->rod_line_volume, given->rod_line_compliance);
  }
  if (waves.empty()) return;
  all.push_back({"lines", fmt::format("round pipes of {} mm by their volumes and lengths; quarter "
                                      "waves (c/4L) at {} Hz",
                                      range_text(diameters, 1e3), range_text(waves, 1.0))});
}

}  // namespace

std::vector<Assumption> hydraulic_assumptions(const model::Machine& machine) {
  if (model::leg_type(machine) != model::LegType::cylinder) return {};
  std::array<std::vector<Assumption>, leg_count> legs;
  for (int i = 0; i < leg_count; ++i) legs[i] = of_leg(machine, i);
  const auto shared = [&](const Assumption& one) {
    return std::all_of(legs.begin(), legs.end(), [&](const auto& of_one) {
      return std::any_of(of_one.begin(), of_one.end(), [&](const Assumption& other) {
        return other.key == one.key && other.text == one.text;
      });
    });
  };
  std::vector<Assumption> all;
  for (int i = 0; i < leg_count; ++i)
    for (const auto& one : legs[i]) {
      const bool by_all = shared(one);
      if (by_all && i > 0) continue;
      all.push_back({(by_all ? "legs." : fmt::format("leg.{}.", i + 1)) + one.key, one.text});
    }
  assume_lines(machine, all);
  return all;
}

}  // namespace hydrapod::hydraulics
