#include "hydrapod/command.hpp"

#include <algorithm>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{.pose = ""};
  std::string format{};
  std::string output{"-"};
};

std::string optional_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", 1e3 * *value) : "–";
}

std::string leg_table(const report::PoseCheck& check, const TableStyle& style) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  Table table({"leg", "length mm", "piston mm", "guided mm", "stroke left in/out mm",
               "oil spring N/µm", "axial force N", "pressures bar", "static tilt mrad",
               "joint tilt base/platform °"});
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = check.legs[i];
    table.add_row(
        {fmt::format("{}", i + 1), fmt::format("{:.1f}", 1e3 * leg.length),
         fmt::format("{:.1f}", 1e3 * leg.piston), fmt::format("{:.1f}", 1e3 * leg.guided_length),
         optional_text(leg.retract_left) + " / " + optional_text(leg.extend_left),
         fmt::format("{:.3f}", 1e-6 * leg.oil_stiffness),
         check.equilibrium ? fmt::format("{:.0f}", leg.axial_force) : "–",
         leg.cap_pressure
             ? fmt::format("{:.1f} / {:.1f}", 1e-5 * *leg.cap_pressure, 1e-5 * *leg.rod_pressure)
             : "–",
         check.equilibrium ? fmt::format("{:.2f}", 1e3 * leg.tilt) : "–",
         fmt::format("{:.1f} / {:.1f}", leg.base_tilt * degrees, leg.platform_tilt * degrees)});
  }
  return table.text(style);
}

std::string buckling_text(const model::Machine& machine, const report::PoseCheck& check) {
  const auto& buckling = check.buckling;
  const double mass = machine.platform.mass;
  if (buckling.status == dynamics::BucklingStatus::found) {
    std::string text = fmt::format("Buckling load: {} in addition to the platform mass of {}",
                                   report::mass_text(buckling.payload), report::mass_text(mass));
    if (buckling.limit_point && check.lowest_at_buckling)
      return text +
             fmt::format(
                 "; the equilibrium ends there at a limit point (lowest frequency {:.2f} Hz).\n",
                 *check.lowest_at_buckling / (base::two_pi));
    return text + "; the frequency of a seal mode is zero there.\n";
  }
  if (buckling.status == dynamics::BucklingStatus::buckled)
    return fmt::format(
        "Buckling: the legs buckle under the present load; they carry {} of the platform mass of "
        "{}.\n",
        report::mass_text(mass + buckling.payload), report::mass_text(mass));
  if (machine.gravity.isZero(0.0)) return "Buckling: not computed without gravity.\n";
  if (!check.buckling_sought) return "Buckling: rigid legs do not buckle.\n";
  return "Buckling: none up to 100 times the platform mass.\n";
}

std::string pose_text(const model::Machine& machine, const report::PoseCheck& check,
                      const TableStyle& style) {
  std::string text =
      fmt::format("{}\n{}", bold("Pose " + check.pose.name, style), leg_table(check, style));
  text += fmt::format(
      "Jacobian: condition {:.3g} (lengths scaled with {:.3g} m; singular from {:.0g})\n",
      check.quality.condition, check.quality.characteristic_length, kinematics::singular_condition);
  text += buckling_text(machine, check);
  for (const auto& warning : check.warnings)
    text += fmt::format("{} {}\n", styled("warning:", Style::yellow, style.colour),
                        report::warning_text(warning));
  return text;
}

/// What simulation takes where the file says nothing.
std::string assumptions_text(const model::Machine& machine, const TableStyle& style) {
  const auto assumptions = hydraulics::hydraulic_assumptions(machine);
  if (assumptions.empty()) return {};
  std::string text = fmt::format("\n{}\n", bold("Assumed values for simulations", style));
  for (const auto& one : assumptions) text += fmt::format("  {}: {}\n", one.key, one.text);
  return text;
}

std::string table_text(const model::MachineFile& file, const std::vector<report::PoseCheck>& checks,
                       const TableStyle& style) {
  const auto& machine = file.machine;
  double legs = 0.0;
  for (const auto& leg : machine.legs) legs += leg.cylinder_case.mass + leg.rod.mass;
  std::string text = bold(machine.name, style) + "\n";
  if (!machine.description.empty()) text += machine.description + "\n";
  text += state_line(file);
  text += fmt::format("mass of the platform {}, of all legs {}; {}\n",
                      report::mass_text(machine.platform.mass), report::mass_text(legs),
                      report::gravity_text(machine));
  for (const auto& check : checks) text += "\n" + pose_text(machine, check, style);
  text += assumptions_text(machine, style);
  const auto verdict = report::verdict_text(checks);
  const bool sound = std::ranges::all_of(checks, report::is_sound);
  return text +
         fmt::format("\n{}\n", styled(verdict, sound ? Style::green : Style::red, style.colour));
}

void run(const Arguments& arguments) {
  const size_t format = result_format(arguments.format, arguments.output, {"table", "json"});
  auto asked = arguments.machine;
  if (asked.pose.empty()) asked.pose = "neutral";
  const auto machine = load(asked);
  const auto& poses = machine.file.machine.poses;
  const auto checks =
      tasks::check(machine, arguments.machine.pose.empty() ? poses : std::vector{machine.pose});
  write_output(arguments.output,
               format == 0 ? table_text(machine.file, checks, table_style(arguments.output))
                           : json_text(report::head_json("check", machine.file, machine.path),
                                       report::check_json(checks, machine.file.machine)));
  if (!std::ranges::all_of(checks, report::is_sound))
    throw base::ComputationError("the machine is not sound");
}

}  // namespace

void add_check(Command app) {
  Command command = app.add_command(
      "check", "Check a machine file; print lengths, forces and the buckling load",
      {{"check machine.toml",
        "leg lengths, remaining strokes, oil springs, static forces, buckling load"},
       {"check machine.toml --pose \"z=100 mm\"", "at another pose"},
       {"check machine.toml --set platform.mass=\"1.2 t\"", "with a heavier platform"},
       {"check machine.toml --format json", "as JSON"}});
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  command.add_options(
      {{"--pose", arguments.machine.pose,
        "One pose instead of all of the file: a name, or displacements from the neutral pose"}});
  add_model_option(command, arguments.machine);
  command.add_options(
      {{"--format", arguments.format, "table or json; default: by the ending of -o, else table"},
       {"-o,--output", arguments.output, "File to write; - prints", writes}});
}

}  // namespace hydrapod::cli
