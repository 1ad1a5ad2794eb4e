/// `hydrapod modes --amplitude`: modes at given amplitudes.

#include "hydrapod/amplitude_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/command.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::cli {

namespace {

constexpr int most_amplitudes = 1000;
constexpr double millimetres = 1e3;

double amplitude_of(const std::string& text, const std::string& argument) {
  const auto read = base::read_quantity(text, "m");
  if (!read.ok()) base::refuse(argument, fmt::format("'{}': {}", text, read.problem));
  if (!(read.value > 0.0) || !std::isfinite(read.value))
    base::refuse(argument, fmt::format("{:g} m, expected an amplitude above 0, for instance 1 mm",
                                       read.value));
  return read.value;
}

}  // namespace

std::vector<double> amplitudes_of(const std::string& text) {
  const std::string argument = "--amplitude " + text;
  const auto parts = base::split(text, ":");
  if (parts.size() == 1) return {amplitude_of(std::string(parts[0]), argument)};
  if (parts.size() != 3)
    base::refuse(argument,
                 "expected one amplitude, \"1 mm\", or FROM:TO:COUNT, \"0.01 mm:5 mm:9\"");
  const double from = amplitude_of(std::string(parts[0]), argument);
  const double to = amplitude_of(std::string(parts[1]), argument);
  const auto count = base::read_quantity(parts[2], "1");
  if (!count.ok() || count.value != std::floor(count.value) || count.value < 2 ||
      count.value > most_amplitudes)
    base::refuse(argument, fmt::format("the count is '{}', expected a whole number from 2 to {}",
                                       parts[2], most_amplitudes));
  if (!(from < to))
    base::refuse(argument,
                 fmt::format("from {:g} m to {:g} m, expected the smaller one first", from, to));
  return response::log_space(from, to, static_cast<int>(count.value));
}

std::string amplitudes_text(const tasks::Machine& machine, const report::ModesAtAmplitudes& modes,
                            const TableStyle& style) {
  Table table({"mode", "<", "amplitude mm", "Hz", "change", "damping", "MAC", "sleeve mm",
               "piston mm", "rods on guide"});
  bool lost = false;
  for (const auto& curve : modes.curves)
    for (const auto& point : curve.points) {
      const bool first = &point == &curve.points.front();
      const std::string amplitude = fmt::format("{:.4g}", millimetres * point.amplitude);
      const std::string mode = first ? std::to_string(curve.mode + 1) : "";
      const std::string direction =
          first ? spatial::direction_name(curve.direction) : std::string();
      lost = lost || !point.converged;
      if (!point.converged) {
        table.add_row({mode, direction, amplitude, "–", "–", "–", "–", "–", "–", "–"});
        continue;
      }
      table.add_row(
          {mode, direction, amplitude, hertz(point.omega),
           fmt::format("{:+.2f} %", 100.0 * (point.omega / curve.omega - 1.0)),
           fmt::format("{:.2f} %", 100.0 * point.damping_ratio), fmt::format("{:.3f}", point.mac),
           fmt::format("{:.3g}", millimetres * point.sleeve),
           fmt::format("{:.3g}", millimetres * point.piston), std::to_string(point.legs_on_guide)});
    }
  std::string text = heading(machine, style) + "\n" + table.text(style);
  text +=
      "\nHarmonic balance, one mode at a time. The amplitude is that of the platform joint that "
      "moves "
      "most.\nChange: against motions of a thousandth of the first amplitude. Sleeve, piston: "
      "largest amplitudes "
      "of the legs.\n";
  if (lost)
    text +=
        "–: the mode cannot be followed to this amplitude, or the harmonic balance does not end.\n";
  if (std::ranges::none_of(machine.file.machine.legs, [](const model::Leg& leg) {
        return leg.guide_sleeve.gap || leg.guide_sleeve.elastomer ||
               (leg.piston_ring && leg.piston_ring->elastomer) || leg.hydraulics.friction.coulomb;
      }))
    text +=
        "Nothing in the file depends on the amplitude: no `guide_sleeve.gap`, no `elastomer`, no "
        "`friction.coulomb`.\n";
  return text;
}

void plot_amplitudes(const tasks::Machine& machine, const report::ModesAtAmplitudes& modes,
                     const std::string& path) {
  draw(path, [&](const auto& to) {
    report::plot_modes_at_amplitudes(
        modes, machine.file.machine.name,
        fmt::format("modes over the amplitude, by harmonic balance; pose {}, {} model; machine: {}",
                    machine.pose.name, dynamics::name(machine.kind),
                    report::state_text(machine.file)),
        to);
  });
}

}  // namespace hydrapod::cli
