#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "gnuplot.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using simulation::Ability;
using simulation::Limit;
using spatial::direction_names;

struct Axis {
  const char* title;
  const char* unit;       ///< of translations
  const char* turn_unit;  ///< of rotations
  double scale, turn_scale;
};
constexpr double per_degree = 180.0 / std::numbers::pi;
constexpr std::array<Axis, simulation::ability_count> axes{{
    {"force", "kN", "kN m", 1e-3, 1e-3},
    {"speed", "m/s", "°/s", 1.0, per_degree},
    {"acceleration", "m/s²", "°/s²", 1.0, per_degree},
    {"jerk", "m/s³", "°/s³", 1.0, per_degree},
    {"excursion", "mm", "°", 1e3, per_degree},
}};

/// Safe for the colour-blind (Okabe & Ito); kinds of the same part share one.
const char* colour(Limit limit) {
  switch (limit) {
    case Limit::push:
    case Limit::pull:
    case Limit::torque:
      return "#0072b2";
    case Limit::column:
      return "#d55e00";
    case Limit::extending:
    case Limit::retracting:
    case Limit::motor_speed:
      return "#56b4e9";
    case Limit::pump:
      return "#009e73";
    case Limit::stroke_out:
    case Limit::stroke_in:
      return "#e69f00";
    case Limit::base_joint:
    case Limit::platform_joint:
      return "#cc79a7";
    case Limit::singular:
    case Limit::range:
      break;
  }
  return "#777777";
}

/// For the legend: one name per colour.
std::string family(Limit limit) {
  switch (limit) {
    case Limit::push:
    case Limit::pull:
      return "oil force of a leg";
    case Limit::extending:
    case Limit::retracting:
      return "valve of a leg";
    case Limit::stroke_out:
    case Limit::stroke_in:
      return "stroke of a leg";
    case Limit::base_joint:
    case Limit::platform_joint:
      return "joint angle";
    default:
      return limit_text(limit);
  }
}

/// "12.3", "1240", "3.79·10⁶": three digits, from 100,000 on with a power of ten.
std::string short_number(double value) {
  constexpr double large = 1e5;
  if (value < 1000.0) return fmt::format("{:.3g}", value);
  int power = static_cast<int>(std::floor(std::log10(value)));
  double digits = std::round(value / std::pow(10.0, power - 2));
  if (digits >= 1000.0) digits = 100.0, ++power;
  if (value < large) return fmt::format("{:.0f}", digits * std::pow(10.0, power - 2));
  constexpr std::array superscripts{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string exponent;
  for (const char c : std::to_string(power))
    exponent += superscripts.at(static_cast<std::size_t>(c - '0'));
  return fmt::format("{:.2f}·10{}", digits / 100.0, exponent);
}

/// Directions from top to bottom; bars are shares of the longest of the three directions.
std::string ability_panel(const simulation::Capability& capability, Ability ability,
                          const Cell& cell, const std::string& first_labels) {
  const auto& axis = axes.at(static_cast<std::size_t>(ability));
  std::string text = at_screen(cell) + "unset object\nunset label\n" + first_labels;
  text += fmt::format("set title {} font ',11'\n",
                      quoted(fmt::format("{} [{}, {}]", axis.title, axis.unit, axis.turn_unit)));
  if (std::isinf(capability.of(ability, 0, 0).value)) {
    for (int row = 1; row <= 6; ++row)
      text += fmt::format("set label 'no limit' at 0.05,{} left font ',9'\n", row);
    return text + "plot NaN notitle\n";
  }
  for (int half = 0; half < 2; ++half) {
    double longest = 0.0;
    for (int d = 3 * half; d < 3 * half + 3; ++d)
      for (int sign = 0; sign < 2; ++sign)
        longest = std::max(longest, capability.of(ability, d, sign).value);
    for (int d = 3 * half; d < 3 * half + 3; ++d)
      for (int sign = 0; sign < 2; ++sign) {
        const auto& reach = capability.of(ability, d, sign);
        const double end = (sign == 0 ? 1.0 : -1.0) * (longest > 0.0 ? reach.value / longest : 0.0);
        const double row = 6.0 - d;
        text += fmt::format(
            "set object rectangle from 0,{:.2f} to {:.5f},{:.2f} fc rgb '{}' fs solid noborder\n",
            row - 0.32, end, row + 0.32, colour(reach.limit));
        const double scale = half == 0 ? axis.scale : axis.turn_scale;
        text += fmt::format("set label {} at {:.5f},{:.2f} {} font ',9'\n",
                            quoted((sign == 0 ? "" : "−") + short_number(scale * reach.value) +
                                   (reach.leg >= 0 ? fmt::format("  L{}", reach.leg + 1) : "")),
                            end + (sign == 0 ? 0.03 : -0.03), row, sign == 0 ? "left" : "right");
      }
  }
  return text + "plot NaN notitle\n";
}

/// What is not of one direction: all six at once, the lowest mode and the loop that it allows.
std::vector<std::string> facts(const PoseCheck& check) {
  const auto& able = *check.capability;
  std::vector<std::string> lines{
      fmt::format("all six directions at once: {:.0f} % of forces,", 100.0 * able.combined[0]),
      fmt::format("{:.0f} % of speeds, {:.0f} % of accelerations", 100.0 * able.combined[1],
                  100.0 * able.combined[2])};
  if (check.first_resonance)
    lines.push_back(fmt::format("lowest mode (|λ|): {:.3g} Hz", *check.first_resonance / two_pi));
  if (able.gain_limit) {
    lines.push_back(fmt::format("loop gain below {:.3g} 1/s; half of it:", *able.gain_limit));
    lines.push_back(fmt::format("bandwidth {:.3g} Hz", 0.5 * *able.gain_limit / two_pi));
  }
  return lines;
}

/// A coloured box and a name for each family of limits that occurs; facts below.
std::string limit_legend(const PoseCheck& check, const Cell& cell) {
  const auto& capability = *check.capability;
  std::string text = at_screen(cell) + "unset object\nunset label\nunset title\nunset tics\n" +
                     "unset border\nunset arrow\n";
  double row = 6.0;
  text += fmt::format("set label 'What ends it:' at -1.8,{} left font ',11'\n", row);
  std::set<std::string> seen;
  for (const auto& ability : capability.reach)
    for (const auto& direction : ability)
      for (const auto& reach : direction) {
        const std::string name = family(reach.limit);
        if (std::isinf(reach.value) || !seen.insert(name).second) continue;
        row -= 0.7;
        text += fmt::format(
            "set object rectangle from -1.8,{:.2f} to -1.5,{:.2f} fc rgb '{}' fs solid noborder\n"
            "set label {} at -1.38,{:.2f} left font ',10'\n",
            row - 0.22, row + 0.22, colour(reach.limit), quoted(name), row);
      }
  row -= 0.7;
  text += fmt::format("set label 'L3: in leg 3' at -1.8,{:.2f} left font ',10'\n", row);
  row -= 0.2;
  for (const auto& line : facts(check))
    text += fmt::format("set label {} at -1.8,{:.2f} left font ',10'\n", quoted(line), row -= 0.5);
  return text + "plot NaN notitle\n";
}

}  // namespace

std::string limit_text(Limit limit) {
  constexpr std::array words{"push of a leg's oil",
                             "pull of a leg's oil",
                             "a rod buckles",
                             "valve of a leg open, extending",
                             "valve of a leg open, retracting",
                             "flow of the pump",
                             "end of a leg's stroke, out",
                             "end of a leg's stroke, in",
                             "angle of a base joint",
                             "angle of a platform joint",
                             "singular pose",
                             "nothing as far as was looked",
                             "torque of a motor",
                             "speed of a motor"};
  static_assert(words.size() == simulation::limit_count);
  return words.at(static_cast<std::size_t>(limit));
}

namespace {

/// Why there is nothing to show.
std::string why_none(const PoseCheck& check) {
  const auto fatal = std::ranges::find_if(
      check.warnings, [](const PoseWarning& warning) { return is_fatal(warning.kind); });
  if (fatal != check.warnings.end()) return warning_text(*fatal);
  const bool limited = std::ranges::all_of(check.legs, [](const LegCheck& leg) {
    return !leg.holding_torque || (leg.torque_limit && leg.largest_speed);
  });
  return limited ? "the machine does not stand there"
                 : "the motors have no limits; expected legs.screw.torque_limit and "
                   "legs.screw.speed_limit";
}

}  // namespace

void plot_capability(const PoseCheck& check, const PlotText& text, const std::string& path) {
  if (!check.capability)
    throw base::ComputationError(fmt::format("pose {}: no picture of what the machine can do: {}",
                                             check.pose.name, why_none(check)));
  const CellGrid grid(simulation::ability_count + 1);
  const std::string heading =
      titles(text.title,
             fmt::format("pose {}, from rest, one direction at a time; bars are shares of the "
                         "longest of three directions; {}",
                         check.pose.name, text.subtitle),
             grid.width(), grid.height());
  std::vector<std::string> names(direction_names.rbegin(), direction_names.rend());
  std::string body = "set multiplot\nset xrange [-2.2:2.2]\nset yrange [0.4:6.6]\nunset key\n" +
                     std::string(thin_axes) + "unset xtics\nset ytics nomirror scale 0\n" +
                     named_tics('y', names) +
                     "set arrow from 0,0.4 to 0,6.6 nohead lc rgb '#444444' lw 0.8\n"
                     "set arrow from -2.2,3.5 to 2.2,3.5 nohead lc rgb '#d0d0d0' lw 0.8\n";
  for (std::size_t k = 0; k < simulation::ability_count; ++k)
    body += ability_panel(*check.capability, static_cast<Ability>(k), grid[k],
                          k == 0 ? heading : std::string());
  body += limit_legend(check, grid[simulation::ability_count]);
  draw(path, grid.width(), grid.height(), body + "unset multiplot\n");
}

}  // namespace hydrapod::report
