#include "hydrapod/tasks/simulation.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "commanded_motion.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/version.hpp"
#include "hydrapod/signals/signals.hpp"

namespace hydrapod::tasks {

namespace {

using simulation::ClosedLoop;
using simulation::LoopSample;

/// "machine.toml: sha256 9f86…", a line per file.
std::string inputs_text(const Origin& origin) {
  std::vector<std::string> lines;
  for (const auto& input : origin.inputs)
    lines.push_back(fmt::format("read {}: sha256 {}", input.path, input.sha256));
  return fmt::format("{}", fmt::join(lines, "\n"));
}

/// Both texts, a line break between them.
std::string with_lines(const std::string& text, const std::string& more) {
  return text.empty() || more.empty() ? text + more : text + "\n" + more;
}

data::RecordHeader header_of(const Machine& machine, std::uint64_t seed, const Origin& origin) {
  const auto& X_BP = machine.pose.X_BP;
  const spatial::Vector3 rpy = spatial::rpy_from_rotation(X_BP.R_BP), &p = X_BP.p_BP;
  return {
      .title = machine.file.machine.name,
      .notes = inputs_text(origin),
      .experiment = {.program = origin.program.empty() ? fmt::format("hydrapod {}", base::version)
                                                       : origin.program,
                     .command = origin.command,
                     .machine = machine.file.text,
                     .overrides = machine.file.overrides,
                     .pose_name = machine.pose.name,
                     .pose = {{p.x(), p.y(), p.z(), rpy.x(), rpy.y(), rpy.z()}},
                     .model = dynamics::name(machine.kind),
                     .seed = seed}};
}

/// Simulated time as share of the whole; the loop goes on until told otherwise.
simulation::KeepGoing keep_going(const Progress& progress, double until) {
  return [&progress, until](double time) { return !progress || !progress(time / until); };
}

/// A record that grows block by block.
class RecordFile {
 public:
  RecordFile(const std::string& path, const ClosedLoop& loop, data::RecordHeader header)
      : loop_(loop) {
    header.channels = simulation::record_channels(loop);
    header.sample_rate = 1.0 / loop.output_interval();
    block_.resize(rows, static_cast<Eigen::Index>(header.channels.size()));
    writer_ = data::open_record_writer(path, header);
  }

  void append(const LoopSample& sample) {
    simulation::record_row(loop_, sample, block_.row(filled_).data());
    if (++filled_ == block_.rows()) flush();
  }

  std::string close(bool complete) {
    flush();
    return writer_->close(complete);
  }

 private:
  static constexpr Eigen::Index rows = 256;

  void flush() {
    const Eigen::Index count = filled_;
    filled_ = 0;  // what could not be written is not tried again
    if (count > 0) writer_->append(block_.topRows(count));
  }

  const ClosedLoop& loop_;
  data::Samples block_{};
  Eigen::Index filled_{};
  std::unique_ptr<data::RecordWriter> writer_{};
};

/// The settings that the controller ran with.
std::string controller_text(const control::ControllerParameters& p) {
  constexpr std::array<const char*, 3> feedbacks{"pressure", "acceleration", "none"};
  return fmt::format(
      "space={}, gain={:.6g} 1/s, integral_time={:.6g} s, velocity_feedforward={:.6g}, "
      "damping_feedback={}, feedback_gain={:.6g}, feedback_corner={:.6g} rad/s, "
      "sample_time={:.6g} s, delay={:.6g} samples",
      p.space == model::ControlSpace::pose ? "pose" : "legs", fmt::join(p.gain, " "),
      p.integral_time, p.velocity_feedforward, feedbacks.at(static_cast<std::size_t>(p.feedback)),
      fmt::join(p.feedback_gain, " "), p.feedback_corner, p.sample_time, p.delay);
}

data::RecordHeader rig_header(const Machine& machine, const rig::RigOptions& options,
                              const Origin& origin,
                              const control::ControllerParameters& controller) {
  constexpr std::array entries{"command", "drive", "wrench"};
  auto header = header_of(machine, options.seed, origin);
  header.channels = rig::rig_channels(options, model::leg_type(machine.file.machine));
  header.sample_rate = options.rate;
  header.start = options.settling;  // the excitation begins at 0
  header.repeat = options.repeat;
  auto& excitation = header.experiment.excitation.emplace();
  excitation.entry = entries.at(static_cast<std::size_t>(options.entry));
  spatial::Vector6 squares = spatial::Vector6::Zero();
  for (const auto& signal : options.signals) {
    excitation.signals.push_back(signals::signal_text(signal, rig::units_of(options.entry)));
    squares += signal.size.cwiseAbs2();
  }
  for (int d = 0; d < 6; ++d) excitation.level.at(d) = std::sqrt(squares[d]);
  if (const auto period = signals::period_samples(options.signals, 1.0 / controller.sample_time))
    excitation.period = static_cast<double>(*period) * controller.sample_time;
  header.experiment.controller = controller_text(controller);
  for (const auto& one : options.instruments.accelerometers)
    header.experiment.sensors.push_back({one.name, one.p_P, one.e_P});
  return header;
}

/// Throws where the levels do not fit.
void judge(const std::vector<rig::LevelFinding>& findings) {
  std::vector<base::Diagnostic> list;
  bool bad = false;
  for (const auto& finding : findings) {
    list.push_back({.severity = finding.severity,
                    .file = finding.of_controller ? "controller" : "--excite",
                    .message = finding.message});
    bad = bad || finding.severity == base::Severity::error;
  }
  if (bad) throw base::InputError(list);
}

/// What the user asked of the machine, as options of the loop.
simulation::LoopOptions loop_of(const Machine& machine, const SimulateOptions& options,
                                double until) {
  using simulation::Actuators;
  auto loop = options.loop;
  loop.kind = machine.kind;
  loop.until = until;
  loop.records_wrench = !options.wrench.empty();
  if (loop.actuators != Actuators::controlled && !options.commands.empty())
    base::refuse("--command",
                 "without the controller nothing follows a command; expected forces (--wrench), an "
                 "initial displacement (--initial) or --actuators controlled");
  if (options.initial.empty()) return loop;
  const std::string place = "--initial " + options.initial;
  if (loop.actuators == Actuators::held)
    base::refuse(place,
                 "held valves hold the platform where it stands; expected --actuators springs or "
                 "controlled");
  loop.initial = displacement_of(machine.file.machine, machine.pose.X_BP, options.initial, place);
  return loop;
}

ClosedLoop bounded_loop(const model::Machine& machine, const spatial::Pose& pose,
                        const simulation::LoopOptions& options, const char* argument) {
  try {
    return {machine, pose, options};
  } catch (const std::length_error& error) {
    base::refuse(argument, error.what());
  }
}

/// The drives change at each sample, and no step goes on beyond a change.
void note_shorter_steps(const ClosedLoop& loop, const simulation::IntegratorOptions& integrator,
                        std::vector<std::string>& warnings) {
  const double longest = std::min(loop.parameters().sample_time, loop.output_interval());
  constexpr double rounding = 1e-9;
  if (integrator.method == simulation::Method::fixed &&
      integrator.fixed_step > longest * (1.0 + rounding))
    warnings.push_back(
        fmt::format("the fixed integrator takes steps of at most {:.6g} ms, not {:.6g} ms: no step "
                    "goes on beyond a sample of the controller or an output",
                    1e3 * longest, 1e3 * integrator.fixed_step));
}

/// With valves, seals have their friction law, and nothing of the linear models' spring.
std::optional<std::string> note_on_sticking_seals(const model::Machine& machine) {
  if (std::ranges::none_of(machine.legs, [](const auto& leg) { return leg.stick_stiffness > 0.0; }))
    return {};
  return "`legs.stick_stiffness` has no effect here: a simulation with valves has "
         "`legs.friction.bristles` for seals that stick, and the controller is tuned for seals "
         "that slide";
}

/// What moved the machine, a line each.
std::string notes_of(const SimulateOptions& options, const report::Simulation& result) {
  std::vector<std::string> lines;
  for (const auto& command : result.commands) lines.push_back("command: " + command);
  for (const auto& one : result.wrench) lines.push_back("wrench: " + one);
  if (!options.initial.empty()) lines.push_back("initial displacement: " + options.initial);
  return fmt::format("{}", fmt::join(lines, "\n"));
}

/// What is known of a run before it begins.
void fill_in(const ClosedLoop& loop, report::Simulation& result) {
  result.output_interval = loop.output_interval();
  result.controller = loop.parameters();
  result.lowest_oil_mode = loop.lowest_oil_mode();
  for (int i = 0; i < model::leg_count; ++i)
    result.stops[static_cast<std::size_t>(i)] = loop.plant().axis(i).stops;
}

}  // namespace

report::Simulation simulate(const Machine& machine, const SimulateOptions& options,
                            const Progress& progress) {
  const auto& of = machine.file.machine;
  const double rate = 1.0 / of.controller.sample_time;
  const auto commands = signals::read_signals(options.commands, {.rate = rate});
  report::Simulation result;
  const auto forces = signals::read_signals(
      options.wrench, {.argument = "--wrench", .units = signals::wrench_units, .rate = rate});
  result.damping =
      report::plant_damping_text(of, options.loop.actuators != simulation::Actuators::springs);
  result.until = options.until.value_or(
      std::max(signals::natural_duration(commands), signals::natural_duration(forces)));
  result.loop = loop_of(machine, options, result.until);
  signals::Generator signal(commands, rate, options.loop.seed);
  auto loop = bounded_loop(of, machine.pose.X_BP, result.loop, "--until");
  const auto checked = [&](double) { return !progress || !progress(0.0); };
  if (result.loop.actuators == simulation::Actuators::controlled)
    result.warnings =
        require_possible(machine, loop, options.commands, commands, signal, result.until, checked);
  if (auto why = simulation::instability(loop); !why.empty())
    result.warnings.push_back(std::move(why));
  else if (result.loop.actuators == simulation::Actuators::controlled)
    if (auto lost = simulation::loss_of_rest(loop, signal, result.until, checked); !lost.empty())
      result.warnings.push_back(std::move(lost));
  note_shorter_steps(loop, result.loop.integrator, result.warnings);
  if (result.loop.actuators != simulation::Actuators::springs)
    if (auto note = note_on_sticking_seals(of)) result.warnings.push_back(std::move(*note));
  for (const auto& command : commands) result.commands.push_back(signals::signal_text(command));
  for (const auto& one : forces)
    result.wrench.push_back(signals::signal_text(one, signals::wrench_units));
  result.settling = simulation::settling_of(commands);
  fill_in(loop, result);
  std::optional<RecordFile> record;
  if (!options.record.empty()) {
    auto header = header_of(machine, options.loop.seed, options.origin);
    header.notes = with_lines(notes_of(options, result), header.notes);
    record.emplace(options.record, loop, std::move(header));
  }
  simulation::TraceRecorder recorder(loop, result.until, options.trace_samples);
  signal.restart();
  signals::Generator wrench(forces, rate, options.loop.seed);
  result.summary = loop.run(
      simulation::command_source(signal, forces.empty() ? nullptr : &wrench),
      [&](const LoopSample& sample) {
        recorder(sample);
        if (record) record->append(sample);
      },
      keep_going(progress, result.until), result.settling.band);
  if (record) result.record = record->close(result.summary.end == simulation::RunEnd::finished);
  result.trace = recorder.trace();
  return result;
}

Rig rig(const Machine& machine, const RigOptions& asked, const Progress& progress) {
  const auto& of = machine.file.machine;
  Rig result{.options = asked.test};
  auto& options = result.options;
  options.loop.kind = machine.kind;
  if (options.signals.empty()) options.signals = rig::default_signals(options.entry);
  if (asked.averages > 0) {
    const double rate = 1.0 / of.controller.sample_time;
    const auto period = signals::period_samples(options.signals, rate);
    if (!period)
      base::refuse("--averages", "the excitation does not repeat; give its duration instead");
    options.duration = asked.averages * static_cast<double>(*period) / rate;
  }
  try {
    auto loop = bounded_loop(of, machine.pose.X_BP, rig::loop_options(options), "--duration");
    result.findings = rig::check_levels(loop, options);
    if (auto note = note_on_sticking_seals(of))
      result.findings.push_back({base::Severity::warning, std::move(*note), true});
    if (!asked.force) judge(result.findings);
    if (asked.record.empty()) return result;
    auto header = rig_header(machine, options, asked.origin, loop.parameters());
    const auto going = keep_going(progress, options.settling + options.duration);
    std::unique_ptr<data::RecordWriter> writer;
    if (asked.hardware) {
      header.notes = with_lines("measured on hardware", header.notes);
      header.experiment.controller.clear();  // it is the machine's own
      result.hardware = realtime::run_on_hardware(
          of, machine.pose.X_BP, options, *asked.hardware,
          [&]() -> data::RecordWriter& {
            return *(writer = data::open_record_writer(asked.record, header));
          },
          going);
      result.result = result.hardware->rig;
    } else {
      writer = data::open_record_writer(asked.record, header);
      result.result = rig::run_rig(loop, options, *writer, going);
    }
    result.record = writer->close(result.result.summary.end == simulation::RunEnd::finished);
  } catch (const std::invalid_argument& error) {
    base::refuse("--excite", error.what());
  }
  return result;
}

realtime::Limits limits_of(const std::string& place, const std::string& text) {
  realtime::Limits limits;
  base::KeyValues values(place, text);
  const auto read = [&](const char* key, const char* unit, double& limit) {
    limit = values.number(key, unit).value_or(limit);
    if (!(limit > 0.0)) values.fail(std::string(key) + " must be more than 0");
  };
  read("length", "m", limits.length);
  read("velocity", "m/s", limits.velocity);
  read("acceleration", "m/s^2", limits.acceleration);
  read("error", "m", limits.error);
  values.finish();
  return limits;
}

Served serve(const Machine& machine, const ServeOptions& asked, const Progress& progress) {
  const auto& of = machine.file.machine;
  hydraulics::require_actuators(of);
  constexpr double longest = 9e8;  // [samples], a little less than a run may have
  auto options = asked.server;
  auto loop_options = asked.loop;
  loop_options.kind = machine.kind;
  loop_options.until = asked.duration.value_or(longest * of.controller.sample_time);
  loop_options.output_interval.reset();
  loop_options.records_wrench = true;
  if (!asked.rest.empty())
    options.rest = displacement_of(of, machine.pose.X_BP, asked.rest, "--rest " + asked.rest);
  auto loop = bounded_loop(of, machine.pose.X_BP, loop_options, "--duration");
  const std::string unstable = simulation::instability(loop);
  if (asked.warn && !unstable.empty()) asked.warn(unstable);
  Served served;
  std::unique_ptr<data::RecordWriter> writer;
  realtime::OpenRecord open;
  if (!asked.record.empty())
    open = [&]() -> data::RecordWriter& {
      auto header = header_of(machine, loop_options.seed, asked.origin);
      header.channels = simulation::record_channels(loop);
      for (const auto& more : realtime::serve_channels(loop, options))
        header.channels.push_back(more);
      header.sample_rate = 1.0 / of.controller.sample_time;
      header.notes = with_lines("commands of a client, `hydrapod serve`", header.notes);
      header.notes = with_lines(unstable, header.notes);
      header.experiment.controller = controller_text(loop.parameters());
      for (const auto& one : options.accelerometers)
        header.experiment.sensors.push_back({one.name, one.p_P, one.e_P});
      return *(writer = data::open_record_writer(asked.record, header));
    };
  const double whole = asked.duration.value_or(std::numeric_limits<double>::infinity());
  served.result = realtime::serve(loop, options, open, keep_going(progress, whole));
  if (!unstable.empty()) served.result.warnings.push_back(unstable);
  using simulation::RunEnd;
  const RunEnd end = served.result.run.end;  // without a duration it is stopped by its user
  if (writer)
    served.record =
        writer->close(end == RunEnd::finished || (end == RunEnd::stopped && !asked.duration));
  return served;
}

}  // namespace hydrapod::tasks
