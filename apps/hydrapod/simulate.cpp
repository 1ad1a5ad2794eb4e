#include "hydrapod/command.hpp"
#include "hydrapod/reproduction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/base/units.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/signal_help.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::cli {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;
using spatial::direction_names;

std::string joined(const std::vector<std::string>& parts, const char* between) {
  return fmt::format("{}", fmt::join(parts, between));
}

/// Lengths in mm and angles in degrees.
std::string in_direction(double value, int direction, const char* format = "{:.4g}") {
  return fmt::format(fmt::runtime(format), value * (direction < 3 ? 1e3 : degrees));
}

/// What the machine does not do by itself: "step z=5 mm", "wrench sine x=500 N, …".
std::string excitation_text(const report::Simulation& s) {
  std::vector<std::string> parts = s.commands;
  for (const auto& wrench : s.wrench) parts.push_back("wrench " + wrench);
  for (int i = 0; i < 6; ++i)
    if (const double d = s.loop.initial[i]; d != 0.0)
      parts.push_back(fmt::format("released at {}={} {}", direction_names[static_cast<size_t>(i)],
                                  in_direction(d, i), i < 3 ? "mm" : "deg"));
  return parts.empty() ? "rest" : joined(parts, " + ");
}

bool has_struts(const model::Machine& machine) {
  return model::leg_type(machine) == model::LegType::strut;
}

const char* kind_text(dynamics::ModelKind kind) {
  switch (kind) {
    case dynamics::ModelKind::rigid:
      return "rigid legs";
    case dynamics::ModelKind::guide:
      return "legs with compliant guide sleeves";
    case dynamics::ModelKind::full:
      break;
  }
  return "legs with compliant guide sleeves and piston rings";
}

std::string settled_text(const report::Simulation& s, int i) {
  if (!s.settling.step[static_cast<std::size_t>(i)]) return "–";
  const auto time = simulation::settling_time(s.summary, s.settling, i);
  return time ? fmt::format("{:.3f} s", *time) : "not settled";
}

/// Without commands there are no errors.
std::string motion_table(const report::Simulation& s, const TableStyle& style) {
  Table table({"<", "<unit", "moved", "RMS", "at the end"});
  for (int i = 0; i < 6; ++i) {
    const auto& r = s.summary;
    table.add_row({direction_names[static_cast<std::size_t>(i)], i < 3 ? "mm" : "deg",
                   in_direction(r.peak_motion[i], i), in_direction(r.rms_error[i], i, "{:.3g}"),
                   in_direction(-r.final_error[i], i, "{:.3g}")});
  }
  return table.text(style);
}

std::string direction_table(const report::Simulation& s, const TableStyle& style) {
  if (s.loop.actuators != simulation::Actuators::controlled) return motion_table(s, style);
  const bool steps = std::any_of(s.settling.step.begin(), s.settling.step.end(),
                                 [](const auto& time) { return time.has_value(); });
  std::vector<Column> columns{"<",         "<unit",      "commanded", "moved",
                              "RMS error", "peak error", "at the end"};
  if (steps) columns.push_back("within 2 % after");
  Table table(columns);
  for (int i = 0; i < 6; ++i) {
    const auto& r = s.summary;
    std::vector<std::string> row{
        direction_names[static_cast<std::size_t>(i)], i < 3 ? "mm" : "deg",
        in_direction(r.peak_command[i], i),           in_direction(r.peak_motion[i], i),
        in_direction(r.rms_error[i], i, "{:.3g}"),    in_direction(r.peak_error[i], i, "{:.3g}"),
        in_direction(r.final_error[i], i, "{:.3g}")};
    if (steps) row.push_back(settled_text(s, i));
    table.add_row(row);
  }
  return table.text(style);
}

std::string leg_table(const report::Simulation& s, const TableStyle& style) {
  std::vector<Column> columns{"<leg",       "piston from mm", "to mm",          "stroke used",
                              "left in mm", "left out mm",    "peak speed mm/s"};
  const bool drives = s.loop.actuators != simulation::Actuators::springs;
  if (drives) columns.insert(columns.end(), {"peak drive", "at its limit"});
  const bool motors = !s.trace.torque.empty();
  if (motors) columns.insert(columns.end(), {"peak torque N m", "at its limit"});
  Table table(columns);
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& r = s.summary;
    const auto& stops = s.stops[i];
    const double used = (r.piston_high[i] - r.piston_low[i]) / (stops.high - stops.low);
    const bool ends = std::isfinite(stops.low) && std::isfinite(stops.high);
    const auto left = [&](double way) { return ends ? fmt::format("{:.1f}", 1e3 * way) : "–"; };
    const double limited = static_cast<double>(r.limited[i]) / static_cast<double>(r.samples);
    std::vector<std::string> row{std::to_string(i + 1),
                                 fmt::format("{:.2f}", 1e3 * r.piston_low[i]),
                                 fmt::format("{:.2f}", 1e3 * r.piston_high[i]),
                                 ends ? fmt::format("{:.2g} %", 100.0 * used) : "–",
                                 left(r.piston_low[i] - stops.low),
                                 left(stops.high - r.piston_high[i]),
                                 fmt::format("{:.3g}", 1e3 * r.peak_speed[i])};
    if (drives) {
      row.push_back(fmt::format("{:.3g} %", 100.0 * r.peak_drive[i]));
      row.push_back(fmt::format("{:.2g} %", 100.0 * limited));
    }
    if (motors) {
      row.push_back(fmt::format("{:.3g}", r.peak_torque[i]));
      row.push_back(fmt::format("{:.2g} %", 100.0 * static_cast<double>(r.torque_limited[i]) /
                                                static_cast<double>(r.samples)));
    }
    table.add_row(row);
  }
  return table.text(style);
}

/// Of legs that are struts: their lengths.
std::string strut_table(const report::Simulation& s, const TableStyle& style) {
  Table table({"<leg", "length from mm", "to mm", "peak speed mm/s"});
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& r = s.summary;
    table.add_row({std::to_string(i + 1), fmt::format("{:.2f}", 1e3 * r.piston_low[i]),
                   fmt::format("{:.2f}", 1e3 * r.piston_high[i]),
                   fmt::format("{:.3g}", 1e3 * r.peak_speed[i])});
  }
  return table.text(style);
}

/// The first few events, one line each.
std::string event_text(const report::Simulation& s) {
  constexpr std::size_t most = 5;
  std::string text;
  const auto& events = s.summary.events;
  for (std::size_t k = 0; k < std::min(most, events.size()); ++k)
    text +=
        fmt::format("leg {} at {:.4f} s: {} {}\n", events[k].leg + 1, events[k].time,
                    simulation::Plant::name(events[k].event), events[k].begins ? "begins" : "ends");
  if (events.size() > most) text += fmt::format("… and {} more events\n", events.size() - most);
  return text;
}

/// One number where all six agree, else all six.
std::string six(const spatial::Vector6& values, const char* unit) {
  constexpr double same = 1e-6;
  if ((values.array() - values[0]).abs().maxCoeff() <= same * std::abs(values[0]))
    return fmt::format("{:.4g} {}", values[0], unit);
  std::string text;
  for (int i = 0; i < 6; ++i) text += fmt::format("{}{:.4g}", i == 0 ? "" : ", ", values[i]);
  return text + " " + unit;
}

std::string actuators_text(const model::Machine& machine, const report::Simulation& s) {
  if (s.loop.actuators == simulation::Actuators::springs)
    return model::leg_type(machine) == model::LegType::cylinder ? "oil springs, no hydraulics"
           : has_struts(machine)                                ? "plain struts"
                                                                : "motors locked";
  const bool electric = model::leg_type(machine) == model::LegType::screw;
  if (s.loop.actuators == simulation::Actuators::held)
    return electric ? "motors held at the speed 0, no controller" : "valves held, no controller";
  return fmt::format("gain {}, {} feedback", six(s.controller.gain, "1/s"),
                     s.controller.feedback == model::DampingFeedback::none       ? "no"
                     : s.controller.feedback == model::DampingFeedback::pressure ? "pressure"
                                                                                 : "acceleration");
}

/// What a plot says about the run in one line.
std::string simulation_subtitle(const tasks::Machine& machine, const report::Simulation& s) {
  const auto& pose = machine.pose;
  return fmt::format("pose {}; {}; {}; {}", pose.name, excitation_text(s), kind_text(s.loop.kind),
                     actuators_text(machine.file.machine, s));
}

/// The controller's numbers, with where they come from.
std::string controller_text(const model::Machine& machine, const control::ControllerParameters& p,
                            double lowest_oil_mode) {
  const auto& given = machine.controller;
  Table table({"<", "<", "<"});
  const auto row = [&](const char* key, std::string value, std::string from) {
    table.add_row({key, std::move(value), std::move(from)});
  };
  const auto& screw = machine.legs[0].screw;
  const std::string mode =
      fmt::format("{:.4g} rad/s, the lowest {}", lowest_oil_mode,
                  screw ? "mode of the platform with locked motors" : "oil mode");
  row("space", p.space == model::ControlSpace::pose ? "pose" : "leg", "");
  const bool by_pressure = p.feedback == model::DampingFeedback::pressure;
  row("gain", six(p.gain, "1/s"),
      given.gain || given.bandwidth ? "" : (by_pressure ? "0.3 of " : "0.05 of ") + mode);
  row("integral_time", p.integral_time > 0.0 ? fmt::format("{:.4g} s", p.integral_time) : "none",
      given.integral_time ? "" : "8 / smallest gain");
  row("velocity_feedforward", fmt::format("{:.4g}", p.velocity_feedforward), "");
  if (p.feedback == model::DampingFeedback::none) {
    row("feedback", "none",
        screw && given.feedback != model::DampingFeedback::none
            ? "electric cylinders have no pressures"
            : "");
  } else {
    row("feedback", by_pressure ? "pressure" : "acceleration", "");
    row("feedback_gain", six(p.feedback_gain, by_pressure ? "m/(N s)" : "s"),
        given.feedback_gain ? ""
                            : fmt::format("damping ratio {:.3g} at {}", given.feedback_damping,
                                          by_pressure ? mode : "the highest oil mode"));
    row("feedback_corner", fmt::format("{:.4g} rad/s", p.feedback_corner),
        given.feedback_corner ? "" : "0.1 of " + mode);
  }
  row("sample_time", fmt::format("{:.4g} ms", 1e3 * p.sample_time), "");
  row("delay", fmt::format("{:.4g} samples", p.delay), "");
  const auto speeds = control::full_drive_speeds(p.axes[0], p.axes[0].load);
  row("speed of leg 1",
      fmt::format("{:.3g} m/s out, {:.3g} m/s in", speeds.extending, speeds.retracting),
      screw ? "at full drive" : "at full drive, under its load at rest");
  if (screw) {
    const auto loop = simulation::speed_loop(*screw);
    row("speed loop of leg 1",
        fmt::format("{:.4g} Hz, {:.4g} N m s/rad, integral time {:.4g} ms",
                    loop.bandwidth / base::two_pi, loop.gain, 1e3 * loop.integral_time),
        "");
  }
  return table.text();
}

/// Machine, commands, controller and how the run ended; then per direction and per leg what
/// happened.
std::string simulation_text(const tasks::Machine& machine, const report::Simulation& s,
                            const TableStyle& style) {
  const auto& r = s.summary;
  std::string text = fmt::format(
      "{}, {}\n{}damping: {}\n{:.6g} s simulated with {}: {} steps, {} evaluations\n\n",
      bold(machine.file.machine.name, style), simulation_subtitle(machine, s),
      state_line(machine.file), s.damping, r.time, simulation::name(s.loop.integrator.method),
      r.integrator.steps, r.integrator.evaluations);
  if (r.samples > 0)
    text += direction_table(s, style) + "\n" +
            (has_struts(machine.file.machine) ? strut_table(s, style) : leg_table(s, style));
  const std::string events = event_text(s);
  if (!events.empty()) text += "\n" + events;
  return text;
}

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> commands{}, wrench{};
  std::string actuators{"controlled"}, initial{};
  std::string until{}, dt_output{};
  std::string integrator{"exponential"};
  double tolerance{1e-6};
  std::string step{"0.1 ms"};
  std::uint64_t seed{1};
  bool ideal_sensors{};
  bool show_controller{};
  std::string record{}, plot{};
  std::string format{"table"};
};

double positive_time(const std::string& option, const std::string& text) {
  return positive_quantity(option, text, "s", "expected a time of more than 0 s");
}

tasks::SimulateOptions options_of(const Arguments& arguments) {
  constexpr std::array methods{simulation::Method::exponential, simulation::Method::adaptive,
                               simulation::Method::cvode_adams, simulation::Method::cvode_bdf,
                               simulation::Method::fixed};
  tasks::SimulateOptions options{.commands = arguments.commands,
                                 .wrench = arguments.wrench,
                                 .initial = arguments.initial,
                                 .record = arguments.record,
                                 .origin = record_origin()};
  auto& loop = options.loop;
  loop.actuators = static_cast<simulation::Actuators>(
      choose_word("--actuators", arguments.actuators, {"controlled", "held", "springs"}));
  loop.integrator.method = methods[choose_word(
      "--integrator", arguments.integrator, {"exponential", "adaptive", "adams", "bdf", "fixed"})];
  if (!(arguments.tolerance >= 1e-13 && arguments.tolerance <= 1e-2))
    base::refuse(fmt::format("--tolerance {}", arguments.tolerance), "expected 1e-13 to 0.01");
  const bool fixed = loop.integrator.method == simulation::Method::fixed;
  const Arguments usual;
  if (!fixed && arguments.step != usual.step)
    base::refuse("--step " + arguments.step, "is of the fixed integrator; add --integrator fixed");
  if (fixed && arguments.tolerance != usual.tolerance)
    base::refuse(fmt::format("--tolerance {}", arguments.tolerance),
                 "the fixed integrator has a step and no tolerance; give --step");
  loop.integrator.relative_tolerance = loop.integrator.absolute_tolerance = arguments.tolerance;
  loop.integrator.fixed_step = positive_time("--step", arguments.step);
  loop.seed = arguments.seed;
  loop.ideal_sensors = arguments.ideal_sensors;
  if (!arguments.until.empty()) options.until = positive_time("--until", arguments.until);
  if (!arguments.dt_output.empty())
    loop.output_interval = positive_time("--dt-output", arguments.dt_output);
  return options;
}

std::string result_text(const Arguments& arguments, const tasks::Machine& machine,
                        const report::Simulation& simulation) {
  if (arguments.format == "json")
    return json_text(report::head_json("simulation", machine), report::simulation_json(simulation),
                     -1);
  return simulation_text(machine, simulation, table_style("-"));
}

/// A run that ended early fails the command, but only after everything it has was written.
void fail_if_early(const Arguments& arguments, const report::Simulation& simulation) {
  const auto& summary = simulation.summary;
  if (summary.end == simulation::RunEnd::finished) return;
  const std::string why =
      summary.end == simulation::RunEnd::stopped ? "interrupted" : summary.message;
  const std::string kept =
      arguments.record.empty()
          ? ""
          : fmt::format("; {} contains the run up to this time", simulation.record);
  throw base::ComputationError(fmt::format("the run ended at {:.6g} s of {:.6g} s: {}{}",
                                           summary.time, simulation.until, why, kept));
}

void run(const Arguments& arguments) {
  choose_word("--format", arguments.format, {"table", "json"});
  if (!arguments.plot.empty()) report::require_picture_ending(arguments.plot);
  if (!arguments.record.empty()) data::format_of_ending(arguments.record);
  const auto machine = load(arguments.machine);
  const auto options = options_of(arguments);
  const auto& of = machine.file.machine;
  if (arguments.show_controller) {
    const auto tuning = simulation::tune_controller(of, machine.pose.X_BP);
    return print_text(controller_text(of, tuning.parameters, tuning.lowest_oil_mode));
  }
  const auto result = with_progress("simulating", [&](const auto& progress) {
    return tasks::simulate(machine, options, progress);
  });
  for (const auto& warning : result.warnings) print_warning(warning);
  if (!result.record.empty()) print_written(result.record);
  if (!result.trace.time.empty())
    draw(arguments.plot, [&](const auto& path) {
      report::plot_simulation(
          result, of.name,
          simulation_subtitle(machine, result) + "; machine: " + report::state_text(machine.file),
          path);
    });
  print_text(result_text(arguments, machine, result));
  fail_if_early(arguments, result);
}

}  // namespace

void add_simulate(Command app) {
  Command command = app.add_command(
      "simulate", "Time simulation: mechanics, hydraulics or electric drives, controller",
      {{"simulate machine.toml --command \"step z=5 mm\" --plot step.svg",
        "response of the platform to a step"},
       {"simulate machine.toml --command \"sine ry=2 deg, frequency=1 Hz\" -o run.h5",
        "a sine, all signals as HDF5"},
       {"simulate machine.toml --command \"noise x=1 mm, y=1 mm, to=20 Hz\" --until 5 -o "
        "run.mat",
        "noise in two directions"},
       {"simulate machine.toml --command \"sweep z=2 mm, from=0.5, to=30, duration=4\" -o run.csv",
        "a swept sine"},
       {"simulate machine.toml --command \"file motion.csv\" --pose \"z=50 mm\"",
        "columns time [s], x [mm], …, rz [deg]"},
       {"simulate machine.toml --command \"step z=1 mm\" --set controller.gain=40",
        "a faster controller"},
       {"simulate machine.toml --actuators springs --initial \"x=1 mm\" --plot free.svg",
        "free vibration of the mechanics: oil as springs"},
       {"simulate machine.toml --wrench \"sine x=500 N, frequency=4 Hz\" -o run.h5",
        "a force on the platform, the controller holds the pose"},
       {"simulate machine.toml --show-controller", "values of the controller"}},
      std::string(signal_help) + "\nHere: level=amplitude, turns=0.");
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  add_pose_option(command, arguments.machine);
  command.add_options(
      {{"--model", arguments.machine.model,
        "rigid, guide (compliant guide sleeves) or full (piston rings too); default: "
        "full where the file has piston rings, else guide",
        shown_as("MODEL")},
       {"--command", arguments.commands,
        "Commanded motion (see below); may be repeated, commands add up [rest]",
        reads_each_as("COMMAND")},
       {"--wrench", arguments.wrench,
        "Force [N] and moment [N m] about the mass centre, in the axes of the base: a signal as "
        "for --command; may be repeated",
        reads_each_as("SIGNAL")},
       {"--initial", arguments.initial,
        "Displacement from the pose at which the platform is released: \"x=1 mm, ry=0.1 deg\""},
       {"--actuators", arguments.actuators,
        "controlled; held: valves stay as at rest (motors at the speed 0), no controller; springs: "
        "mechanics alone, the oil springs of the linear model or locked motors hold the legs"},
       {"--until", arguments.until,
        "Simulated time, s or with a unit; default: until shortly after the signals"},
       {"--dt-output", arguments.dt_output,
        "Time between samples of the record; default: the controller's sample time"},
       {"-o,--output", arguments.record,
        "Record to write: .h5, .mat, .csv, .uff or .rpc; a PATH.part while it grows", writes},
       {"--plot", arguments.plot, "Picture to write, .svg, .png or .pdf (needs gnuplot)", writes},
       {"--integrator", arguments.integrator,
        "exponential (spools in closed form, Dormand-Prince 5(4)), adaptive (Dormand-Prince), "
        "adams or bdf (CVODE, locate stops), fixed (Runge-Kutta 4)"},
       {"--tolerance", arguments.tolerance, "Of the integrator, relative"},
       {"--step", arguments.step, "Step of the fixed integrator"},
       {"--seed", arguments.seed,
        "Seed of noise in sensors and commands; the same seed gives the same run"},
       {"--ideal-sensors", arguments.ideal_sensors, "Sensors without noise, resolution and range"},
       {"--show-controller", arguments.show_controller,
        "Print the values of the controller and their origin, and end"},
       {"--format", arguments.format, "table or json (with time histories)"}});
}

}  // namespace hydrapod::cli
