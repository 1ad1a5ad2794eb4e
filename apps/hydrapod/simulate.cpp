#include "hydrapod/command.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/signal_help.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> commands{};
  std::string until{}, dt_output{};
  std::string integrator{"adaptive"};
  double tolerance{1e-6};
  std::string step{"0.1 ms"};
  std::uint64_t seed{1};
  bool ideal_sensors{};
  bool show_controller{};
  std::string record{}, plot{};
  std::string format{"table"};
};

double time(const std::string& option, const std::string& text) {
  return positive_quantity(option, text, "s", "expected a time of more than 0 s");
}

tasks::SimulateOptions options_of(const Arguments& arguments) {
  constexpr std::array methods{simulation::Method::adaptive, simulation::Method::cvode_adams,
                               simulation::Method::cvode_bdf, simulation::Method::fixed};
  tasks::SimulateOptions options{
      .commands = arguments.commands, .record = arguments.record, .command_line = command_line()};
  auto& loop = options.loop;
  loop.integrator.method = methods[choose_word("--integrator", arguments.integrator,
                                               {"adaptive", "adams", "bdf", "fixed"})];
  if (!(arguments.tolerance >= 1e-13 && arguments.tolerance <= 1e-2))
    base::refuse(fmt::format("--tolerance {}", arguments.tolerance), "expected 1e-13 to 0.01");
  loop.integrator.relative_tolerance = loop.integrator.absolute_tolerance = arguments.tolerance;
  loop.integrator.fixed_step = time("--step", arguments.step);
  loop.seed = arguments.seed;
  loop.ideal_sensors = arguments.ideal_sensors;
  if (!arguments.until.empty()) options.until = time("--until", arguments.until);
  if (!arguments.dt_output.empty()) loop.output_interval = time("--dt-output", arguments.dt_output);
  return options;
}

std::string result_text(const Arguments& arguments, const tasks::Machine& machine,
                        const report::Simulation& simulation) {
  if (arguments.format == "json")
    return json_text(report::head_json("simulation", machine), report::simulation_json(simulation),
                     -1);
  return simulation_text(machine.file.machine, machine.pose, simulation, table_style("-"));
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
          : fmt::format("; {} contains the run up to this time", arguments.record);
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
    return base::write_file_whole("-",
                                  controller_text(of, tuning.parameters, tuning.lowest_oil_mode));
  }
  const auto result = with_progress("simulating", [&](const auto& progress) {
    return tasks::simulate(machine, options, progress);
  });
  for (const auto& warning : result.warnings) print_warning(warning);
  if (!arguments.record.empty()) print_written(arguments.record);
  if (!result.trace.time.empty())
    draw(arguments.plot, [&](const auto& path) {
      report::plot_simulation(result, of.name, simulation_subtitle(machine.pose, result), path);
    });
  base::write_file_whole("-", result_text(arguments, machine, result));
  fail_if_early(arguments, result);
}

}  // namespace

void add_simulate(Command app) {
  Command command = add_command(
      app, "simulate", "Time simulation: mechanics, hydraulics, controller",
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
       {"simulate machine.toml --show-controller", "values of the controller"}});
  command.footer(command.get_footer() + signal_help + "\nHere: level=amplitude, turns=0.");
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
        one_each_as("COMMAND")},
       {"--until", arguments.until,
        "Simulated time, s or with a unit; default: until shortly after the commands"},
       {"--dt-output", arguments.dt_output,
        "Time between samples of the record; default: the controller's sample time"},
       {"-o,--output", arguments.record,
        "Record to write: .h5, .mat, .csv or .uff; a PATH.part while it grows"},
       {"--plot", arguments.plot, "Picture to write, .svg, .png or .pdf (needs gnuplot)"},
       {"--integrator", arguments.integrator,
        "adaptive (Dormand-Prince 5(4)), adams or bdf (CVODE, locate stops), fixed "
        "(Runge-Kutta 4)"},
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
