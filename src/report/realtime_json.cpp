#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

Json timing_json(const realtime::Timing& timing) {
  Json bins = Json::array();
  for (const auto& bin : timing.bins)
    bins.push_back({{"up_to_s", bin.up_to}, {"samples", bin.samples}});
  return {{"samples", timing.samples}, {"p50_s", timing.p50},       {"p99_s", timing.p99},
          {"p99_9_s", timing.p99_9},   {"p99_99_s", timing.p99_99}, {"worst_s", timing.worst},
          {"histogram", bins}};
}

const char* end_word(simulation::RunEnd end) {
  if (end == simulation::RunEnd::finished) return "finished";
  return end == simulation::RunEnd::stopped ? "stopped" : "failed";
}

}  // namespace

Json serve_json(const realtime::ServeResult& r) {
  const auto& c = r.counters;
  Json json{{"place", r.place},
            {"lock_step", r.lock_step},
            {"sample_time_s", r.sample_time},
            {"end", end_word(r.run.end)},
            {"message", r.run.message},
            {"time_s", r.run.time},
            {"samples", r.run.samples},
            {"state", realtime::name(r.state)},
            {"scheduling", r.scheduling},
            {"warnings", r.warnings}};
  json["commands"] = {
      {"accepted", c.accepted},   {"superseded", c.superseded}, {"missed", c.missed},
      {"lost", c.lost},           {"reordered", c.reordered},   {"duplicated", c.duplicated},
      {"malformed", c.malformed}, {"refused", c.refused},       {"out_of_range", c.out_of_range},
      {"trips", c.trips}};
  json["sensors"] = {{"sent", r.sent}, {"not_sent", r.not_sent}};
  json["record_rows_lost"] = r.rows_lost;
  json["step"] = timing_json(r.step);
  json["step_processor"] = timing_json(r.step_processor);
  if (r.lock_step) return json;
  json["deadline_misses"] = r.misses;
  json["overruns"] = r.overruns;
  json["clock_shifts"] = r.shifts;
  json["lateness"] = timing_json(r.lateness);
  return json;
}

}  // namespace hydrapod::report
