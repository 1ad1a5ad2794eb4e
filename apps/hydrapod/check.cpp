#include "hydrapod/command.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{.pose = ""};
  std::string format{};
  std::string output{"-"};
  std::string plot{};
};

std::string optional_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", 1e3 * *value) : "–";
}

std::string offset_text(const report::LegCheck& leg) {
  std::string text = fmt::format("{:.3f}", 1e3 * leg.sleeve_offset);
  if (leg.ring_offset) text += fmt::format(" / {:.3f}", 1e3 * *leg.ring_offset);
  if (leg.gap) text += fmt::format(" ({:.3f})", 1e3 * *leg.gap);
  return text;
}

/// "12.3 (40)": what the motor holds, and its limit.
std::string torque_text(const report::LegCheck& leg) {
  if (!leg.holding_torque) return "–";
  return leg.torque_limit ? fmt::format("{:.2f} ({:.4g})", *leg.holding_torque, *leg.torque_limit)
                          : fmt::format("{:.2f}", *leg.holding_torque);
}

std::string pressures_text(const report::LegCheck& leg) {
  return leg.cap_pressure
             ? fmt::format("{:.1f} / {:.1f}", 1e-5 * *leg.cap_pressure, 1e-5 * *leg.rod_pressure)
             : "–";
}

/// What the table of legs of a type says of each.
struct LegColumn {
  const char* title;
  std::string (*cell)(const report::LegCheck& leg, bool equilibrium);
};

std::vector<LegColumn> leg_columns(model::LegType type) {
  using Leg = report::LegCheck;
  using model::LegType;
  std::vector<LegColumn> columns{
      {"length mm", [](const Leg& leg, bool) { return fmt::format("{:.1f}", 1e3 * leg.length); }}};
  const auto add = [&](const char* title, std::string (*cell)(const Leg&, bool)) {
    columns.push_back({title, cell});
  };
  if (type != LegType::strut) {
    add("piston mm", [](const Leg& leg, bool) { return fmt::format("{:.1f}", 1e3 * leg.piston); });
    add("guided mm",
        [](const Leg& leg, bool) { return fmt::format("{:.1f}", 1e3 * leg.guided_length); });
    add("stroke left in/out mm", [](const Leg& leg, bool) {
      return optional_text(leg.retract_left) + " / " + optional_text(leg.extend_left);
    });
  }
  add(type == LegType::strut   ? "strut N/µm"
      : type == LegType::screw ? "screw N/µm"
                               : "oil spring N/µm",
      [](const Leg& leg, bool) { return fmt::format("{:.3f}", 1e-6 * leg.oil_stiffness); });
  add("axial force N", [](const Leg& leg, bool rests) {
    return rests ? fmt::format("{:.0f}", leg.axial_force) : std::string("–");
  });
  if (type == LegType::cylinder)
    add("pressures bar", [](const Leg& leg, bool) { return pressures_text(leg); });
  if (type == LegType::screw) {
    add("torque at rest (limit) N m", [](const Leg& leg, bool) { return torque_text(leg); });
    add("largest force kN", [](const Leg& leg, bool) {
      return leg.torque_limit ? fmt::format("{:.2f}", 1e-3 * leg.largest_push) : std::string("–");
    });
    add("largest speed mm/s",
        [](const Leg& leg, bool) { return optional_text(leg.largest_speed); });
  }
  if (type != LegType::strut) {
    add("static tilt mrad", [](const Leg& leg, bool rests) {
      return rests ? fmt::format("{:.2f}", 1e3 * leg.tilt) : std::string("–");
    });
    add("offset sleeve/ring (gap) mm",
        [](const Leg& leg, bool rests) { return rests ? offset_text(leg) : std::string("–"); });
  }
  add("joint tilt base/platform °", [](const Leg& leg, bool) {
    constexpr double degrees = 180.0 / std::numbers::pi;
    return fmt::format("{:.1f} / {:.1f}", leg.base_tilt * degrees, leg.platform_tilt * degrees);
  });
  return columns;
}

std::string leg_table(const report::PoseCheck& check, model::LegType type,
                      const TableStyle& style) {
  const auto columns = leg_columns(type);
  std::vector<Column> titles{"leg"};
  for (const auto& column : columns) titles.emplace_back(column.title);
  Table table(titles);
  for (int i = 0; i < model::leg_count; ++i) {
    std::vector<std::string> row{fmt::format("{}", i + 1)};
    for (const auto& column : columns) row.push_back(column.cell(check.legs[i], check.equilibrium));
    table.add_row(row);
  }
  return table.text(style);
}

/// A rod that lies on its guide does not fold as far as the limit point of seals alone.
const char* without_guide(const model::Machine& machine) {
  return std::ranges::any_of(machine.legs,
                             [](const auto& leg) { return leg.guide_sleeve.gap.has_value(); })
             ? ""
             : " without guide contact";
}

std::string buckling_text(const model::Machine& machine, const report::PoseCheck& check) {
  const auto& buckling = check.buckling;
  const double mass = machine.platform.mass;
  if (buckling.status == dynamics::BucklingStatus::found) {
    std::string text = fmt::format("Buckling load: {} in addition to the platform mass of {}",
                                   report::mass_text(buckling.payload), report::mass_text(mass));
    if (buckling.limit_point && check.lowest_at_buckling)
      return text + fmt::format(
                        "; the equilibrium ends there at a limit point{} (lowest undamped "
                        "frequency {:.2f} Hz).\n",
                        without_guide(machine), *check.lowest_at_buckling / (base::two_pi));
    return text + "; the frequency of a seal mode is zero there.\n";
  }
  const auto warned = [&](report::PoseWarning::Kind kind) {
    return std::ranges::find(check.warnings, kind, &report::PoseWarning::kind) !=
           check.warnings.end();
  };
  if (warned(report::PoseWarning::Kind::soft_screws))
    return "Buckling: the screws do not hold the platform.\n";
  const bool soft = warned(report::PoseWarning::Kind::soft_oil);
  if (soft) return "Buckling: the oil springs do not hold the platform.\n";
  if (buckling.status == dynamics::BucklingStatus::buckled)
    return fmt::format(
        "Buckling: the legs buckle under the present load; they carry {} of the platform mass of "
        "{}.\n",
        report::mass_text(mass + buckling.payload), report::mass_text(mass));
  if (machine.gravity.isZero(0.0)) return "Buckling: not computed without gravity.\n";
  if (!check.buckling_sought) return "Buckling: rigid legs do not buckle.\n";
  return "Buckling: none up to 100 times the platform mass.\n";
}

/// A letter for what ends a reach.
char letter(simulation::Limit limit) {
  static constexpr std::string_view letters = "HPCERFOIBJX-TM";
  static_assert(letters.size() == simulation::limit_count);
  return letters.at(static_cast<std::size_t>(limit));
}

/// "1.23 H / 1.31 P": along the axis and against it.
std::string both_signs(const simulation::Capability& capability, simulation::Ability ability,
                       int direction, double scale) {
  const auto& along = capability.of(ability, direction, 0);
  const auto& against = capability.of(ability, direction, 1);
  const auto number = [&](double value) {
    if (!std::isfinite(value)) return std::string("–");
    return scale * value >= 1000.0 ? fmt::format("{:.0f}", scale * value)
                                   : fmt::format("{:.3g}", scale * value);
  };
  return fmt::format("{} {} / {} {}", number(along.value), letter(along.limit),
                     number(against.value), letter(against.limit));
}

/// What the letters in the table mean.
std::string letters_text(const simulation::Capability& capability) {
  std::string text;
  for (int k = 0; k < simulation::limit_count; ++k) {
    const auto limit = static_cast<simulation::Limit>(k);
    const bool occurs = std::ranges::any_of(capability.reach, [&](const auto& ability) {
      return std::ranges::any_of(ability, [&](const auto& direction) {
        return std::ranges::any_of(direction, [&](const auto& r) { return r.limit == limit; });
      });
    });
    if (occurs)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", letter(limit),
                          report::limit_text(limit));
  }
  return "Ended by: " + text + ".\n";
}

std::string resonance_text(const report::PoseCheck& check) {
  if (!check.first_resonance) return {};
  return fmt::format("Lowest mode: {:.3g} Hz (|λ| of the damped mode).",
                     *check.first_resonance / base::two_pi);
}

std::string capability_text(const report::PoseCheck& check, const TableStyle& style) {
  using simulation::Ability;
  if (!check.capability) return check.first_resonance ? resonance_text(check) + "\n" : "";
  const auto& able = *check.capability;
  constexpr double degrees = 180.0 / std::numbers::pi;
  Table table({"from rest", "force kN, kN m", "speed m/s, °/s", "acceleration m/s², °/s²",
               "jerk m/s³, °/s³", "excursion mm, °"});
  for (int d = 0; d < 6; ++d) {
    const double turn = d < 3 ? 1.0 : degrees;
    table.add_row(
        {fmt::format("+{0} / −{0}", spatial::direction_names[static_cast<size_t>(d)]),
         both_signs(able, Ability::force, d, 1e-3), both_signs(able, Ability::velocity, d, turn),
         both_signs(able, Ability::acceleration, d, turn), both_signs(able, Ability::jerk, d, turn),
         both_signs(able, Ability::excursion, d, d < 3 ? 1e3 : degrees)});
  }
  std::string text = table.text(style) + letters_text(able);
  text += fmt::format(
      "In all six directions at once: {:.0f} % of these forces, {:.0f} % of the speeds, {:.0f} % "
      "of "
      "the accelerations.\n",
      100.0 * able.combined[0], 100.0 * able.combined[1], 100.0 * able.combined[2]);
  text += resonance_text(check);
  if (able.gain_limit)
    text += fmt::format(
        " Without integral and damping feedback, the position loop is stable below a gain of "
        "{:.3g} "
        "1/s; half of it leaves a bandwidth of {:.3g} Hz.",
        *able.gain_limit, 0.5 * *able.gain_limit / base::two_pi);
  return text + "\n";
}

std::string column_text(const report::PoseCheck& check) {
  double least = 0.0;
  int leg = -1;
  for (int i = 0; i < model::leg_count; ++i)
    if (const auto& column = check.legs[i].column;
        column && (leg < 0 || column->strength < least)) {
      least = column->strength;
      leg = i;
    }
  if (leg < 0)
    return "Rods as columns: not checked, since the file does not say how thick they are "
           "(legs.rod.diameter).\n";
  return fmt::format("Rods as columns: leg {} bears {:.4g} kN{}{}.\n", leg + 1, 1e-3 * least,
                     check.legs[leg].column->yields ? " (Johnson: the rod yields)" : " (Euler)",
                     std::isfinite(check.legs[leg].largest_push)
                         ? fmt::format("; the {} can push with {:.4g} kN",
                                       check.legs[leg].holding_torque ? "motor" : "oil",
                                       1e-3 * check.legs[leg].largest_push)
                         : "");
}

/// Of the leg that bends most.
std::string bending_text(const report::PoseCheck& check) {
  int leg = -1;
  for (int i = 0; i < model::leg_count; ++i)
    if (const auto& bow = check.legs[i].bow; bow && (leg < 0 || *bow > *check.legs[leg].bow))
      leg = i;
  if (leg < 0) return {};
  const auto& most = check.legs[leg];
  return fmt::format(
      "Bending of rods and cases: at the guide sleeve of leg {} {:.3f} mm beside the {:.3f} mm of "
      "the seal ({:.4g} mm/kN; the compression of the rod makes it {:.2f} % more).\n",
      leg + 1, 1e3 * *most.bow, 1e3 * most.sleeve_offset, 1e6 * *most.bending,
      100.0 * (most.bow_growth.value_or(1.0) - 1.0));
}

/// Legs, buckling load, columns and what the machine can do.
std::string details_text(const model::Machine& machine, const report::PoseCheck& check,
                         const TableStyle& style) {
  const bool struts = model::leg_type(machine) == model::LegType::strut;
  std::string text = leg_table(check, model::leg_type(machine), style);
  text += fmt::format(
      "Jacobian: condition {:.3g} (lengths scaled with {:.3g} m; singular from {:.0g})\n",
      check.quality.condition, check.quality.characteristic_length, kinematics::singular_condition);
  if (struts) return text + capability_text(check, style);
  text += buckling_text(machine, check);
  text += column_text(check);
  text += bending_text(check);
  text += capability_text(check, style);
  return text;
}

std::string warning_line(const std::string& text, const TableStyle& style) {
  return fmt::format("{} {}\n", styled("warning:", Style::yellow, style.colour), text);
}

std::string pose_text(const model::Machine& machine, const report::PoseCheck& check,
                      const TableStyle& style) {
  std::string text = bold("Pose " + check.pose.name, style) + "\n";
  text += details_text(machine, check, style);
  for (const auto& warning : check.warnings)
    text += warning_line(report::warning_text(warning), style);
  return text;
}

/// One line per cause, however many poses it concerns.
std::string brief_text(const std::vector<report::PoseCheck>& checks, const TableStyle& style) {
  std::string text;
  for (const auto& cause : report::warnings_by_cause(checks)) text += warning_line(cause, style);
  return text.empty() ? text : "\n" + text;
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
  const auto type = model::leg_type(machine);
  const bool struts = type == model::LegType::strut;
  text += fmt::format("mass of the platform {}, {}; {}\n", report::mass_text(machine.platform.mass),
                      struts ? "legs without mass" : "of all legs " + report::mass_text(legs),
                      report::gravity_text(machine));
  text += fmt::format("damping: {}\n", report::damping_text(machine));
  if (type == model::LegType::cylinder)
    text += fmt::format("  with hydraulics: {}\n", report::plant_damping_text(machine));
  if (style.brief)
    text += brief_text(checks, style);
  else
    for (const auto& check : checks) text += "\n" + pose_text(machine, check, style);
  text += style.detail(assumptions_text(machine, style));
  const auto verdict = report::verdict_text(checks, machine);
  const bool sound = report::is_sound(checks, machine);
  return text +
         fmt::format("\n{}\n", styled(verdict, sound ? Style::green : Style::red, style.colour));
}

void run(const Arguments& arguments) {
  const size_t format = result_format(arguments.format, arguments.output, {"table", "json"});
  auto asked = arguments.machine;
  if (asked.pose.empty()) asked.pose = "neutral";
  const auto machine = load(asked);
  if (!arguments.plot.empty() && model::leg_type(machine.file.machine) == model::LegType::strut)
    base::refuse(
        "--plot " + arguments.plot,
        "shows what cylinders can do, and the legs are struts; expected no legs.strut, or the "
        "table without --plot");
  const auto& poses = machine.file.machine.poses;
  const auto checks =
      tasks::check(machine, arguments.machine.pose.empty() ? poses : std::vector{machine.pose});
  write_result(arguments.output, format,
               format == 0 ? table_text(machine.file, checks, table_style(arguments.output))
                           : json_text(report::head_json("check", machine.file, machine.path),
                                       report::check_json(checks, machine.file.machine)));
  if (!arguments.plot.empty())
    report::plot_capability(checks.front(),
                            {.title = machine.file.machine.name,
                             .subtitle = "machine: " + report::state_text(machine.file)},
                            arguments.plot);
  if (!report::is_sound(checks, machine.file.machine))
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
       {"check machine.toml --plot capability.svg",
        "forces, speeds, accelerations and excursions by direction, and what ends them"},
       {"check machine.toml --format json", "as JSON"}});
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  command.add_options(
      {{"--pose", arguments.machine.pose,
        "One pose instead of all of the file: a name, or displacements from the neutral pose"}});
  add_model_option(command, arguments.machine);
  command.add_options(
      {{"--plot", arguments.plot,
        "Picture of what the machine can do at the pose, else at the first of the file (.svg, "
        ".png, "
        ".pdf)",
        writes},
       {"--format", arguments.format, "table or json; default: by the ending of -o, else table"},
       {"-o,--output", arguments.output, "File to write; - prints", writes}});
  command.add_extent_options();
}

}  // namespace hydrapod::cli
