#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fields.hpp"
#include "geometry_json.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using spatial::Vector6;

constexpr std::array actuator_words{"controlled", "held", "springs"};

/// Six lists, one per direction or leg, of a history.
template <class Fields>
void histories(Fields& f, const char* key, std::vector<Vector6>& samples) {
  std::array<std::vector<double>, 6> lists;
  for (const auto& sample : samples)
    for (int i = 0; i < 6; ++i) lists.at(i).push_back(sample[i]);
  f(key, lists);
  if constexpr (Fields::reads) {
    samples.resize(lists[0].size());
    for (int i = 0; i < 6; ++i) {
      if (lists.at(i).size() != samples.size()) f.bad(key, "has lists of different lengths");
      for (std::size_t k = 0; k < samples.size(); ++k) samples[k][i] = lists.at(i)[k];
    }
  }
}

template <class Fields>
void describe_direction(Fields& f, Simulation& s, int i) {
  auto& summary = s.summary;
  auto& step = s.settling.step[static_cast<std::size_t>(i)];
  f.derived("direction", spatial::direction_name(i));
  f("peak_command", summary.peak_command[i]);
  f("peak_motion", summary.peak_motion[i]);
  f("rms_error", summary.rms_error[i]);
  f("peak_error", summary.peak_error[i]);
  f("final_error", summary.final_error[i]);
  if (!step && !f.has("settling_band")) return;
  f("settling_band", s.settling.band[i]);
  auto after = simulation::settling_time(summary, s.settling, i);
  f("settling_time_s", after);
  if constexpr (Fields::reads) {
    step = 0.0;
    summary.settled[i] = after.value_or(0.0);
  }
}

template <class Fields>
void describe_leg(Fields& f, Simulation& s, std::size_t i) {
  auto& stops = s.stops[i];
  auto& summary = s.summary;
  const double samples = static_cast<double>(std::max(summary.samples, 1L));
  double limited = static_cast<double>(summary.limited[i]) / samples;
  f.pair("stroke_m", stops.low, stops.high);
  f.pair("piston_m", summary.piston_low[i], summary.piston_high[i]);
  f.derived("stroke_used",
            (summary.piston_high[i] - summary.piston_low[i]) / (stops.high - stops.low));
  f("peak_speed_m_s", summary.peak_speed[i]);
  f("peak_drive", summary.peak_drive[i]);
  f("share_at_limit", limited);
  if constexpr (Fields::reads) summary.limited[i] = std::lround(limited * samples);
  f.unless(0.0, "peak_torque_N_m", summary.peak_torque[i]);
  double torque_limited = static_cast<double>(summary.torque_limited[i]) / samples;
  f.unless(0.0, "share_at_torque_limit", torque_limited);
  if constexpr (Fields::reads) summary.torque_limited[i] = std::lround(torque_limited * samples);
}

template <class Fields>
void describe_run(Fields& f, Simulation& s) {
  static constexpr std::array ends{"finished", "stopped", "failed"};
  auto& summary = s.summary;
  f.word("end", summary.end, ends);
  f("message", summary.message);
  f("time_s", summary.time);
  f("until_s", s.until);
  f("output_interval_s", s.output_interval);
  f("samples", summary.samples);
  f("seed", s.loop.seed);
  f.word("integrator", s.loop.integrator.method, words_of<simulation::Method, 5>(simulation::name));
  f("relative_tolerance", s.loop.integrator.relative_tolerance);
  f("steps", summary.integrator.steps);
  f("evaluations", summary.integrator.evaluations);
  f("events", summary.events);
}

}  // namespace

template <class Fields>
void describe(Fields& f, simulation::EventRecord& event) {
  f("time_s", event.time);
  f.counted("leg", event.leg);
  f.word("event", event.event,
         words_of<simulation::Plant::Event, simulation::Plant::events_per_leg>(
             simulation::Plant::name));
  f("begins", event.begins);
}

template <class Fields>
void describe(Fields& f, simulation::Tuning& tuning) {
  static constexpr std::array spaces{"pose", "leg"};
  static constexpr std::array feedbacks{"pressure", "acceleration", "none"};
  static constexpr std::array compensations{"load", "asymmetry", "none"};
  auto& p = tuning.parameters;
  f("lowest_oil_mode_rad_s", tuning.lowest_oil_mode);
  f.word("space", p.space, spaces);
  f("gain_1_s", p.gain);
  f("integral_time_s", p.integral_time);
  f("velocity_feedforward", p.velocity_feedforward);
  f.word("feedback", p.feedback, feedbacks);
  f("feedback_gain", p.feedback_gain);
  f("feedback_corner_rad_s", p.feedback_corner);
  f("sample_time_s", p.sample_time);
  f("delay_samples", p.delay);
  f.word("compensation", p.compensation, compensations);
  f("overlap_compensation", p.overlap_compensation);
  f("limit", p.output.limit);
}

Json controller_json(const control::ControllerParameters& parameters, double lowest_oil_mode) {
  return written(simulation::Tuning{parameters, lowest_oil_mode});
}

simulation::Tuning controller_from_json(const Json& json, const std::string& file) {
  return read<simulation::Tuning>(json, file);
}

template <class Fields>
void describe(Fields& f, Simulation& s) {
  simulation::Tuning tuning{s.controller, s.lowest_oil_mode};
  f.word("model", s.loop.kind, model_words);
  f.word("actuators", s.loop.actuators, actuator_words);
  f("damping", s.damping);
  f("commands", s.commands);
  f("wrench", s.wrench);
  f("initial", s.loop.initial);
  f("warnings", s.warnings);
  f("controller", tuning);
  f.object("run", [&](auto& run) { describe_run(run, s); });
  f.list("directions", 6,
         [&](auto& item, std::size_t i) { describe_direction(item, s, static_cast<int>(i)); });
  f.list("legs", model::leg_count, [&](auto& item, std::size_t i) { describe_leg(item, s, i); });
  f.object("trace", [&](auto& trace) {
    trace("time_s", s.trace.time);
    histories(trace, "command", s.trace.command);
    histories(trace, "motion", s.trace.motion);
    histories(trace, "piston_m", s.trace.piston);
    histories(trace, "drive", s.trace.drive);
    histories(trace, "cap_pressure_Pa", s.trace.cap_pressure);
    histories(trace, "rod_pressure_Pa", s.trace.rod_pressure);
    if (s.trace.torque.empty() && !trace.has("torque_N_m")) return;
    histories(trace, "nut_m", s.trace.nut);
    histories(trace, "motor_speed_rad_s", s.trace.motor_speed);
    histories(trace, "torque_N_m", s.trace.torque);
  });
  if constexpr (Fields::reads) {
    s.controller = tuning.parameters;
    s.lowest_oil_mode = tuning.lowest_oil_mode;
  }
}

Json simulation_json(const Simulation& simulation) { return written(simulation); }

Simulation simulation_from_json(const Json& json, const std::string& file) {
  return read<Simulation>(json, file);
}

Json simulation_section(const Simulation& simulation, const model::Machine& machine,
                        const model::NamedPose& pose, const dynamics::LinearModel& rest) {
  double used = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& stops = simulation.stops[i];
    const double room = stops.high - stops.low;
    const double moved = simulation.summary.piston_high[i] - simulation.summary.piston_low[i];
    used = std::max(used, room > 0.0 ? moved / room : 0.0);
  }
  Json json{
      {"pose", pose.name},
      {"geometry", geometry_json(machine, rest)},
      {"summary", fmt::format("{:.4g} s simulated; the leg that moved most used {:.1f} % of its "
                              "stroke.",
                              simulation.trace.time.empty() ? 0.0 : simulation.trace.time.back(),
                              100.0 * used)}};
  json.update(simulation_json(simulation));
  return json;
}

}  // namespace hydrapod::report
