#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/report/geometry_json.hpp"
#include "hydrapod/report/simulation.hpp"
#include "hydrapod/spatial/directions.hpp"

namespace hydrapod::report {

namespace {

using spatial::Vector6;

using spatial::direction_names;
constexpr std::array<const char*, 3> ends{"finished", "stopped", "failed"};

Json six(const Vector6& values) {
  Json list = Json::array();
  for (int i = 0; i < 6; ++i) list.push_back(values[i]);
  return list;
}

/// Six lists, one per direction or leg, of a history.
Json histories(const std::vector<Vector6>& samples) {
  Json lists = Json::array();
  for (int i = 0; i < 6; ++i) {
    std::vector<double> list(samples.size());
    for (std::size_t k = 0; k < samples.size(); ++k) list[k] = samples[k][i];
    lists.push_back(std::move(list));
  }
  return lists;
}

Json direction_json(const Simulation& s, int i) {
  const auto& summary = s.summary;
  Json json{{"direction", direction_names[static_cast<std::size_t>(i)]},
            {"peak_command", summary.peak_command[i]},
            {"peak_motion", summary.peak_motion[i]},
            {"rms_error", summary.rms_error[i]},
            {"peak_error", summary.peak_error[i]},
            {"final_error", summary.final_error[i]}};
  if (const auto at = s.step_time[static_cast<std::size_t>(i)]) {
    json["settling_band"] = s.settling_band[i];
    const bool settled = std::abs(summary.final_error[i]) <= s.settling_band[i];
    json["settling_time_s"] = settled ? Json(std::max(summary.settled[i] - *at, 0.0)) : Json();
  }
  return json;
}

Json leg_json(const Simulation& s, std::size_t i) {
  const auto& stops = s.stops[i];
  const double used = s.summary.piston_high[i] - s.summary.piston_low[i];
  const double samples = static_cast<double>(std::max(s.summary.samples, 1L));
  return {{"stroke_m", {stops.low, stops.high}},
          {"piston_m", {s.summary.piston_low[i], s.summary.piston_high[i]}},
          {"stroke_used", used / (stops.high - stops.low)},
          {"peak_speed_m_s", s.summary.peak_speed[i]},
          {"peak_drive", s.summary.peak_drive[i]},
          {"share_at_limit", static_cast<double>(s.summary.limited[i]) / samples}};
}

Json run_json(const Simulation& s) {
  Json events = Json::array();
  for (const auto& event : s.summary.events)
    events.push_back({{"time_s", event.time},
                      {"leg", event.leg + 1},
                      {"event", simulation::Plant::name(event.event)},
                      {"begins", event.begins}});
  const auto& integrator = s.loop.integrator;
  const auto& counts = s.summary.integrator;
  return {{"end", ends[static_cast<std::size_t>(s.summary.end)]},
          {"message", s.summary.message},
          {"time_s", s.summary.time},
          {"until_s", s.until},
          {"output_interval_s", s.output_interval},
          {"seed", s.loop.seed},
          {"integrator", simulation::name(integrator.method)},
          {"relative_tolerance", integrator.relative_tolerance},
          {"steps", counts.steps},
          {"evaluations", counts.evaluations},
          {"events", std::move(events)}};
}

}  // namespace

Json controller_json(const control::ControllerParameters& p, double lowest_oil_mode) {
  constexpr std::array<const char*, 2> spaces{"pose", "leg"};
  constexpr std::array<const char*, 3> feedbacks{"pressure", "acceleration", "none"};
  constexpr std::array<const char*, 3> compensations{"load", "asymmetry", "none"};
  return {{"lowest_oil_mode_rad_s", lowest_oil_mode},
          {"space", spaces[static_cast<std::size_t>(p.space)]},
          {"gain_1_s", six(p.gain)},
          {"integral_time_s", p.integral_time},
          {"velocity_feedforward", p.velocity_feedforward},
          {"feedback", feedbacks[static_cast<std::size_t>(p.feedback)]},
          {"feedback_gain", six(p.feedback_gain)},
          {"feedback_corner_rad_s", p.feedback_corner},
          {"sample_time_s", p.sample_time},
          {"delay_samples", p.delay},
          {"compensation", compensations[static_cast<std::size_t>(p.compensation)]},
          {"overlap_compensation", p.overlap_compensation},
          {"limit", p.output.limit}};
}

Json simulation_json(const Simulation& s) {
  Json json{{"model", dynamics::name(s.loop.kind)},
            {"commands", s.commands},
            {"warnings", s.warnings},
            {"controller", controller_json(s.controller, s.lowest_oil_mode)},
            {"run", run_json(s)},
            {"directions", Json::array()},
            {"legs", Json::array()}};
  for (int i = 0; i < 6; ++i) json["directions"].push_back(direction_json(s, i));
  for (std::size_t i = 0; i < model::leg_count; ++i) json["legs"].push_back(leg_json(s, i));
  json["trace"] = {{"time_s", s.trace.time},
                   {"command", histories(s.trace.command)},
                   {"motion", histories(s.trace.motion)},
                   {"piston_m", histories(s.trace.piston)},
                   {"drive", histories(s.trace.drive)},
                   {"cap_pressure_Pa", histories(s.trace.cap_pressure)},
                   {"rod_pressure_Pa", histories(s.trace.rod_pressure)}};
  return json;
}

Json simulation_section(const Simulation& simulation, const model::Machine& machine,
                        const PoseChoice& pose, const dynamics::LinearModel& rest) {
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
