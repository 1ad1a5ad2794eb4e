#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hydrapod/base/file.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/record_machine.hpp"
#include "hydrapod/rig/rig.hpp"
#include "hydrapod/rig/signal_text.hpp"
#include "hydrapod/terminal.hpp"

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
  bool no_anti_alias{}, check{}, force{};
  std::string file{};
};

double positive(const std::string& option, const std::string& text, const char* unit) {
  const double value = plain_or_quantity(option + " " + text, text, unit);
  if (!(value > 0.0)) bad_argument(option + " " + text, "must be positive");
  return value;
}

rig::RigOptions options_of(const Arguments& arguments, const model::Machine& machine) {
  rig::RigOptions options;
  options.entry = static_cast<rig::Entry>(
      choose_word("--entry", arguments.entry, {"command", "drive", "wrench"}));
  for (const auto& text : arguments.signals)
    options.signals.push_back(rig::parse_signal(text, options.entry));
  if (options.signals.empty()) options.signals = rig::default_signals(options.entry);
  options.settling = plain_or_quantity("--settling", arguments.settling, "s");
  if (!(options.settling >= 0.0)) bad_argument("--settling", "must be 0 or more");
  options.duration = positive("--duration", arguments.duration, "s");
  options.rate = positive("--rate", arguments.rate, "Hz");
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

/// `--averages N`: N periods of a periodic excitation.
void set_duration(const Arguments& arguments, double control_rate, rig::RigOptions& options) {
  if (arguments.averages == 0) return;
  const auto period = rig::period_samples(options.signals, control_rate);
  if (!period)
    bad_argument("--averages", "the excitation does not repeat; give its duration instead");
  options.duration = arguments.averages * static_cast<double>(*period) / control_rate;
}

/// The settings that the controller ran with.
std::string controller_text(const control::ControllerParameters& p) {
  return fmt::format(
      "space={}, gain={:.6g} 1/s, integral_time={:.6g} s, velocity_feedforward={:.6g}, "
      "damping_feedback={}, feedback_gain={:.6g}, feedback_corner={:.6g} rad/s, "
      "sample_time={:.6g} s, delay={:.6g} samples",
      p.space == model::ControlSpace::pose ? "pose" : "legs", fmt::join(p.gain, " "),
      p.integral_time, p.velocity_feedforward, static_cast<int>(p.feedback),
      fmt::join(p.feedback_gain, " "), p.feedback_corner, p.sample_time, p.delay);
}

data::RecordHeader header_of(const Arguments& arguments, const model::MachineFile& file,
                             const report::PoseChoice& pose, const rig::RigOptions& options,
                             const control::ControllerParameters& controller) {
  data::RecordHeader header;
  header.title = file.machine.name;
  header.channels = rig::rig_channels(options);
  header.sample_rate = options.rate;
  header.start = options.settling;  // the excitation begins at 0
  header.repeat = options.repeat;
  header.experiment = experiment_of(file, pose, options.loop.kind, options.seed);
  auto& excitation = header.experiment.excitation.emplace();
  excitation.entry = arguments.entry;
  Vector6 squares = Vector6::Zero();
  for (const auto& signal : options.signals) {
    excitation.signals.push_back(rig::description(signal));
    squares += std::visit([](const auto& s) { return s.rms.cwiseAbs2().eval(); }, signal);
  }
  for (int d = 0; d < 6; ++d) excitation.level[static_cast<std::size_t>(d)] = std::sqrt(squares[d]);
  if (const auto period = rig::period_samples(options.signals, 1.0 / controller.sample_time))
    excitation.period = static_cast<double>(*period) * controller.sample_time;
  header.experiment.controller = controller_text(controller);
  for (const auto& one : options.instruments.accelerometers)
    header.experiment.sensors.push_back({one.name, one.p_P, one.e_P});
  return header;
}

/// Prints what does not fit; throws when it must not run.
void judge(const std::vector<rig::LevelFinding>& findings, bool force) {
  std::vector<base::Diagnostic> list;
  bool bad = false;
  for (const auto& finding : findings) {
    const bool error = finding.severity == base::Severity::error && !force;
    list.push_back({.severity = error ? base::Severity::error : base::Severity::warning,
                    .file = finding.of_controller ? "controller" : "--excite",
                    .message = finding.message});
    bad = bad || error;
  }
  if (bad) throw base::InputError(list);
  print_diagnostics(list);
}

void run(const Arguments& arguments) {
  if (!arguments.check) {
    if (arguments.file.empty()) bad_argument("-o", "a file for the record is required");
    data::format_of_ending(arguments.file);
  }
  const auto machine = load(arguments.machine);
  const auto& [file, path, pose, kind] = machine;
  auto options = options_of(arguments, file.machine);
  options.loop.kind = kind;
  rig::RigResult result;
  try {
    simulation::ClosedLoop loop(file.machine, pose.X_BP, rig::loop_options(options));
    const double control_rate = 1.0 / loop.parameters().sample_time;
    set_duration(arguments, control_rate, options);
    if (arguments.averages > 0)
      loop = simulation::ClosedLoop(file.machine, pose.X_BP, rig::loop_options(options));
    judge(rig::check_levels(loop, options), arguments.force);
    if (arguments.check) return;
    const auto writer = data::open_record_writer(
        arguments.file, header_of(arguments, file, pose, options, loop.parameters()));
    const InterruptNote interrupt;
    {
      ProgressLine progress("measuring");
      const double until = options.settling + options.duration;
      result = rig::run_rig(loop, options, *writer, [&](double time) {
        progress.update(time / until);
        return !InterruptNote::noted();
      });
    }
    writer->close();
  } catch (const std::invalid_argument& error) {
    bad_argument("--excite", error.what());
  }
  fmt::print(stderr, "wrote {}: {} samples\n", arguments.file, result.samples);
  const auto& summary = result.summary;
  if (summary.end == simulation::RunEnd::finished) return;
  throw base::ComputationError(
      fmt::format("the run ended at {:.6g} s: {}; {} holds everything up to there", summary.time,
                  summary.end == simulation::RunEnd::stopped ? "interrupted" : summary.message,
                  arguments.file));
}

void add_instrument_options(Command command, Arguments& arguments) {
  command
      .add_option(
          "--accelerometer", arguments.accelerometers,
          "\"name, at=X Y Z, along=x, noise=0.001, bandwidth=5 kHz, range=50\": place in the "
          "platform frame [m], density [m/s²/√Hz]; may be repeated; none: no accelerometer; "
          "default: three axes at the joints of legs 1, 3, 5")
      .allow_extra_args(false);
  command.add_option("--length-sensor", arguments.length,
                     "\"resolution=5 um, noise=2 um, low=0.8 m, high=1.2 m\"");
  command.add_option("--pressure-sensor", arguments.pressure,
                     "\"resolution=2 kPa, noise=5 kPa, low=0, high=250 bar\"");
  command.add_option("--current-sensor", arguments.current,
                     "Of the valves, shares of the rated current: \"resolution=1e-4, noise=1e-4\"");
  command.add_option("--drop-outs", arguments.drop_outs,
                     "Drop-outs of 20 ms per second and channel, for instance 0.01");
  command.add_flag("--no-anti-alias", arguments.no_anti_alias, "Leave the anti-alias filter out");
}

void add_options(Command command, Arguments& arguments) {
  add_machine_options(command, arguments.machine);
  add_pose_option(command, arguments.machine);
  add_model_option(command, arguments.machine);
  command
      .add_option(
          "--excite", arguments.signals,
          "Signal; may be repeated, signals add up: white, noise, multisine, binary, sweep, "
          "chirp (see below) [white]")
      .allow_extra_args(false)
      .type_name("SIGNAL");
  command
      .add_option("--entry", arguments.entry,
                  "command (demanded pose; m, rad), drive (valves; shares) or wrench (N, N m)")
      .capture_default_str();
  command.add_option("--duration", arguments.duration, "Of the record").capture_default_str();
  command
      .add_option("--averages", arguments.averages,
                  "Periods of a periodic excitation, instead of --duration")
      .range(1, 100000);
  command.add_option("--settling", arguments.settling, "Time before the record begins")
      .capture_default_str();
  command.add_option("--rate", arguments.rate, "Sample rate of the record").capture_default_str();
  command
      .add_option("--oversampling", arguments.oversampling,
                  "Simulated samples per sample of the record, for the anti-alias filter")
      .range(1, 64)
      .capture_default_str();
  command.add_option("--seed", arguments.seed, "The same seed, the same file")
      .capture_default_str();
  command.add_option("--repeat", arguments.repeat, "Number of this repetition, for the record")
      .range(1, 1000000)
      .capture_default_str();
  add_instrument_options(command, arguments);
  command.add_flag("--check", arguments.check, "Only check the levels against stroke and valves");
  command.add_flag("--force", arguments.force, "Run though the levels do not fit");
  command.add_option("-o", arguments.file, "Record to write: .h5, .mat, .csv or .uff");
}

}  // namespace

void add_rig(Command app) {
  Command command = add_command(
      app, "rig", "The test rig: excite in six directions, measure, record",
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
        "is there room for it?"}});
  command.footer(command.get_footer() +
                 "\n\nSignals (levels: RMS of x y z rx ry rz, or all, SI or with units):\n"
                 "  white x=0.1 mm, ry=0.1 mrad\n"
                 "  noise x=1 mm, from=0, to=20 Hz, slope=0\n"
                 "  multisine z=1 mm, from=0.5 Hz, to=20 Hz, period=10 s, slope=0, crest=low, "
                 "experiment=1\n"
                 "  binary z=1 mm, to=20 Hz, period=10 s\n"
                 "  sweep z=1 mm, from=0.5 Hz, to=20 Hz, duration=20 s, spacing=log\n"
                 "  chirp z=1 mm, from=0.5 Hz, to=20 Hz, period=1 s, turns=10");
  auto arguments = std::make_shared<Arguments>();
  add_options(command, *arguments);
  command.callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
