/// `hydrapod modes --amplitude`: modes at given amplitudes.

#include "hydrapod/amplitude_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

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

/// What the branch has at the amplitude of `point`, the lowest frequency first.
std::vector<modal::ModeAtAmplitude> solutions(const modal::AmplitudeCurve& curve,
                                              const modal::ModeAtAmplitude& point) {
  std::vector<modal::ModeAtAmplitude> found;
  if (point.converged) found.push_back(point);
  for (const auto& other : curve.further)
    if (other.amplitude == point.amplitude) found.push_back(other);
  std::ranges::sort(found, {}, &modal::ModeAtAmplitude::omega);
  return found;
}

bool on_any_branch(const report::ModesAtAmplitudes& modes, int mode, double amplitude) {
  return std::ranges::any_of(modes.curves, [&](const modal::AmplitudeCurve& curve) {
    return curve.mode == mode &&
           std::ranges::any_of(curve.points, [&](const modal::ModeAtAmplitude& point) {
             return point.amplitude == amplitude && point.converged;
           });
  });
}

/// 0 where the mode has no branch from small motions.
double of_small_motions(const report::ModesAtAmplitudes& modes, int mode) {
  const auto curve = std::ranges::find_if(modes.curves, [&](const modal::AmplitudeCurve& one) {
    return one.mode == mode && !one.from_long_swings &&
           std::ranges::any_of(one.points, &modal::ModeAtAmplitude::converged);
  });
  return curve == modes.curves.end() ? 0.0 : curve->omega;
}

std::string change_text(double omega, double before) {
  return before > 0.0 ? fmt::format("{:+.2f} %", 100.0 * (omega / before - 1.0)) : "–";
}

std::string end_text(const modal::AmplitudeCurve& curve) {
  const auto place = [](const modal::ModeAtAmplitude& point) {
    return fmt::format("{:.3g} mm ({} Hz)", millimetres * point.amplitude, hertz(point.omega));
  };
  std::string text =
      fmt::format("Mode {}, {}{}: ", curve.mode + 1, spatial::direction_name(curve.direction),
                  curve.from_long_swings ? ", from long swings" : "");
  if (curve.omega == 0.0) return text + "there is no balance where the branch would begin.\n";
  if (!curve.turning.empty()) {
    text += "turns back at ";
    for (const auto& point : curve.turning)
      text += (&point == &curve.turning.front() ? "" : ", ") + place(point);
    text += "; ";
  }
  const auto at = place(curve.last);
  switch (curve.end) {
    case modal::BranchEnd::local:
      return text + fmt::format(
                        "at {} a local mode of the legs, the platform has less than {:g} % "
                        "of the kinetic energy.\n",
                        at, 100.0 * modal::AmplitudeOptions{}.least_platform);
    case modal::BranchEnd::turned:
      return text + "leaves the amplitudes on the side from which it came.\n";
    case modal::BranchEnd::stopped:
      return text + fmt::format("the harmonic balance does not converge beyond {}.\n", at);
    default:
      return text + fmt::format("followed to {}, the largest number of steps.\n", at);
  }
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

namespace {

std::vector<Column> columns_of(bool sleeves, bool struts) {
  std::vector<Column> columns{"mode", "<", "amplitude mm", "Hz", "change", "damping", "MAC"};
  if (sleeves) columns.push_back("sleeve mm");
  columns.push_back(struts ? "strut mm" : "piston mm");
  if (sleeves) columns.push_back("rods on guide");
  return columns;
}

/// What of the file depends on the amplitude, and what only seems to.
std::string friction_remarks(const model::Machine& machine) {
  std::string text;
  if (std::ranges::any_of(machine.legs, [](const model::Leg& leg) {
        const auto& [friction, joints] =
            std::tie(leg.hydraulics.friction, leg.hydraulics.joint_friction);
        return (friction.coulomb && *friction.coulomb > 0.0 && !friction.bristles) ||
               (joints.coulomb > 0.0 && !joints.bristle_stiffness);
      }))
    text +=
        "Mind: friction without bristles follows a smooth law, whose damping at small amplitudes "
        "is a property of that law and not of the machine (`friction.bristles`, "
        "`joint_friction.bristle_stiffness`).\n";
  if (std::ranges::none_of(machine.legs, [](const model::Leg& leg) {
        return leg.guide_sleeve.gap || leg.guide_sleeve.elastomer ||
               (leg.piston_ring && leg.piston_ring->elastomer) || leg.hydraulics.friction.coulomb ||
               leg.hydraulics.joint_friction.coulomb > 0.0;
      }))
    text += fmt::format(
        "Nothing in the file depends on the amplitude: {}no `joint_friction.coulomb`.\n",
        model::leg_type(machine) == model::LegType::strut
            ? ""
            : "no `guide_sleeve.gap`, no `elastomer`, no `friction.coulomb`, ");
  return text;
}

}  // namespace

std::string amplitudes_text(const tasks::Machine& machine, const report::ModesAtAmplitudes& modes,
                            const TableStyle& style) {
  const bool sleeves = machine.kind != dynamics::ModelKind::rigid;  // that move
  const bool struts = model::leg_type(machine.file.machine) == model::LegType::strut;
  const auto columns = columns_of(sleeves, struts);
  Table table(columns);
  bool lost = false, several = false;
  std::string notes;
  for (const auto& curve : modes.curves) {
    std::string mode = std::to_string(curve.mode + 1);
    std::string direction = spatial::direction_name(curve.direction);
    if (curve.from_long_swings) direction += ", from long swings";
    const auto none = [&](const std::string& amplitude) {
      std::vector<std::string> row{mode, direction, amplitude};
      row.resize(columns.size(), "–");
      table.add_row(row);
      mode.clear();
      direction.clear();
      lost = true;
    };
    const bool empty = std::ranges::none_of(curve.points, &modal::ModeAtAmplitude::converged);
    if (empty) none("–");
    for (const auto& point : curve.points) {
      const auto found = solutions(curve, point);
      const auto amplitude = fmt::format("{:.4g}", millimetres * point.amplitude);
      if (!empty && !curve.from_long_swings && !on_any_branch(modes, curve.mode, point.amplitude))
        none(amplitude);
      for (const auto& solution : found) {
        std::vector<std::string> row{
            mode,
            direction,
            amplitude,
            hertz(solution.omega),
            change_text(solution.omega, of_small_motions(modes, curve.mode)),
            fmt::format("{:.2f} %", 100.0 * solution.damping_ratio),
            fmt::format("{:.3f}", solution.mac)};
        if (sleeves) row.push_back(fmt::format("{:.3g}", millimetres * solution.sleeve));
        row.push_back(fmt::format("{:.3g}", millimetres * solution.piston));
        if (sleeves) row.push_back(std::to_string(solution.legs_on_guide));
        table.add_row(row);
        mode.clear();
        direction.clear();
      }
      several = several || found.size() > 1;
    }
    if (curve.end != modal::BranchEnd::beyond) notes += end_text(curve);
  }
  std::string text = heading(machine, style) + "\n" + table.text(style);
  text += fmt::format(
      "\nHarmonic balance, one mode at a time. Hz: of the balance of springs and masses, without "
      "dampers.\nThe amplitude is that of the platform joint that moves most, against the base.\n"
      "Change: against motions of a thousandth of the first "
      "amplitude. {}: largest amplitudes of the legs.\n",
      struts    ? "Strut, along the leg"
      : sleeves ? "Sleeve, piston"
                : "Piston");
  if (several)
    text +=
        "Several rows of one amplitude: the branch of the mode turns back and passes this "
        "amplitude several times. The lowest frequency is first.\n";
  if (lost) text += "–: no branch of this mode has this amplitude.\n";
  if (!notes.empty()) text += "\nWhere branches end:\n" + notes;
  return text + friction_remarks(machine.file.machine);
}

void plot_amplitudes(const tasks::Machine& machine, const report::ModesAtAmplitudes& modes,
                     const std::string& path) {
  draw(path, [&](const auto& to) {
    report::plot_modes_at_amplitudes(
        modes, machine.file.machine.name,
        fmt::format("harmonic balance, undamped; pose {}, {} model; machine: {}", machine.pose.name,
                    dynamics::name(machine.kind), report::mechanics_state_text(machine.file)),
        to);
  });
}

}  // namespace hydrapod::cli
