#include "hydrapod/base/text.hpp"
#include "hydrapod/command.hpp"
#include "hydrapod/realtime_arguments.hpp"
#include "hydrapod/reproduction.hpp"

#include "hydrapod/signal_help.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> signals{};
  std::string entry{"command"};
  std::string duration{"60 s"}, settling{"2 s"}, rate{};
  int averages{}, repeat{1}, oversampling{2};
  std::uint64_t seed{1};
  std::vector<std::string> accelerometers{};
  std::string length{}, pressure{}, current{}, torque{}, speed{}, drop_outs{};
  bool no_anti_alias{}, check{}, above_limits{};
  std::string hardware{}, shared_memory{}, layout{}, key{}, limits{};
  std::optional<int> fifo{};
  std::string ramp{"1 s"}, ramp_down{"200 ms"}, watchdog{"50 ms"};
  std::string file{};
};

double positive(const std::string& option, const std::string& text, const char* unit) {
  return positive_quantity(option, text, unit, "must be positive");
}

bool is_hardware(const Arguments& arguments) {
  return !arguments.hardware.empty() || !arguments.shared_memory.empty();
}

/// A real machine gives all of its samples.
double default_rate(const Arguments& arguments, const model::Machine& machine) {
  constexpr double simulated = 1000.0;  // [Hz]
  return is_hardware(arguments) ? 1.0 / machine.controller.sample_time : simulated;
}

/// Throws for options of the other kind of rig.
void check_kind(const Arguments& arguments) {
  const Arguments defaults;
  const auto refuse = [](bool given, const char* option, const char* why) {
    if (given) base::refuse(option, why);
  };
  if (is_hardware(arguments)) {
    const char* why = "belongs to the simulated rig, not to --hardware: a machine has its own";
    refuse(!arguments.length.empty(), "--length-sensor", why);
    refuse(!arguments.pressure.empty(), "--pressure-sensor", why);
    refuse(!arguments.current.empty(), "--current-sensor", why);
    refuse(!arguments.torque.empty(), "--torque-sensor", why);
    refuse(!arguments.speed.empty(), "--speed-sensor", why);
    refuse(!arguments.drop_outs.empty(), "--drop-outs", why);
    refuse(arguments.no_anti_alias, "--no-anti-alias", why);
    refuse(arguments.oversampling != defaults.oversampling, "--oversampling", why);
    refuse(!arguments.hardware.empty() && !arguments.shared_memory.empty(), "--shm",
           "is in place of an address, expected --hardware or --shm");
    return;
  }
  const char* why = "belongs to --hardware ADDRESS:PORT (or --shm NAME), which is not given";
  refuse(!arguments.layout.empty(), "--layout", why);
  refuse(!arguments.key.empty(), "--key", why);
  refuse(!arguments.limits.empty(), "--limit", why);
  refuse(arguments.fifo.has_value(), "--fifo", why);
  refuse(arguments.ramp != defaults.ramp, "--ramp", why);
  refuse(arguments.ramp_down != defaults.ramp_down, "--ramp-down", why);
  refuse(arguments.watchdog != defaults.watchdog, "--watchdog", why);
}

/// Throws for sensors of the other kind of actuator.
void check_sensors(const Arguments& arguments, const model::Machine& machine) {
  const bool screws = model::leg_type(machine) == model::LegType::screw;
  const auto refuse = [](bool given, const char* option, const char* why) {
    if (given) base::refuse(option, why);
  };
  const char* no_motor = "the legs have no motors; expected --pressure-sensor, or legs.screw";
  refuse(screws && !arguments.pressure.empty(), "--pressure-sensor",
         "electric cylinders have no oil; expected --torque-sensor or --speed-sensor");
  refuse(!screws && !arguments.torque.empty(), "--torque-sensor", no_motor);
  refuse(!screws && !arguments.speed.empty(), "--speed-sensor", no_motor);
}

std::optional<realtime::HardwareOptions> hardware_of(const Arguments& arguments) {
  if (!is_hardware(arguments)) return std::nullopt;
  realtime::HardwareOptions options;
  if (!arguments.hardware.empty())
    options.address = realtime::parse_address("--hardware", arguments.hardware);
  options.shared_memory = arguments.shared_memory;
  options.layout = layout_of(arguments.layout);
  options.key = key_of(arguments.key);
  options.limits =
      tasks::limits_of("--limit " + base::printable(arguments.limits), arguments.limits);
  options.fifo = arguments.fifo;
  options.ramp = positive("--ramp", arguments.ramp, "s");
  options.ramp_down = positive("--ramp-down", arguments.ramp_down, "s");
  options.watchdog = positive("--watchdog", arguments.watchdog, "s");
  return options;
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
  options.rate = arguments.rate.empty() ? default_rate(arguments, machine)
                                        : positive("--rate", arguments.rate, "Hz");
  if (!(options.duration * options.rate >= 1.0))
    base::refuse("--rate " + arguments.rate,
                 fmt::format("the record of {:g} s would have no sample", options.duration));
  options.oversampling = arguments.oversampling;
  options.repeat = arguments.repeat;
  options.seed = arguments.seed;
  check_sensors(arguments, machine);
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
  if (!arguments.torque.empty())
    all.torque = rig::parse_sensor("--torque-sensor", arguments.torque, "N m");
  if (!arguments.speed.empty())
    all.speed = rig::parse_sensor("--speed-sensor", arguments.speed, "rad/s");
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
  check_kind(arguments);
  const auto machine = load(arguments.machine);
  const tasks::RigOptions options{.test = options_of(arguments, machine.file.machine),
                                  .averages = arguments.averages,
                                  .record = arguments.check ? "" : arguments.file,
                                  .force = arguments.above_limits,
                                  .origin = record_origin(),
                                  .hardware = hardware_of(arguments)};
  if (!arguments.check && !options.hardware)
    print_note("damping: " + report::plant_damping_text(machine.file.machine));
  const auto done = with_progress(
      "measuring", [&](const auto& progress) { return tasks::rig(machine, options, progress); });
  for (const auto& finding : done.findings)
    print_warning(finding.message, finding.of_controller ? "controller" : "--excite");
  if (arguments.check) return;
  if (done.hardware) print_note(hardware_note(*done.hardware));
  if (done.hardware && arguments.fifo && !done.hardware->scheduling.starts_with("SCHED_FIFO"))
    print_warning(done.hardware->scheduling, "--fifo");
  print_note(fmt::format("wrote {}: {} samples", done.record, done.result.samples));
  const auto& summary = done.result.summary;
  if (summary.end == simulation::RunEnd::finished) return;
  throw base::ComputationError(fmt::format(
      "the run ended at {:.6g} s: {}; {} contains the run up to this time", summary.time,
      summary.end == simulation::RunEnd::stopped ? "interrupted" : summary.message, done.record));
}

void add_hardware_options(Command command, Arguments& arguments) {
  command.add_options(
      {{"--hardware", arguments.hardware,
        "A machine behind a controller instead of the simulated one: [ADDRESS:]PORT by UDP, as "
        "`hydrapod serve` or as --layout says",
        shown_as("ADDRESS")},
       {"--shm", arguments.shared_memory, "The same by shared memory of that name",
        shown_as("NAME")},
       {"--layout", arguments.layout, "Description of the machine's packets; see serve", reads},
       {"--key", arguments.key, "File with the secret of both; beyond the loopback it is required",
        reads},
       {"--limit", arguments.limits,
        "Of each leg, then the machine is ramped down [length=50 mm, velocity=0.5 m/s, "
        "acceleration=20 m/s^2, error=10 mm]"},
       {"--ramp", arguments.ramp,
        "In which the excitation grows before the record, and ends after"},
       {"--ramp-down", arguments.ramp_down, "Of an emergency, or Ctrl-C"},
       {"--watchdog", arguments.watchdog, "Longest time without sensors"},
       {"--fifo", arguments.fifo, "Real-time priority (SCHED_FIFO), where it is permitted",
        range(1, 99)}});
}

void add_options(Command command, Arguments& arguments) {
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--excite", arguments.signals,
        "Signal (see below); may be repeated, signals add up [white]", reads_each_as("SIGNAL")},
       {"--entry", arguments.entry,
        "command (demanded pose; m, rad), drive (valves or motors; shares) or wrench (N, N m)"},
       {"--duration", arguments.duration, "Of the record"},
       {"--averages", arguments.averages, "Periods of a periodic excitation, instead of --duration",
        range(1, 100000)},
       {"--settling", arguments.settling, "Time before the record begins"},
       {"--rate", arguments.rate, "Sample rate of the record [1000 Hz; of hardware its own]"},
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
        "Of the valves, shares of the rated current, or of the motors' speed commands: "
        "\"resolution=1e-4, noise=1e-4\""},
       {"--torque-sensor", arguments.torque,
        "Of the motors of electric cylinders: \"resolution=0.01 N m, noise=0.02 N m\""},
       {"--speed-sensor", arguments.speed, "The same: \"resolution=0.001, noise=0.005\" in rad/s"},
       {"--drop-outs", arguments.drop_outs,
        "Drop-outs of 20 ms per second and channel, for instance 0.01"},
       {"--no-anti-alias", arguments.no_anti_alias, "Leave the anti-alias filter out"},
       {"--check", arguments.check, "Only check the levels against stroke, valves and motors"},
       {"--above-limits", arguments.above_limits, "Run although the levels are too high"},
       {"-o", arguments.file, "Record to write: .h5, .mat, .csv, .uff or .rpc", writes}});
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
      std::string(signal_help) +
          "\nHere: level=rms; turns=1 of a sweep, turns=10 of a chirp.\n\nA real machine: rig "
          "machine.toml --hardware 127.0.0.1:4747 -o run.h5; docs/howto/realtime.md.");
  auto& arguments = command.calls(&run);
  add_options(command, arguments);
  add_hardware_options(command, arguments);
}

}  // namespace hydrapod::cli
