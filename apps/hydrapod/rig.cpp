#include "hydrapod/command.hpp"
#include "hydrapod/reproduction.hpp"

#include "hydrapod/signal_help.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> signals{};
  std::string entry{"command"};
  std::string duration{"60 s"}, settling{"2 s"}, rate{"1000 Hz"};
  int averages{}, repeat{1}, oversampling{2};
  std::uint64_t seed{1};
  std::vector<std::string> accelerometers{};
  std::string length{}, pressure{}, current{}, drop_outs{};
  bool no_anti_alias{}, check{}, above_limits{};
  std::string file{};
};

double positive(const std::string& option, const std::string& text, const char* unit) {
  return positive_quantity(option, text, unit, "must be positive");
}

rig::RigOptions options_of(const Arguments& arguments, const model::Machine& machine) {
  rig::RigOptions options;
  options.entry = static_cast<rig::Entry>(
      choose_word("--entry", arguments.entry, {"command", "drive", "wrench"}));
  options.signals =
      signals::read_signals(arguments.signals, {.argument = "--excite",
                                                .units = rig::units_of(options.entry),
                                                .rate = 1.0 / machine.controller.sample_time,
                                                .excitation = true});
  options.settling = plain_or_quantity("--settling", arguments.settling, "s");
  if (!(options.settling >= 0.0)) base::refuse("--settling", "must be 0 or more");
  options.duration = positive("--duration", arguments.duration, "s");
  options.rate = positive("--rate", arguments.rate, "Hz");
  if (!(options.duration * options.rate >= 1.0))
    base::refuse("--rate " + arguments.rate,
                 fmt::format("the record of {:g} s would have no sample", options.duration));
  options.oversampling = arguments.oversampling;
  options.repeat = arguments.repeat;
  options.seed = arguments.seed;
  rig::Instruments& all = options.instruments;
  all.accelerometers = rig::default_accelerometers(machine);
  if (!arguments.accelerometers.empty()) all.accelerometers.clear();
  for (const auto& text : arguments.accelerometers)
    if (text != "none") all.accelerometers.push_back(rig::parse_accelerometer(text));
  if (!arguments.length.empty())
    all.length = rig::parse_sensor("--length-sensor", arguments.length, "m");
  if (!arguments.pressure.empty())
    all.pressure = rig::parse_sensor("--pressure-sensor", arguments.pressure, "Pa");
  if (!arguments.current.empty())
    all.current = rig::parse_sensor("--current-sensor", arguments.current, "1");
  if (!arguments.drop_outs.empty())
    all.drop_outs = positive("--drop-outs", arguments.drop_outs, "Hz");
  all.anti_alias = !arguments.no_anti_alias;
  return options;
}

void run(const Arguments& arguments) {
  if (!arguments.check) {
    if (arguments.file.empty()) base::refuse("-o", "a file for the record is required");
    data::format_of_ending(arguments.file);
  }
  const auto machine = load(arguments.machine);
  const tasks::RigOptions options{.test = options_of(arguments, machine.file.machine),
                                  .averages = arguments.averages,
                                  .record = arguments.check ? "" : arguments.file,
                                  .force = arguments.above_limits,
                                  .origin = {program_text(), command_line()}};
  if (!arguments.check) print_note("damping: " + report::plant_damping_text(machine.file.machine));
  const auto done = with_progress(
      "measuring", [&](const auto& progress) { return tasks::rig(machine, options, progress); });
  for (const auto& finding : done.findings)
    print_warning(finding.message, finding.of_controller ? "controller" : "--excite");
  if (arguments.check) return;
  print_note(fmt::format("wrote {}: {} samples", done.record, done.result.samples));
  const auto& summary = done.result.summary;
  if (summary.end == simulation::RunEnd::finished) return;
  throw base::ComputationError(fmt::format(
      "the run ended at {:.6g} s: {}; {} contains the run up to this time", summary.time,
      summary.end == simulation::RunEnd::stopped ? "interrupted" : summary.message, done.record));
}

void add_options(Command command, Arguments& arguments) {
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--excite", arguments.signals,
        "Signal (see below); may be repeated, signals add up [white]", reads_each_as("SIGNAL")},
       {"--entry", arguments.entry,
        "command (demanded pose; m, rad), drive (valves; shares) or wrench (N, N m)"},
       {"--duration", arguments.duration, "Of the record"},
       {"--averages", arguments.averages, "Periods of a periodic excitation, instead of --duration",
        range(1, 100000)},
       {"--settling", arguments.settling, "Time before the record begins"},
       {"--rate", arguments.rate, "Sample rate of the record"},
       {"--oversampling", arguments.oversampling,
        "Simulated samples per sample of the record, for the anti-alias filter", range(1, 64)},
       {"--seed", arguments.seed, "Seed; the same seed gives the same file"},
       {"--repeat", arguments.repeat, "Number of this repetition, for the record",
        range(1, 1000000)},
       {"--accelerometer", arguments.accelerometers,
        "\"name, at=X Y Z, along=x, noise=0.001, bandwidth=5 kHz, range=50\": position "
        "in the platform frame [m], density [m/s²/√Hz]; may be repeated; none: no "
        "accelerometer; default: three axes at the joints of legs 1, 3, 5",
        one_each},
       {"--length-sensor", arguments.length,
        "\"resolution=5 um, noise=2 um, low=0.8 m, high=1.2 m\""},
       {"--pressure-sensor", arguments.pressure,
        "\"resolution=2 kPa, noise=5 kPa, low=0, high=250 bar\""},
       {"--current-sensor", arguments.current,
        "Of the valves, shares of the rated current: \"resolution=1e-4, noise=1e-4\""},
       {"--drop-outs", arguments.drop_outs,
        "Drop-outs of 20 ms per second and channel, for instance 0.01"},
       {"--no-anti-alias", arguments.no_anti_alias, "Leave the anti-alias filter out"},
       {"--check", arguments.check, "Only check the levels against stroke and valves"},
       {"--above-limits", arguments.above_limits, "Run although the levels are too high"},
       {"-o", arguments.file, "Record to write: .h5, .mat, .csv or .uff", writes}});
}

}  // namespace

void add_rig(Command app) {
  Command command = app.add_command(
      "rig", "Simulated test rig: excite the machine in six directions and write a record",
      {{"rig machine.toml --duration 5 -o run.h5", "white noise in all six directions"},
       {"rig machine.toml --excite \"multisine all=0.1 mm, to=40, period=2, crest=low\" --averages "
        "2 "
        "-o run.h5",
        "two periods of a multisine"},
       {"rig machine.toml --excite \"noise x=1 mm, ry=0.1 deg, to=10\" --duration 4 -o run.mat",
        "noise in a band, for MATLAB"},
       {"rig machine.toml --excite \"binary z=2 %\" --entry drive --duration 3 -o run.uff",
        "a binary sequence on the valves"},
       {"rig machine.toml --excite \"sweep z=2 mm, to=30, duration=10\" --check",
        "check of the levels only"}},
      std::string(signal_help) + "\nHere: level=rms; turns=1 of a sweep, turns=10 of a chirp.");
  auto& arguments = command.calls(&run);
  add_options(command, arguments);
}

}  // namespace hydrapod::cli
