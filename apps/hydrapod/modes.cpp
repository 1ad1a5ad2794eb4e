#include "hydrapod/command.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "hydrapod/amplitude_report.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

using simulation::SystemPoles;

constexpr int most_values = tasks::RootLocusOptions::most_values;

tasks::RootLocusOptions locus_options(const std::string& text) {
  const std::string argument = "--root-locus " + text;
  const auto reject = [&](const std::string& found) {
    base::refuse(argument, found +
                               ", expected KEY=from:to:count with numbers in SI, for instance "
                               "controller.gain=5:80:16");
  };
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) reject("no key");
  std::array<double, 3> numbers{0.0, 0.0, 11.0};
  std::size_t count = 0;
  for (const auto& part : base::split(std::string_view(text).substr(equals + 1), ":")) {
    const auto number = base::read_quantity(part, "1");
    if (count == numbers.size()) reject("more than three numbers");
    if (!number.ok()) reject(fmt::format("'{}' is not a plain number", part));
    numbers[count++] = number.value;
  }
  if (count < 2) reject("only one number");
  const int steps = static_cast<int>(std::clamp(numbers[2], -1.0, 1e6));
  if (steps != numbers[2] || steps < 2 || steps > most_values)
    reject(fmt::format("the count is {:g}; it must be a whole number from 2 to {}", numbers[2],
                       most_values));
  if (numbers[0] == numbers[1]) reject("both ends are equal");
  return {.key = text.substr(0, equals), .from = numbers[0], .to = numbers[1], .count = steps};
}

constexpr double drift = simulation::slowest_growth;

/// Without a controller drifting is what a platform on valves does, and no fault.
std::string open_verdict(const SystemPoles& poles) {
  const double rate = poles.largest_real;
  if (rate < -drift || rate > drift) return report::verdict_text(poles);
  constexpr double none = 1e-9;
  return rate > none
             ? fmt::format(
                   "without a controller the pose is not held: the platform drifts with {:.2g} 1/s",
                   rate)
             : std::string("without a controller the pose is not held");
}

/// "UNSTABLE": it grows. Of a sampled loop its exact poles decide, and the table says where the
/// pole of the approximation beside it differs.
const char* growth_mark(const simulation::SystemPole& pole, bool drifts) {
  if (drifts) return "drift";
  const bool approximation_grows = simulation::grows(pole.pole);
  if (!pole.stable) return approximation_grows ? "UNSTABLE" : "UNSTABLE, sampled";
  return approximation_grows ? "stable, sampled" : "";
}

/// Table of poles, ascending in frequency.
std::string pole_table(const SystemPoles& poles, bool closed, const TableStyle& style) {
  std::vector<const simulation::SystemPole*> order;
  for (const auto& pole : poles.poles) order.push_back(&pole);
  std::ranges::stable_sort(order, {}, &simulation::SystemPole::omega);
  Table table({"pole", "Hz", "rad/s", "damping", "Re 1/s", "<", "<participation"});
  for (std::size_t row = 0; row < order.size(); ++row) {
    const auto& pole = *order[row];
    const bool drifts = !closed && pole.omega < drift;
    table.add_row(
        {std::to_string(row + 1), pole.oscillates() && !drifts ? hertz(pole.omega) : "–",
         fmt::format("{:.4g}", pole.omega),
         pole.oscillates() && !drifts ? fmt::format("{:.2f} %", 100.0 * pole.damping_ratio) : "–",
         fmt::format("{:.4g}", pole.pole.real()), growth_mark(pole, drifts),
         report::participation_text(pole)});
  }
  return table.text(style) +
         style.detail(poles.sampled.empty()
                          ? "Hz and rad/s: |λ| of the poles.\n"
                          : "Hz and rad/s: |λ| of the poles. Poles are those of the approximation; "
                            "UNSTABLE is a pole of the sampled loop that grows.\n");
}

std::string system_heading(const tasks::Machine& machine, const report::System& system,
                           const TableStyle& style) {
  const auto& linear = system.linear;
  const std::string title =
      fmt::format("{}, pose {}: {} model", bold(machine.file.machine.name, style),
                  machine.pose.name, dynamics::name(machine.kind));
  const std::string damping =
      fmt::format("damping: {}\n", report::plant_damping_text(machine.file.machine));
  if (!system.closed && model::leg_type(machine.file.machine) == model::LegType::screw)
    return fmt::format(
        "{} with free motors, without controller, {} states\n{}the motors turn freely about rest; "
        "inputs are their torques\ndamping: dampers of the file, Rayleigh's damping, viscous "
        "friction of the motors; a modal ratio damps nothing here\n",
        title, linear.A.rows(), state_line(machine.file));
  if (!system.closed)
    return fmt::format(
        "{} with hydraulics, without controller, {} states\n{}the valves are held at their rest "
        "positions; inputs are the drives\n{}",
        title, linear.A.rows(), state_line(machine.file), damping);
  return fmt::format(
      "{} with {} and controller, {} states\n{}sampled every {:.4g} ms; delay and hold of "
      "{:.4g} ms as Padé {}/{} (stability is that of the sampled loop)\n{}",
      title,
      model::leg_type(machine.file.machine) == model::LegType::screw ? "electric drives"
                                                                     : "hydraulics",
      linear.A.rows(), state_line(machine.file), 1e3 * linear.sample_time, 1e3 * linear.delay,
      linear.pade_order, linear.pade_order, damping);
}

/// Of the oscillations that the platform takes part in.
const simulation::SystemPole* least_damped(const SystemPoles& poles) {
  constexpr double felt = 0.05;  // participation of the platform
  const simulation::SystemPole* least = nullptr;
  for (const auto& pole : poles.poles) {
    double platform = 0.0;
    for (int i = 0; i < 6; ++i) platform += pole.parts[static_cast<std::size_t>(i)];
    if (!pole.oscillates() || platform < felt) continue;
    if (least == nullptr || pole.damping_ratio < least->damping_ratio) least = &pole;
  }
  return least;
}

std::string locus_table(const report::RootLocus& locus, const TableStyle& style) {
  Table table({{locus.key},
               "<stable",
               "largest |z|",
               "largest Re 1/s",
               "Hz",
               "lowest damping",
               "Hz",
               "<participation"});
  for (std::size_t k = 0; k < locus.values.size(); ++k) {
    const auto& poles = locus.poles[k];
    const auto* least = least_damped(poles);
    const auto& first = poles.poles.front();
    table.add_row({fmt::format("{:.6g}", locus.values[k]), poles.sampled_stable ? "yes" : "NO",
                   fmt::format("{:.6f}", poles.largest_modulus),
                   fmt::format("{:.4g}", first.pole.real()),
                   first.oscillates() ? hertz(first.omega) : "–",
                   least != nullptr ? fmt::format("{:.3f} %", 100.0 * least->damping_ratio) : "–",
                   least != nullptr ? hertz(least->omega) : "–",
                   least != nullptr ? report::participation_text(*least) : ""});
  }
  std::string text = table.text(style);
  const bool sampled = std::ranges::any_of(
      locus.poles, [](const SystemPoles& poles) { return !poles.sampled.empty(); });
  text += style.detail(sampled ? "Stable and |z|: of the sampled loop, exact. Re and Hz (|λ|): of "
                                 "the approximation.\n"
                               : "Hz: |λ| of the poles.\n");
  for (const double limit : locus.limits)
    text += fmt::format("\nlimit of stability: {} = {:.6g}\n", locus.key, limit);
  return text;
}

std::string locus_output(const tasks::Machine& machine, const tasks::RootLocusOptions& options,
                         const std::string& plot, std::size_t format, const TableStyle& style) {
  const auto locus = with_progress("root locus", [&](const numerics::Progress& progress) {
    return tasks::root_locus(machine, options, progress);
  });
  const auto& name = machine.file.machine.name;
  draw(plot, [&](const auto& path) {
    report::plot_root_locus(locus, name,
                            fmt::format("root locus over {}; pose {}, {} model; machine: {}",
                                        locus.key, machine.pose.name, dynamics::name(machine.kind),
                                        report::state_text(machine.file)),
                            path);
  });
  if (format == 2) return report::root_locus_csv(locus);
  if (format == 0)
    return fmt::format("{}, pose {}: poles over {}\n{}\n", bold(name, style), machine.pose.name,
                       locus.key, state_line(machine.file)) +
           locus_table(locus, style);
  return json_text(head_of_model("root_locus", machine), report::root_locus_json(locus), -1);
}

/// `hydrapod modes --system`: poles of mechanics, hydraulics and controller together.
struct SystemArguments {
  bool system{};
  bool open_loop{};          ///< without the controller
  std::string root_locus{};  ///< `KEY=from:to:count`
  int pade{simulation::default_pade_order};
  std::string plot{};  ///< of the root locus
};

void add_system_options(Command command, SystemArguments& arguments) {
  command.add_options(
      {{"--system", arguments.system, "Poles of mechanics, hydraulics, controller and delay"},
       {"--open-loop", arguments.open_loop,
        "The same without the controller; inputs are the drives"},
       {"--root-locus", arguments.root_locus,
        "KEY=from:to:count: these poles as functions of one parameter of the file (SI)",
        shown_as("KEY=from:to:count")},
       {"--pade", arguments.pade, "Order of the approximation of the delay, 0 (no delay) to 8",
        range(0, 8)},
       {"--plot", arguments.plot,
        "Picture of the root locus, or of --amplitude, .svg, .png or .pdf (needs gnuplot)",
        writes}});
}

/// What `hydrapod modes` prints with --system, --open-loop or --root-locus; `format` is that of
/// modes: 0 table, 1 JSON, 2 CSV.
std::string system_modes_text(const MachineArguments& arguments, const SystemArguments& asked,
                              std::size_t format, const TableStyle& style) {
  const tasks::SystemOptions options{.closed = !asked.open_loop, .pade_order = asked.pade};
  if (!asked.root_locus.empty()) {
    auto locus = locus_options(asked.root_locus);
    locus.system = options;
    if (!asked.plot.empty()) report::require_picture_ending(asked.plot);
    return locus_output(load(arguments), locus, asked.plot, format, style);
  }
  const auto machine = load(arguments);
  const auto system = tasks::system(machine, options);
  if (format == 2) return report::system_poles_csv(system.poles);
  if (format == 0)
    return system_heading(machine, system, style) + "\n" +
           pole_table(system.poles, system.closed, style) + "\n" +
           (system.closed ? report::verdict_text(system.poles) : open_verdict(system.poles)) + "\n";
  return json_text(head_of_model("system", machine), report::system_json(system));
}

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> poses{};
  std::string all_poses{};
  std::string amplitude{};
  std::string format{};
  std::string output{"-"};
  bool matrices{};
  SystemArguments system{};
};

std::string mode_json(const tasks::Machine& machine, const modal::ModeTable& table, bool matrices) {
  auto json = report::modes_json(table);
  if (matrices) json["matrices"] = report::matrices_json(table);
  return json_text(report::head_json("modes", machine), json);
}

std::string table_text(const tasks::Machine& machine, const modal::ModeTable& table,
                       const TableStyle& style) {
  std::optional<modal::ModeTable> before;
  std::string note;
  try {
    before = tasks::modes_without_overrides(machine);
  } catch (const std::exception&) {  // it may be unsound or buckled, and --set mends it
    note = "\nthe change by --set is not shown: without it the file has no modes at this pose\n";
  }
  return heading(machine, style) + "\n" + mode_text(table, before ? &*before : nullptr, style) +
         style.detail(report::axial_energy_text(machine.file.machine)) + note + "\n" +
         report::answer_text(table);
}

/// Those asked for; all of a file that has one are a mistake.
std::vector<model::NamedPose> asked_poses(const Arguments& arguments,
                                          const model::Machine& machine) {
  auto poses = poses_of(arguments.poses, arguments.all_poses, machine);
  if (!arguments.all_poses.empty() && poses.size() < 2)
    base::refuse("--poses all", fmt::format("the file has one pose, \"{}\"; leave --poses out or "
                                            "add --pose",
                                            poses.front().name));
  return poses;
}

/// Frequencies by pose, modes followed by shape.
std::string poses_table(const report::ModesAtPoses& modes, const TableStyle& style) {
  std::vector<Column> columns{"<motion, compliance"};
  for (const auto& pose : modes.poses) columns.emplace_back(pose.name + " Hz");
  columns.emplace_back("lowest MAC");
  Table table(columns);
  for (const auto& followed : modes.followed) {
    std::vector<std::string> cells{""};
    double lowest = 1.0;
    bool any = false;
    for (std::size_t k = 0; k < modes.poses.size(); ++k) {
      const int mode = followed.mode[k];
      if (mode < 0) {
        cells.emplace_back("–");
        continue;
      }
      const auto& entry = modes.tables[k].real.modes[static_cast<std::size_t>(mode)];
      if (cells.front().empty()) cells.front() = entry.label;
      cells.push_back(fmt::format("{} ({})", hertz(entry.mode.omega), mode + 1));
      if (!followed.mac[k]) continue;
      any = true;
      lowest = std::min(lowest, *followed.mac[k]);
    }
    cells.push_back(any ? fmt::format("{:.2f}", lowest) : "–");
    table.add_row(cells);
  }
  return table.text(style) +
         style.detail(
             std::string("\n(number of the mode at its pose.) A row is one mode, followed "
                         "by its shape from pose to pose; –: no mode of that shape.\nHz: ") +
             damped_frequencies);
}

void run_at_poses(const Arguments& arguments, const tasks::Machine& machine,
                  const std::vector<model::NamedPose>& poses, size_t format) {
  const auto& system = arguments.system;
  if (system.system || system.open_loop || !system.root_locus.empty())
    base::refuse(arguments.all_poses.empty() ? "--pose" : "--poses " + arguments.all_poses,
                 "poles of the system are at one pose; give --pose once");
  if (arguments.matrices) base::refuse("--matrices", "are of one pose; give --pose once");
  const auto modes = tasks::modes_at_poses(machine, poses);
  const auto style = table_style(arguments.output);
  write_result(arguments.output, format,
               format == 0
                   ? fmt::format("{}, {} model\n{}\n", bold(machine.file.machine.name, style),
                                 dynamics::name(machine.kind), mechanics_state_line(machine.file)) +
                         poses_table(modes, style)
               : format == 1 ? json_text(
                                   [&] {
                                     auto head = head_of_model("modes_at_poses", machine);
                                     head.erase("pose");
                                     return head;
                                   }(),
                                   report::modes_at_poses_json(modes))
                             : report::modes_at_poses_csv(modes));
}

void run_at_amplitudes(const Arguments& arguments, std::size_t format) {
  const auto& system = arguments.system;
  if (system.system || system.open_loop || !system.root_locus.empty())
    base::refuse("--amplitude",
                 "modes at amplitudes are those of the mechanics; leave --system out");
  if (arguments.matrices)
    base::refuse("--matrices", "are those of small motions; leave --amplitude out");
  const auto amplitudes = amplitudes_of(arguments.amplitude);
  if (!system.plot.empty()) {
    report::require_picture_ending(system.plot);
    if (amplitudes.size() == 1)
      base::refuse("--plot " + system.plot, "needs several amplitudes: --amplitude FROM:TO:COUNT");
  }
  const auto machine = load(arguments.machine);
  const auto modes = with_progress("modes at amplitudes", [&](const numerics::Progress& progress) {
    return tasks::modes_at_amplitudes(machine, amplitudes, progress);
  });
  if (!system.plot.empty()) plot_amplitudes(machine, modes, system.plot);
  write_result(arguments.output, format,
               format == 0   ? amplitudes_text(machine, modes, table_style(arguments.output))
               : format == 1 ? json_text(head_of_model("modes_at_amplitudes", machine),
                                         report::modes_at_amplitudes_json(modes))
                             : report::modes_at_amplitudes_csv(modes));
}

void run(const Arguments& given) {
  Arguments arguments = given;
  if (arguments.poses.size() == 1 && arguments.all_poses.empty())
    arguments.machine.pose = arguments.poses.front();
  const size_t format = result_format(arguments.format, arguments.output, {"table", "json", "csv"});
  const auto& system = arguments.system;
  const auto style = table_style(arguments.output);
  if (arguments.poses.size() > 1 || !arguments.all_poses.empty()) {
    if (!arguments.amplitude.empty())
      base::refuse("--amplitude", "modes at amplitudes are at one pose; give --pose once");
    const auto machine = load(arguments.machine);
    const auto poses = asked_poses(arguments, machine.file.machine);
    if (!system.plot.empty()) base::refuse("--plot " + system.plot, "needs --root-locus");
    return run_at_poses(arguments, machine, poses, format);
  }
  if (!arguments.amplitude.empty()) return run_at_amplitudes(arguments, format);
  if (!system.plot.empty() && system.root_locus.empty())
    base::refuse("--plot " + system.plot,
                 "needs --root-locus or --amplitude; `hydrapod report` shows moving modes");
  if (system.system || system.open_loop || !system.root_locus.empty()) {
    if (arguments.matrices)
      base::refuse("--matrices", "M, K and C are those of the mechanics; leave --system out");
    return write_result(arguments.output, format,
                        system_modes_text(arguments.machine, system, format, style));
  }
  if (system.pade != simulation::default_pade_order)
    base::refuse(fmt::format("--pade {}", system.pade),
                 "is of the controller's delay; add --system or --root-locus");
  if (arguments.matrices && format != 1)
    base::refuse("--matrices", "matrices are part of the JSON; add --format json");
  const auto machine = load(arguments.machine);
  const auto table = tasks::modes(machine);
  write_result(arguments.output, format,
               format == 0   ? table_text(machine, table, style)
               : format == 1 ? mode_json(machine, table, arguments.matrices)
                             : mode_csv(table));
}

}  // namespace

void add_modes(Command app) {
  Command command = app.add_command(
      "modes",
      "Modes of the machine with rigid and with flexible legs; poles with hydraulics and "
      "controller",
      {{"modes machine.toml", "frequencies, motion, energy shares"},
       {"modes machine.toml --pose \"z=100 mm, ry=5 deg\"", "at another pose"},
       {"modes machine.toml --pose neutral --pose \"z=100 mm\"",
        "at several poses, modes followed by their shape; --poses all: those of the file"},
       {"modes machine.toml --model rigid", "the six modes of the rigid-leg model"},
       {"modes machine.toml --set legs.guide_sleeve.stiffness=\"2e6 N/m\"",
        "effect of stiffer seals"},
       {"modes machine.toml --system", "poles with hydraulics and controller; stability"},
       {"modes machine.toml --open-loop", "the same without the controller"},
       {"modes machine.toml --root-locus controller.gain=5:80:16 --plot locus.svg",
        "these poles as functions of the gain"},
       {"modes machine.toml --amplitude \"0.01 mm:5 mm:9\" --plot amplitude.svg",
        "frequencies over the amplitude: guide rings, elastomers, friction"},
       {"modes machine.toml --format json --matrices -o modes.json", "all results as JSON"}});
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  command.add_options(
      {{"--pose", arguments.poses,
        "Pose of the file, or displacements from the neutral pose: \"z=50 mm, ry=5 deg\"; several "
        "times: one table, modes followed by their shape; default: neutral",
        one_each},
       {"--poses", arguments.all_poses, "all: every pose of the file"},
       {"--amplitude", arguments.amplitude,
        "Modes at these amplitudes of the platform's joints, by harmonic balance: \"1 mm\", or "
        "FROM:TO:COUNT with equal ratios",
        shown_as("FROM:TO:COUNT")}});
  add_model_option(command, arguments.machine);
  command.add_options(
      {{"--format", arguments.format,
        "table, json or csv; default: by the ending of -o, else table"},
       {"--matrices", arguments.matrices, "Put M, K and C into the JSON (with --format json)"}});
  add_system_options(command, arguments.system);
  command.add_options({{"-o,--output", arguments.output, "File to write; - prints", writes}});
  command.add_extent_options();
}

}  // namespace hydrapod::cli
