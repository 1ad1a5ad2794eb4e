#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fitted_parameter.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

namespace {

using namespace diagnosis;

using base::two_pi;

/// A direction 0…5, −1 being null.
template <class Fields>
void describe_axis(Fields& f, const char* key, int& direction) {
  std::optional<std::string> name;
  if (direction >= 0) name = direction_name(direction);
  f(key, name);
  if constexpr (Fields::reads) {
    direction = -1;
    if (!name) return;
    const auto found = spatial::direction_from_name(*name);
    if (!found) f.bad(key, fmt::format("is \"{}\", expected one of x, y, z, rx, ry, rz", *name));
    direction = *found;
  }
}

/// A leg 0…5, counted from 1 in JSON; none being null.
template <class Fields>
void describe_leg_number(Fields& f, std::optional<int>& leg) {
  auto number = leg;
  if (number) ++*number;
  f("leg", number);
  if constexpr (Fields::reads) {
    if (number && (*number < 1 || *number > model::leg_count))
      f.bad("leg", fmt::format("expected a number from 1 to {}", model::leg_count));
    leg = number;
    if (leg) --*leg;
  }
}

template <class Fields>
void describe_resonance_direction(Fields& f, std::string& direction) {
  auto words = direction_words(direction);
  f("direction", words);
  if constexpr (Fields::reads) direction = words == direction_words("") ? "" : words;
}

/// A list of objects: describe_one(fields, item).
template <class Fields, class Item, class Describe>
void describe_each(Fields& f, const char* key, std::vector<Item>& items,
                   const Describe& describe_one) {
  if constexpr (Fields::reads) items.resize(f.size(key));
  f.list(key, items.size(), [&](auto& item, std::size_t k) { describe_one(item, items[k]); });
}

}  // namespace

template <class Fields>
void describe(Fields& f, Place& place) {
  f("pose", place.pose);
  describe_axis(f, "direction", place.direction);
  f("mode", place.mode);
}

template <class Fields>
void describe(Fields& f, Contradiction& c) {
  using Kind = Contradiction::Kind;
  static constexpr std::array kinds{"resonances", "frequency", "shape",
                                    "drives",     "forces",    "value"};
  f.word("code", c.kind, kinds);
  f("places", c.places);
  if (c.kind == Kind::resonances) {
    f("predicted", c.predicted);
    return f("measured", c.measured);
  }
  f.scaled("frequency_hz", c.omega, two_pi);
  if (c.kind == Kind::frequency || c.kind == Kind::value)
    f.scaled("difference_hz", c.difference, two_pi);
  if (c.kind == Kind::shape || c.kind == Kind::drives) f("mac", c.mac);
  if (c.kind == Kind::forces) f("missed", c.missed);
  if (c.kind != Kind::value) return;
  describe_axis(f, "direction", c.direction);
  f("value", c.value);
  f("deviation", c.deviation);
  f("unit", c.unit);
}

template <class Fields>
void describe(Fields& f, Objection& objection) {
  static constexpr std::array kinds{"few_modes", "no_directions", "few_directions", "frequencies"};
  static constexpr std::array slips{"none", "thousand", "radians", "per_minute",
                                    "mass_or_stiffness"};
  f.word("code", objection.kind, kinds);
  f("count", objection.count);
  f("ratio", objection.ratio);
  f.word("slip", objection.slip, slips);
}

template <class Fields>
void describe(Fields& f, Substitution& substitution) {
  f.word("measured", substitution.measured, words_of<observation::Observed, 3>(observation::name));
  f("error", substitution.error);
}

template <class Fields>
void describe(Fields& f, MeasuredMode& m) {
  std::optional<double> rigid_hz;
  if (m.omega_rigid > 0.0) rigid_hz = m.omega_rigid / two_pi;
  f("pose", m.pose);
  describe_axis(f, "direction", m.direction);
  f.unless(0.0, "amplitude_m", m.amplitude);
  f.scaled("frequency_hz", m.omega, two_pi);
  f.scaled("deviation_hz", m.deviation, two_pi);
  if (!Fields::reads || f.has("common_deviation_hz"))  // files of earlier versions have none
    f.scaled("common_deviation_hz", m.common_deviation, two_pi);
  f.scaled("nominal_hz", m.omega_stated, two_pi);
  f.scaled("fitted_hz", m.omega_best, two_pi);
  if (m.mode_direction >= 0 || f.has("mode_direction"))
    describe_axis(f, "mode_direction", m.mode_direction);
  f("shape_mac", m.shape_mac);
  f("rigid_hz", rigid_hz);
  f("rigid_mac", m.rigid_mac);
  f.unless(false, "resonance", m.resonance);
  f.derived("drop", m.drop());
  f.derived("peak_height",
            m.omega_rigid > 0.0 ? report::peak_height(m.rigid_mac, m.omega, m.omega_rigid) : 0.0);
  f.object("strain_energy", [&](auto& energy) {
    energy("oil", m.oil);
    describe_axial_part(energy, m.leg_type);
    energy("guide_sleeve", m.guide_sleeves);
    energy("piston_ring", m.piston_rings);
    energy("base_mount", m.base);
    energy.unless(0.0, "payload", m.payload);
    energy.unless(0.0, "bending", m.bending);
  });
  if constexpr (Fields::reads) m.omega_rigid = two_pi * rigid_hz.value_or(0.0);
}

template <class Fields>
void describe(Fields& f, PartShare& share) {
  if constexpr (!Fields::reads) f.derived("part", part_name(share.part));
  describe_leg_number(f, share.part.leg);
  f.scaled("frequency_hz", share.omega, two_pi);
  f("share", share.share);
  static constexpr std::array compliances{"guide_sleeve", "piston_ring", "gimbals",
                                          "base_mount",   "payload",     "bending"};
  f.word("code", share.part.what, compliances);
}

template <class Fields>
void describe(Fields& f, SharedMode& mode) {
  f.scaled("frequency_hz", mode.omega, two_pi);
  f("mac", mode.mac);
}

template <class Fields>
void describe(Fields& f, AttributedDrop& drop) {
  auto& r = drop.resonance;
  f("direction", r.direction);
  f.scaled("rigid_hz", r.omega_rigid, two_pi);
  f.scaled("frequency_hz", r.omega, two_pi);
  f.derived("drop", r.drop());
  f("mac", r.mac);
  f.derived("peak_height", report::peak_height(r.mac, r.omega, r.omega_rigid));
  f.optional("below", r.below);
  f("parts", drop.parts);
}

template <class Fields>
void describe(Fields& f, RemedyPoint& p) {
  f("factor", p.factor);
  f("stiffness_N_m", p.stiffness);
  f.scaled("frequency_hz", p.omega, two_pi);
  f("drop", p.drop);
  f("mac", p.mac);
  f.optional("softest_N_m", p.softest);
}

template <class Fields>
void describe(Fields& f, Change& change) {
  f("pose", change.pose);
  describe_resonance_direction(f, change.direction);
  f.scaled("rigid_hz", change.omega_rigid, two_pi);
  f.scaled("present_hz", change.omega_today, two_pi);
  f.scaled("required_hz", change.omega_needed, two_pi);
  f("present_mac", change.mac_today);
  f("required_mac", change.mac_needed);
}

template <class Fields>
void describe(Fields& f, RemedyGoal& goal) {
  std::optional<double> hertz;
  std::optional<std::string> direction;
  if (goal.omega) hertz = *goal.omega / two_pi;
  if (goal.direction) direction = direction_name(*goal.direction);
  if constexpr (!Fields::reads) f.derived("words", goal_words(goal));
  f.optional("drop", goal.drop);
  f.optional("frequency_hz", hertz);
  f.optional("direction", direction);
  if constexpr (Fields::reads) {
    if (hertz) goal.omega = two_pi * *hertz;
    if (direction) goal.direction = spatial::direction_from_name(*direction);
  }
}

namespace {

template <class Fields>
void describe_cause(Fields& f, Cause& cause) {
  static constexpr std::array kinds{
      "guide_sleeves",  "piston_rings",  "bulk_modulus",     "oil_springs",     "air",
      "cap_volume",     "rod_volume",    "gimbals",          "sticking_seals",  "payload",
      "payload_height", "inertia",       "mass_and_inertia", "mass_center",     "base_lateral",
      "base_vertical",  "base_rocking",  "oil_lines",        "leakage",         "payload_sways",
      "payload_heaves", "payload_modes", "rods_bend",        "elastomer_ratio", "elastomer_loss",
      "struts",         "screws",        "guide_clearance"};
  static constexpr std::array families{"guide sleeves", "piston rings", "leg axes",  "platform",
                                       "mass centre",   "base",         "oil lines", "leakage",
                                       "payload modes", "bending",      "elastomers"};
  if constexpr (!Fields::reads) {
    f.derived("name", cause_name(cause));
    f.derived("statement", cause_statement(cause));
    f.derived("family", families.at(static_cast<std::size_t>(cause.family())));
  }
  f.word("code", cause.kind, kinds);
  describe_leg_number(f, cause.leg);
}

/// Index of a cause that was read, which is added where it is new.
std::size_t index_of(const Cause& cause, std::vector<Cause>& all) {
  const auto found = std::ranges::find_if(
      all, [&](const Cause& other) { return other.kind == cause.kind && other.leg == cause.leg; });
  const auto index = static_cast<std::size_t>(found - all.begin());
  if (found == all.end()) all.push_back(cause);
  return index;
}

template <class Fields>
void describe_hypothesis(Fields& f, Hypothesis& e, std::size_t index, Diagnosis& d) {
  std::vector<Cause> causes;
  for (const auto k : e.causes) causes.push_back(d.causes[k]);
  bool equally_good = std::ranges::count(d.equivalent, index) > 0;
  std::optional<double> responses;
  if (!e.fit.responses.empty()) responses = e.response_misfit();
  if constexpr (!Fields::reads) f.derived("name", hypothesis_name(d, e));
  describe_each(f, "causes", causes, [](auto& item, Cause& cause) { describe_cause(item, cause); });
  f("rigid_legs", e.rigid);
  f.word("model", e.kind, model_words);
  f("fitted_parameters", e.parameters);
  f("by_mechanics", e.by_mechanics);
  f("misfit", e.misfit);
  f("response_misfit", responses);
  if constexpr (!Fields::reads) {
    const auto fit = goodness(d, e);
    f.derived("frequency_misfit", fit.frequencies.sum);
    f.derived("reduced_misfit", fit.reduced);
    f.derived("probability", fit.probability);
  }
  f("bic", e.bic);
  f.derived("bic_above_best", e.bic - d.best().bic);
  f("equally_good", equally_good);
  describe_each(f, "parameters", e.fit.parameters,
                [](auto& item, auto& p) { describe_parameter(item, p, false); });
  describe_each(f, "targets", e.fit.targets, [](auto& item, auto& target) {
    item.scaled("frequency_hz", target.omega, two_pi);
    item("difference", target.difference);
    item("shape_mac", target.shape_mac);
  });
  if constexpr (!Fields::reads) f.derived("contradictions", contradiction_words(d, e));
  f("contradiction_codes", e.wrong);
  f("from_nominal", e.from_nominal);
  f.optional("air_pressure_Pa", e.air_pressure);
  if constexpr (Fields::reads) {
    for (const auto& cause : causes) e.causes.push_back(index_of(cause, d.causes));
    if (equally_good) d.equivalent.push_back(index);
    if (responses) e.fit.responses = {{.difference = std::sqrt(*responses)}};
  }
}

template <class Fields>
void describe_untested(Fields& f, Untested& untested, Diagnosis& d) {
  std::vector<Cause> causes;
  for (const auto k : untested.causes) causes.push_back(d.causes[k]);
  describe_each(f, "causes", causes, [](auto& item, Cause& cause) { describe_cause(item, cause); });
  f("error", untested.error);
  if constexpr (Fields::reads)
    for (const auto& cause : causes) untested.causes.push_back(index_of(cause, d.causes));
}

template <class Fields>
void describe_lines(Fields& f, observation::ResponseTarget& response) {
  std::vector<double> hertz;
  for (const auto& s : response.s) hertz.push_back(s.imag() / two_pi);
  f("pose", response.pose);
  f.word("entry", response.entry, words_of<observation::Entry, 3>(observation::name));
  f("frequency_hz", hertz);
  f.maybe("values", response.values);
  if constexpr (Fields::reads)
    for (const double frequency : hertz) response.s.emplace_back(0.0, two_pi * frequency);
}

template <class Fields>
void describe_discriminator(Fields& f, Discriminator& x, const Diagnosis& d) {
  std::vector<std::string> names;
  for (const auto& e : d.hypotheses) names.push_back(hypothesis_name(d, e));
  std::string other = names.at(x.other);
  f.derived("best", names.at(d.equivalent.empty() ? 0 : d.equivalent.front()));
  f("other", other);
  f("pose", x.pose);
  describe_axis(f, "direction", x.direction);
  f.scaled("best_hz", x.omega_best, two_pi);
  f.scaled("other_hz", x.omega_other, two_pi);
  f("deviations", x.deviations);
  if constexpr (Fields::reads) {
    const auto found = std::ranges::find(names, other);
    if (found == names.end()) f.bad("other", "is none of the hypotheses");
    x.other = static_cast<std::size_t>(found - names.begin());
  }
}

template <class Fields>
void describe_diagnosis(Fields& f, Diagnosis& d) {
  f.word("finding", d.finding, words_of<Finding, 8>(finding_word));
  if constexpr (!Fields::reads) {
    f.derived("reasons", reason_words(d));
    f.derived("notes", note_words(d));
  }
  f.word("observed", d.targets.observed, words_of<observation::Observed, 3>(observation::name));
  describe_each(f, "response_lines", d.targets.responses,
                [](auto& item, auto& response) { describe_lines(item, response); });
  f("measured_values", d.values);
  f("scatter", d.scatter);
  if constexpr (!Fields::reads) f.derived("raw_reduced_misfit", raw_scatter2(d));
  static constexpr std::array why{"scatter", "shapes_only", "unlisted",
                                  "misfit",  "untested",    "at_bound"};
  if (f.has("unexplained")) d.unexplained.emplace();
  if (d.unexplained) f.word("unexplained", *d.unexplained, why);
  if (!d.nominal_at.empty() || f.has("nominal_at")) f("nominal_at", d.nominal_at);
  if (d.odd_mode > 0 || f.has("odd_mode")) f("odd_mode", d.odd_mode);
  f("interrupted", d.interrupted);
  f("measured_modes", d.modes);
  if constexpr (Fields::reads) {
    d.hypotheses.resize(f.size("hypotheses"));
    if (d.hypotheses.empty()) f.bad("hypotheses", "is empty");
    for (const auto& mode : d.modes)
      d.targets.modes.push_back({.pose = mode.pose,
                                 .deviation = mode.deviation,
                                 .common_deviation = mode.common_deviation,
                                 .amplitude = mode.amplitude});
  }
  f.list("hypotheses", d.hypotheses.size(),
         [&](auto& item, std::size_t k) { describe_hypothesis(item, d.hypotheses[k], k, d); });
  if (!Fields::reads || f.has("untested"))
    describe_each(f, "untested", d.untested,
                  [&](auto& item, auto& one) { describe_untested(item, one, d); });
  describe_each(f, "discriminators", d.discriminators,
                [&](auto& item, auto& x) { describe_discriminator(item, x, d); });
  f("objections", d.objections);
  f.optional("substitution", d.substitution);
}

template <class Fields>
void describe_remedy(Fields& f, Remedy& r, RemedyGoal& goal) {
  static constexpr std::array status{"found", "met_already", "out_of_reach"};
  f("goal", goal);
  f.word("status", r.status, status);
  f("present", r.today);
  f("required", r.needed);
  f("rigid_sleeves", r.limit);
  f.optional("rigid_sleeves_without_bending", r.limit_without_bending);
  f("pose", r.pose);
  describe_resonance_direction(f, r.direction);
  f("curve", r.curve);
  f("changes", r.changes);
}

template <class Fields>
void describe_case(Fields& f, CaseFile& file) {
  if constexpr (Fields::reads) {
    if (f.has("finding")) file.diagnosis.emplace();
    if (f.has("remedy")) file.remedy.emplace();
  } else {
    f.derived("summary", summary(file));
  }
  if (file.diagnosis) describe_diagnosis(f, *file.diagnosis);
  static constexpr std::array machines{"nominal", "fitted"};
  f("pose", file.pose);
  f.word("computed_machine", file.fitted, machines);
  f("nominal_sleeve_N_m", file.nominal_sleeves.stiffest);
  f.optional("softest_nominal_sleeve_N_m", file.nominal_sleeves.softest);
  f("attribution", file.drops);
  if (file.remedy)
    f.object("remedy", [&](auto& inner) { describe_remedy(inner, *file.remedy, file.goal); });
}

}  // namespace

Json diagnosis_json(const CaseFile& file) {
  Writer fields;  // changes nothing
  describe_case(fields, const_cast<CaseFile&>(file));
  return std::move(fields.json);
}

CaseFile diagnosis_from_json(const Json& json, const std::string& file) {
  CaseFile read;
  Reader fields(json, file);
  describe_case(fields, read);
  return read;
}

}  // namespace hydrapod::report
