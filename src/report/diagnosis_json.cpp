#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/quantiles.hpp"
#include "hydrapod/report/diagnosis.hpp"

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
          {"suspects", suspects},
          {"rigid_calculation", e.rigid},
          {"model", dynamics::name(e.kind)},
          {"fitted_numbers", e.parameters},
          {"by_mechanics", e.by_mechanics},
          {"misfit", e.misfit},
          {"response_misfit", e.fit.responses.empty() ? Json() : Json(responses)},
          {"criterion", e.criterion},
          {"above_best", e.criterion - d.best().criterion},
          {"alike", std::ranges::count(d.alike, index) > 0},
          {"parameters", parameters},
          {"targets", targets},
          {"wrong", e.wrong}};
}

Json mode_json(const MeasuredMode& m) {
  return {{"pose", m.pose},
          {"direction", direction(m.direction)},
          {"frequency_hz", m.omega / two_pi},
          {"deviation_hz", m.deviation / two_pi},
          {"stated_hz", m.omega_stated / two_pi},
          {"explained_hz", m.omega_best / two_pi},
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
                       {"today_hz", c.omega_today / two_pi},
                       {"needed_hz", c.omega_needed / two_pi}});
  Json goal{{"words", goal_words(file.goal)}};
  if (file.goal.drop) goal["drop"] = *file.goal.drop;
  if (file.goal.omega) goal["frequency_hz"] = *file.goal.omega / two_pi;
  if (file.goal.direction) goal["direction"] = direction_name(*file.goal.direction);
  return {{"goal", goal},
          {"status", status.at(static_cast<std::size_t>(r.status))},
          {"today", point_json(r.today)},
          {"needed", point_json(r.needed)},
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
    json["explanations"] = explanations;
    json["discriminators"] = tell;
  }
  json["pose"] = file.pose;
  json["attribution"] = Json::array();
  for (const auto& drop : file.drops) json["attribution"].push_back(drop_json(drop));
  if (file.remedy) json["remedy"] = remedy_json(file);
  return json;
}

namespace {

[[noreturn]] void bad(const std::string& file, const std::string& key, const std::string& what) {
  throw base::InputError({{.file = file, .key = key, .message = what}});
}

double number(const Json& object, const char* key, const std::string& file) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number())
    bad(file, std::string("modes[].") + key, "expected a number, as `hydrapod identify` writes it");
  return found->get<double>();
}

/// Row `o` of a complex vector {re: [], im: []}.
std::complex<double> element(const Json& vector, std::size_t o, const std::string& file) {
  const auto part = [&](const char* name) {
    const auto found = vector.find(name);
    if (found == vector.end() || !found->is_array() || found->size() <= o ||
        !(*found)[o].is_number())
      bad(file, std::string("modes[].displacement_shape.") + name,
          "expected one number per output, as `hydrapod identify` writes them");
    return (*found)[o].get<double>();
  };
  return {part("re"), part("im")};
}

/// Units and directions of the outputs.
std::vector<data::Channel> outputs_of(const Json& json) {
  std::vector<data::Channel> outputs;
  for (const auto& output : json["outputs"]) {
    outputs.emplace_back();
    if (!output.is_object()) continue;
    outputs.back() = {.unit = output.value("unit", ""),
                      .direction = data::direction_from_text(output.value("direction", ""))
                                       .value_or(data::Direction::none)};
  }
  return outputs;
}

/// Those that it names, with their roles.
std::vector<data::Channel> inputs_of(const Json& json) {
  std::vector<data::Channel> inputs;
  const auto named = json.find("inputs");
  if (named == json.end() || !named->is_array()) return inputs;
  for (const auto& input : *named) {
    const bool says = input.is_object() && input.contains("role") && input["role"].is_string();
    inputs.push_back({.role = data::role_from_text(says ? input["role"].get<std::string>() : "")
                                  .value_or(data::Role::other)});
  }
  return inputs;
}

/// What its inputs see: the plant, where they drive the valves; the machine under its controller,
/// where `hydrapod identify` compared it with that; else mechanics.
observation::Observed observed_in(const Json& json) {
  if (observation::from_drives(inputs_of(json))) return observation::Observed::plant;
  const auto compared = json.find("comparison");
  const bool controlled =
      compared != json.end() && compared->is_object() &&
      compared->value("source", Json()) == observation::name(observation::Observed::system);
  return controlled ? observation::Observed::system : observation::Observed::mechanics;
}

/// Of the responses that were fitted [Hz]; 0: not said.
double line_spacing(const Json& json) {
  const auto indicator = json.find("indicator");
  if (indicator == json.end() || !indicator->is_object()) return 0.0;
  const auto lines = indicator->value("frequency_hz", Json());
  if (!lines.is_array() || lines.size() < 2 || !lines.front().is_number() ||
      !lines.back().is_number())
    return 0.0;
  const double span = lines.back().get<double>() - lines.front().get<double>();
  return std::max(0.0, span) / static_cast<double>(lines.size() - 1);
}

data::ModalResult mode_from_json(const Json& mode, std::size_t outputs, const std::string& file) {
  constexpr double band = numerics::normal_half_width;
  if (!mode.is_object()) bad(file, "modes", "holds something that is no mode");
  const double omega = two_pi * number(mode, "frequency_hz", file);
  const double damping = number(mode, "damping_ratio", file);
  if (!(omega > 0.0)) bad(file, "modes[].frequency_hz", "expected a number above 0");
  data::ModalResult result{
      .pole =
          omega * std::complex<double>(-damping, std::sqrt(std::max(0.0, 1.0 - damping * damping))),
      .omega_deviation = two_pi * number(mode, "frequency_95_hz", file) / band,
      .damping_deviation = number(mode, "damping_95", file) / band};
  if (const auto found = mode.find("significance"); found != mode.end() && found->is_number())
    result.significance = found->get<double>();
  const auto count = static_cast<Eigen::Index>(outputs);
  result.shape.setConstant(count, std::numeric_limits<double>::quiet_NaN());
  result.shape_deviation.setZero(count);
  const auto shape = mode.find("displacement_shape"), raw = mode.find("shape"),
             spread = mode.find("shape_deviation");
  for (std::size_t o = 0; shape != mode.end() && o < outputs; ++o) {
    const auto row = static_cast<Eigen::Index>(o);
    result.shape[row] = element(*shape, o, file);
    if (raw == mode.end() || spread == mode.end() || !spread->is_array() || spread->size() <= o)
      continue;
    const double size = std::abs(element(*raw, o, file));
    if (size > 0.0 && (*spread)[o].is_number())
      result.shape_deviation[row] = (*spread)[o].get<double>() * std::abs(result.shape[row]) / size;
  }
  return result;
}

}  // namespace

observation::Targets modes_from_json(const Json& json, const std::string& file,
                                     const model::Machine& machine,
                                     const observation::MeasuredAt& where) {
  for (const char* key : {"modes", "outputs"})
    if (!json.contains(key) || !json[key].is_array())
      bad(file, key, "is missing; `hydrapod identify RECORD --format json` writes such a file");
  if (json["modes"].empty()) bad(file, "modes", "is empty: no mode was identified");
  data::ModalResults results{
      .outputs = outputs_of(json), .inputs = inputs_of(json), .line_spacing = line_spacing(json)};
  for (const auto& mode : json["modes"])
    results.modes.push_back(mode_from_json(mode, results.outputs.size(), file));
  auto at = where;
  if (!at.observed) at.observed = observed_in(json);
  auto targets = observation::measured_modes(results, machine, at);
  targets.title = file;
  return targets;
}

}  // namespace hydrapod::report
