#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/signals/signal_text.hpp"

namespace hydrapod::report {

namespace {

constexpr double settled_share = 0.02;  // of a step

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
  const double rate = 1.0 / machine.controller.sample_time;
  prepared.commands = signals::read_signals(options.commands, {.rate = rate});
  const double until = options.until.value_or(signals::natural_duration(prepared.commands));
  prepared.options.until = prepared.options.loop.until = until;
  prepared.signal =
      std::make_unique<signals::Generator>(prepared.commands, rate, options.loop.seed);
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
    result.commands.push_back(signals::signal_text(command));
    const auto* step = std::get_if<signals::Step>(&command.form);
    for (int i = 0; step != nullptr && i < 6; ++i) {
      if (command.size[i] == 0.0) continue;
      auto& time = result.step_time[static_cast<std::size_t>(i)];
      time = std::max(time.value_or(0.0), step->at);
      result.settling_band[i] = settled_share * std::abs(command.size[i]);
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
