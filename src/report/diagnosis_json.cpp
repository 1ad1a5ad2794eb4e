#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

namespace {

using namespace diagnosis;

using base::two_pi;

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json direction(int number) { return number < 0 ? Json() : Json(direction_name(number)); }

Json explanation_json(const Diagnosis& d, std::size_t index) {
  const auto& e = d.explanations[index];
  Json suspects = Json::array(), parameters = Json::array(), targets = Json::array();
  for (const auto s : e.suspects)
    suspects.push_back({{"name", d.suspects[s].name},
                        {"statement", d.suspects[s].statement},
                        {"family", d.suspects[s].family}});
  for (const auto& p : e.fit.parameters)
    parameters.push_back({{"paths", p.paths},
                          {"unit", p.unit},
                          {"start", p.start},
                          {"value", p.value},
                          {"deviation", finite(p.deviation)},
                          {"interval_95", {finite(p.interval_low), finite(p.interval_high)}},
                          {"at_bound", p.verdict == calibration::Verdict::at_bound}});
  for (const auto& t : e.fit.targets)
    targets.push_back({{"frequency_hz", t.omega / two_pi},
                       {"difference", t.difference},
                       {"shape_mac", t.shape_mac}});
  double responses = 0.0;
  for (const auto& r : e.fit.responses) responses += r.difference * r.difference;
  return {{"name", e.name},
          {"causes", suspects},
          {"rigid_legs", e.rigid},
          {"model", dynamics::name(e.kind)},
          {"fitted_parameters", e.parameters},
          {"by_mechanics", e.by_mechanics},
          {"misfit", e.misfit},
          {"response_misfit", e.fit.responses.empty() ? Json() : Json(responses)},
          {"bic", e.criterion},
          {"bic_above_best", e.criterion - d.best().criterion},
          {"equally_good", std::ranges::count(d.alike, index) > 0},
          {"parameters", parameters},
          {"targets", targets},
          {"contradictions", e.wrong}};
}

Json mode_json(const MeasuredMode& m) {
  return {{"pose", m.pose},
          {"direction", direction(m.direction)},
          {"frequency_hz", m.omega / two_pi},
          {"deviation_hz", m.deviation / two_pi},
          {"nominal_hz", m.omega_stated / two_pi},
          {"fitted_hz", m.omega_best / two_pi},
          {"shape_mac", m.shape_mac},
          {"rigid_hz", m.omega_rigid > 0.0 ? Json(m.omega_rigid / two_pi) : Json()},
          {"rigid_mac", m.rigid_mac},
          {"drop", m.drop()},
          {"strain_energy",
           {{"oil", m.oil},
            {"guide_sleeve", m.guide_sleeves},
            {"piston_ring", m.piston_rings},
            {"base_mount", m.base}}}};
}

Json point_json(const RemedyPoint& p) {
  return {{"factor", p.factor},
          {"stiffness_N_m", p.stiffness},
          {"frequency_hz", p.omega / two_pi},
          {"drop", p.drop}};
}

Json remedy_json(const CaseFile& file) {
  constexpr std::array status{"found", "met_already", "out_of_reach"};
  const auto& r = *file.remedy;
  Json curve = Json::array(), changes = Json::array();
  for (const auto& point : r.curve) curve.push_back(point_json(point));
  for (const auto& c : r.changes)
    changes.push_back({{"pose", c.pose},
                       {"direction", c.direction},
                       {"rigid_hz", c.omega_rigid / two_pi},
                       {"nominal_hz", c.omega_today / two_pi},
                       {"required_hz", c.omega_needed / two_pi}});
  Json goal{{"words", goal_words(file.goal)}};
  if (file.goal.drop) goal["drop"] = *file.goal.drop;
  if (file.goal.omega) goal["frequency_hz"] = *file.goal.omega / two_pi;
  if (file.goal.direction) goal["direction"] = direction_name(*file.goal.direction);
  return {{"goal", goal},
          {"status", status.at(static_cast<std::size_t>(r.status))},
          {"nominal", point_json(r.today)},
          {"required", point_json(r.needed)},
          {"rigid_sleeves", point_json(r.limit)},
          {"pose", r.pose},
          {"direction", r.direction},
          {"curve", curve},
          {"changes", changes}};
}

Json drop_json(const AttributedDrop& drop) {
  Json parts = Json::array();
  for (const auto& p : drop.parts)
    parts.push_back({{"part", part_name(p.part)},
                     {"leg", p.part.leg ? Json(*p.part.leg + 1) : Json()},
                     {"frequency_hz", p.omega / two_pi},
                     {"share", p.share}});
  const auto& r = drop.resonance;
  return {{"direction", r.direction},
          {"rigid_hz", r.omega_rigid / two_pi},
          {"frequency_hz", r.omega / two_pi},
          {"drop", r.drop()},
          {"mac", r.mac},
          {"parts", parts}};
}

}  // namespace

Json diagnosis_json(const CaseFile& file) {
  Json json{{"summary", summary(file)}};
  if (file.diagnosis) {
    const auto& d = *file.diagnosis;
    Json explanations = Json::array(), modes = Json::array(), tell = Json::array();
    for (std::size_t k = 0; k < d.explanations.size(); ++k)
      explanations.push_back(explanation_json(d, k));
    for (const auto& mode : d.modes) modes.push_back(mode_json(mode));
    for (const auto& x : d.discriminators)
      tell.push_back({{"best", d.explanations[d.alike.front()].name},
                      {"other", d.explanations[x.other].name},
                      {"pose", x.pose},
                      {"direction", direction(x.direction)},
                      {"best_hz", x.omega_best / two_pi},
                      {"other_hz", x.omega_other / two_pi},
                      {"deviations", x.deviations}});
    json["finding"] = name(d.finding);
    json["reasons"] = d.reasons;
    json["notes"] = d.notes;
    json["observed"] = observation::name(d.targets.observed);
    Json lines = Json::array();
    for (const auto& response : d.targets.responses) {
      Json hertz = Json::array();
      for (const auto& s : response.s) hertz.push_back(s.imag() / two_pi);
      lines.push_back({{"pose", response.pose},
                       {"entry", observation::name(response.entry)},
                       {"frequency_hz", hertz}});
    }
    json["response_lines"] = lines;
    json["measured_values"] = d.values;
    json["scatter"] = d.scatter;
    json["interrupted"] = d.interrupted;
    json["measured_modes"] = modes;
    json["hypotheses"] = explanations;
    json["discriminators"] = tell;
  }
  json["pose"] = file.pose;
  json["attribution"] = Json::array();
  for (const auto& drop : file.drops) json["attribution"].push_back(drop_json(drop));
  if (file.remedy) json["remedy"] = remedy_json(file);
  return json;
}

}  // namespace hydrapod::report
