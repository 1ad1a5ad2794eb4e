#include "hydrapod/report/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/command_text.hpp"

namespace hydrapod::report {

namespace {

using simulation::CommandSpec;
using spatial::Vector6;

constexpr double settled_share = 0.02;  // of a step

/// How long a command goes on, and what comes after it [s].
struct Duration {
  double operator()(const simulation::Step& s) const { return s.at + s.rise + 4.0; }
  double operator()(const simulation::Sine& s) const {
    return std::max(s.fade + 5.0 / s.frequency, 5.0);
  }
  double operator()(const simulation::Sweep& s) const { return s.duration + 1.0; }
  double operator()(const simulation::Multisine& s) const { return s.fade + 2.0 * s.period; }
  double operator()(const simulation::Noise&) const { return 10.0; }
  double operator()(const simulation::Trajectory& s) const { return s.times.back() + 1.0; }
};

double natural_duration(const std::vector<CommandSpec>& commands) {
  double longest = 2.0;
  for (const auto& command : commands) longest = std::max(longest, std::visit(Duration{}, command));
  return longest;
}

[[noreturn]] void bad_command(const std::string& text, const std::string& message) {
  throw base::InputError({{.file = "--command " + text, .message = message}});
}

void require_possible(PreparedSimulation& prepared, const model::NamedPose& pose) {
  auto& loop = *prepared.loop;
  const auto findings = simulation::check_motion(loop.plant(), loop.parameters(), pose.X_BP,
                                                 *prepared.signal, *prepared.options.until);
  std::vector<base::Diagnostic> errors;
  for (const auto& finding : findings) {
    if (finding.severity == base::Severity::error)
      errors.push_back({.file = "the commanded motion", .message = finding.message});
    else
      prepared.warnings.push_back(finding.message);
  }
  if (!errors.empty()) throw base::InputError(errors);
}

}  // namespace

PreparedSimulation prepare_simulation(const model::Machine& machine, const model::NamedPose& pose,
                                      const SimulationOptions& options) {
  PreparedSimulation prepared{.options = options};
  const double sample_time = machine.controller.sample_time;
  for (const auto& text : options.commands) {
    const auto spec = simulation::parse_command(text, options.loop.seed);
    if (!spec) continue;
    try {
      simulation::make_signal({*spec}, sample_time);
    } catch (const std::invalid_argument& error) {
      bad_command(text, error.what());
    }
    prepared.commands.push_back(*spec);
  }
  const double until = options.until.value_or(natural_duration(prepared.commands));
  prepared.options.until = prepared.options.loop.until = until;
  prepared.signal = simulation::make_signal(prepared.commands, sample_time);
  prepared.loop =
      std::make_unique<simulation::ClosedLoop>(machine, pose.X_BP, prepared.options.loop);
  require_possible(prepared, pose);
  return prepared;
}

Simulation run_simulation(PreparedSimulation& prepared, const simulation::LoopSink& sink,
                          const simulation::KeepGoing& keep_going) {
  auto& loop = *prepared.loop;
  Simulation result{.warnings = prepared.warnings,
                    .until = *prepared.options.until,
                    .output_interval = loop.output_interval(),
                    .loop = prepared.options.loop,
                    .controller = loop.parameters(),
                    .lowest_oil_mode = loop.lowest_oil_mode()};
  result.settling_band.setConstant(1e-5);
  for (const auto& command : prepared.commands) {
    result.commands.push_back(simulation::description(command));
    const auto* step = std::get_if<simulation::Step>(&command);
    for (int i = 0; step != nullptr && i < 6; ++i) {
      if (step->size[i] == 0.0) continue;
      auto& time = result.step_time[static_cast<std::size_t>(i)];
      time = std::max(time.value_or(0.0), step->at);
      result.settling_band[i] = settled_share * std::abs(step->size[i]);
    }
  }
  for (int i = 0; i < model::leg_count; ++i)
    result.stops[static_cast<std::size_t>(i)] = loop.plant().axis(i).stops;
  simulation::TraceRecorder recorder(loop, result.until, prepared.options.trace_samples);
  prepared.signal->restart();
  result.summary = loop.run(
      simulation::command_source(*prepared.signal),
      [&](const simulation::LoopSample& sample) {
        recorder(sample);
        if (sink) sink(sample);
      },
      keep_going, result.settling_band);
  result.trace = recorder.trace();
  return result;
}

}  // namespace hydrapod::report
