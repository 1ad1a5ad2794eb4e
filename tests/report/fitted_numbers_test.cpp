/// Every number of the JSON of calibrations and diagnoses is the number of its field: all fields
/// have different values.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/json_numbers.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;
using report::Json;

calibration::FittedParameter parameter(double first) {
  return {.paths = {"legs.rod.mass"},
          .unit = "kg",
          .start = first + 0.01,
          .lower = first + 0.02,
          .upper = first + 0.03,
          .stated = std::array{first + 0.031, first + 0.032},
          .value = first + 0.04,
          .deviation = first + 0.05,
          .interval_low = first + 0.06,
          .interval_high = first + 0.07,
          .data_deviation = first + 0.08,
          .verdict = calibration::Verdict::at_bound,
          .other_value = first + 0.09};
}

Json parameter_json(double first, bool whole) {
  Json json{{"start", first + 0.01},
            {"nominal_range", {first + 0.031, first + 0.032}},
            {"value", first + 0.04},
            {"deviation", first + 0.05},
            {"interval_95", {first + 0.06, first + 0.07}}};
  if (whole)
    json.update({{"bounds", {first + 0.02, first + 0.03}},
                 {"deviation_data_alone", first + 0.08},
                 {"other_value", first + 0.09}});
  else
    json["at_bound"] = true;
  return json;
}

observation::ModeTarget target(double first) {
  observation::ModeTarget target{.name = "one", .omega = first + 0.1, .deviation = first + 0.2};
  target.damping = first + 0.3;
  target.shape = spatial::Vector6::Ones();
  return target;
}

calibration::FittedTarget fit(double first) {
  return {.mode = static_cast<int>(first),
          .omega = first + 0.4,
          .difference = first + 0.5,
          .damping = first + 0.6,
          .shape_mac = first + 0.7,
          .outlier = first > 1.5};
}

Json target_json(double first) {
  return {{"mode", static_cast<int>(first) + 1},
          {"target_rad_s", first + 0.1},
          {"model_rad_s", first + 0.4},
          {"deviation_rad_s", first + 0.2},
          {"difference_in_deviations", first + 0.5},
          {"outlier", first > 1.5},
          {"target_damping_ratio", first + 0.3},
          {"model_damping_ratio", first + 0.6},
          {"shape_mac", first + 0.7}};
}

TEST(NumbersInJson, OfACalibration) {
  calibration::Calibration result;
  calibration::Candidate candidate{.name = "as in the file",
                                   .fitted = true,
                                   .converged = true,
                                   .misfit = 3.7,
                                   .worst = 0.19,
                                   .starts_that_agree = 5,
                                   .starts = 8};
  candidate.scatter = 1.13;
  candidate.parameters = {parameter(10.0), parameter(20.0)};
  candidate.targets = {fit(1.0), fit(2.0)};
  auto& known = candidate.identifiability;
  known.singular_values = Eigen::Vector2d(9.1, 0.8);
  known.directions = Eigen::MatrixXd{{0.11, 0.12}, {0.13, 0.14}};
  known.rank = 1;
  known.numerical_rank = 2;
  known.correlations = Eigen::MatrixXd{{1.0, 0.31}, {0.32, 1.0}};
  known.trades = {
      {.parameters = {0, 1}, .direction = Eigen::Vector2d(1.0, -0.93), .deviation = 0.41}};
  candidate.unbound = {{.misfit = 2.1, .worst = 0.17, .values = {6.1, 6.2}}};
  result.candidates = {candidate};
  const observation::Targets targets{.modes = {target(1.0), target(2.0)}, .deviations_given = true};
  expect_numbers(
      report::calibration_json(result, targets),
      {{"deviations_given", true},
       {"interrupted", false},
       {"candidates",
        Json::array({{{"fitted", true},
                      {"admissible", true},
                      {"converged", true},
                      {"starts", 8},
                      {"starts_that_agree", 5},
                      {"misfit", 3.7},
                      {"raw_reduced_misfit", 3.7 / 13.0},  // degrees of freedom of these targets
                      {"worst_rad_s", 0.19},
                      {"scatter", 1.13},
                      {"parameters", {parameter_json(10.0, true), parameter_json(20.0, true)}},
                      {"targets", {target_json(1.0), target_json(2.0)}},
                      {"identifiability",
                       {{"singular_values", {9.1, 0.8}},
                        {"directions", {{0.11, 0.12}, {0.13, 0.14}}},
                        {"rank", 1},
                        {"numerical_rank", 2},
                        {"correlations", {{1.0, 0.31}, {0.32, 1.0}}},
                        {"trade_offs", Json::array({{{"parameters", {0, 1}},
                                                     {"relative_direction", {1.0, -0.93}},
                                                     {"relative_deviation", 0.41}}})}}},
                      {"unconstrained",
                       {{"misfit", 2.1}, {"worst_rad_s", 0.17}, {"values", {6.1, 6.2}}}}}})}});
}

TEST(NumbersInJson, OfAProfile) {
  calibration::Candidate candidate;
  candidate.parameters = {parameter(1.0)};
  const calibration::Profile profile{
      .points = {{1.1, 7.3}, {1.2, 5.1}}, .interval_low = 1.13, .interval_high = 1.19};
  expect_numbers(report::profile_json(profile, candidate),
                 {{"interval_95", {1.13, 1.19}}, {"values", {1.1, 1.2}}, {"misfits", {7.3, 5.1}}});
}

TEST(NumbersInJson, OfSensitivities) {
  calibration::Sensitivities s;
  s.omega = Eigen::Vector2d(two_pi * 1.5, two_pi * 2.5);
  s.parameters = {{.path = "a", .unit = "kg", .value = 3.1},
                  {.path = "b", .unit = "m", .value = 3.2}};
  s.percent_per_percent = Eigen::MatrixXd{{0.1, 0.2}, {0.3, 0.4}};
  expect_numbers(report::sensitivity_json(s),
                 {{"modes",
                   {{{"omega_rad_s", two_pi * 1.5}, {"frequency_hz", 1.5}},
                    {{"omega_rad_s", two_pi * 2.5}, {"frequency_hz", 2.5}}}},
                  {"parameters", {{{"value", 3.1}}, {{"value", 3.2}}}},
                  {"percent_per_percent", {{0.1, 0.2}, {0.3, 0.4}}}});
}

using diagnosis::Contradiction;

/// All numbers of a contradiction; which of them count follows from its kind.
Contradiction contradiction(Contradiction::Kind kind) {
  return {.kind = kind,
          .places = {{.pose = "neutral", .direction = 2}},
          .predicted = 3,
          .measured = 4,
          .omega = two_pi * 5.1,
          .difference = two_pi * 0.52,
          .mac = 0.53,
          .missed = 0.54,
          .direction = 1,
          .value = 5.5,
          .deviation = 0.56,
          .unit = "N/m"};
}

diagnosis::Diagnosis diagnosed() {
  using namespace diagnosis;
  Diagnosis d{.finding = Finding::undecided};
  d.causes = {{.kind = Cause::Kind::guide_sleeves}, {.kind = Cause::Kind::oil_springs, .leg = 4}};
  d.scatter = 1.23;
  d.values = 29;
  d.interrupted = true;
  d.equivalent = {1, 0};
  d.targets.modes.resize(1);
  d.modes = {{.pose = "neutral",
              .direction = 3,
              .amplitude = 3.1e-4,
              .omega = two_pi * 6.1,
              .deviation = two_pi * 0.062,
              .common_deviation = two_pi * 0.013,
              .omega_stated = two_pi * 6.3,
              .omega_best = two_pi * 6.4,
              .shape_mac = 0.965,
              .rigid_mac = 0.967,
              .omega_rigid = two_pi * 6.6,
              .resonance = true,
              .oil = 0.68,
              .guide_sleeves = 0.17,
              .piston_rings = 0.11,
              .base = 0.04}};
  observation::ResponseTarget lines;
  lines.s = {{0.0, two_pi * 7.1}, {0.0, two_pi * 7.2}};
  d.targets.responses = {lines};
  for (const double first : {1.0, 2.0}) {
    Hypothesis e{.causes = {first > 1.5 ? std::size_t{0} : std::size_t{1}},
                 .kind = dynamics::ModelKind::guide,
                 .parameters = static_cast<int>(10 * first),
                 .misfit = first + 0.11,
                 .bic = first + 0.12,
                 .by_mechanics = first > 1.5,
                 .from_nominal = first < 1.5};
    e.fit.parameters = {parameter(30.0 * first)};
    e.fit.targets = {
        {.omega = two_pi * (first + 0.13), .difference = first + 0.14, .shape_mac = first + 0.15}};
    e.fit.responses = {{.difference = 3.0 * first}, {.difference = 4.0 * first}};
    d.hypotheses.push_back(e);
  }
  using Kind = Contradiction::Kind;
  for (const auto kind :
       {Kind::resonances, Kind::frequency, Kind::shape, Kind::drives, Kind::forces, Kind::value})
    d.hypotheses[0].wrong.push_back(contradiction(kind));
  d.untested = {{.causes = {1}, .error = "no modes"}};
  d.discriminators = {{.other = 1,
                       .pose = "low",
                       .direction = 5,
                       .omega_best = two_pi * 8.1,
                       .omega_other = two_pi * 8.2,
                       .deviations = 8.3}};
  d.objections = {{.kind = Objection::Kind::frequencies, .count = 9, .ratio = 0.91}};
  return d;
}

Json hypothesis_json(double first, double bic_of_best) {
  const bool second = first > 1.5;
  return {{"causes", Json::array({{{"leg", second ? Json() : Json(5)}}})},
          {"rigid_legs", false},
          {"fitted_parameters", static_cast<int>(10 * first)},
          {"by_mechanics", second},
          {"misfit", first + 0.11},
          {"response_misfit", 25.0 * first * first},
          {"frequency_misfit", std::pow(first + 0.14, 2)},
          {"reduced_misfit", (first + 0.11) / (29.0 - 10.0 * first)},
          // two kinds with degrees of freedom; χ² of one: twice the tail of the normal distribution
          {"probability", 2.0 * std::erfc((first + 0.14) / std::sqrt(2.0))},
          {"bic", first + 0.12},
          {"bic_above_best", first + 0.12 - bic_of_best},
          {"equally_good", true},
          {"parameters", Json::array({parameter_json(30.0 * first, false)})},
          {"targets", Json::array({{{"frequency_hz", first + 0.13},
                                    {"difference", first + 0.14},
                                    {"shape_mac", first + 0.15}}})},
          {"from_nominal", !second}};
}

TEST(NumbersInJson, OfADiagnosis) {
  const auto d = diagnosed();
  const Json json = report::diagnosis_json({.diagnosis = d});
  Json first = hypothesis_json(1.0, d.best().bic), second = hypothesis_json(2.0, d.best().bic);
  const auto hertz = [](Json more) {
    Json all{{"frequency_hz", 5.1}};
    all.update(more);
    return all;
  };
  first["contradiction_codes"] = {
      Json{{"predicted", 3}, {"measured", 4}},
      hertz({{"difference_hz", 0.52}}),
      hertz({{"mac", 0.53}}),
      hertz({{"mac", 0.53}}),
      hertz({{"missed", 0.54}}),
      hertz({{"difference_hz", 0.52}, {"value", 5.5}, {"deviation", 0.56}})};
  expect_numbers(json,
                 {{"untested", Json::array({{{"causes", Json::array({{{"leg", 5}}})}}})},
                  {"nominal_sleeve_N_m", 0.0},
                  {"response_lines", Json::array({{{"frequency_hz", {7.1, 7.2}}, {"values", 0}}})},
                  {"measured_values", 29},
                  {"raw_reduced_misfit", 3.0 * 3.0 + 4.0 * 4.0},
                  {"scatter", 1.23},
                  {"interrupted", true},
                  {"measured_modes", Json::array({{{"frequency_hz", 6.1},
                                                   {"deviation_hz", 0.062},
                                                   {"common_deviation_hz", 0.013},
                                                   {"amplitude_m", 3.1e-4},
                                                   {"nominal_hz", 6.3},
                                                   {"fitted_hz", 6.4},
                                                   {"shape_mac", 0.965},
                                                   {"rigid_hz", 6.6},
                                                   {"rigid_mac", 0.967},
                                                   {"resonance", true},
                                                   {"drop", d.modes[0].drop()},
                                                   {"peak_height", 0.967 * 6.6 * 6.6 / (6.1 * 6.1)},
                                                   {"strain_energy",
                                                    {{"oil", 0.68},
                                                     {"guide_sleeve", 0.17},
                                                     {"piston_ring", 0.11},
                                                     {"base_mount", 0.04}}}}})},
                  {"hypotheses", {first, second}},
                  {"discriminators",
                   Json::array({{{"best_hz", 8.1}, {"other_hz", 8.2}, {"deviations", 8.3}}})},
                  {"objections", Json::array({{{"count", 9}, {"ratio", 0.91}}})}});
  EXPECT_NEAR(d.modes[0].drop(), 1.0 - 6.1 / 6.6, 1e-12);
  EXPECT_EQ(json["measured_modes"][0]["direction"], "rx");
  EXPECT_EQ(json["measured_modes"][0]["resonance"], true);
  EXPECT_FALSE(json["measured_modes"][0]["strain_energy"].contains("axial"));
  auto screws = d;
  screws.modes[0].leg_type = model::LegType::screw;
  EXPECT_EQ(
      report::diagnosis_json({.diagnosis = screws})["measured_modes"][0]["strain_energy"]["axial"],
      "screws");
  EXPECT_EQ(json["discriminators"][0]["direction"], "rz");
}

TEST(Summary, KnowsResonancesThatComeFromThePayload) {
  auto d = diagnosed();
  auto& mode = d.modes[0];
  mode.oil = mode.guide_sleeves = 0.2;
  mode.piston_rings = mode.base = 0.0;
  mode.payload = 0.6;
  const auto words = report::summary({.diagnosis = d});
  EXPECT_EQ(std::ranges::count(words,
                               "From the modes of the payload comes the resonance in rx at "
                               "6.10 Hz."),
            1);
}

TEST(NumbersInJson, OfAttributionAndRemedy) {
  using namespace diagnosis;
  CaseFile file{
      .fitted = true, .nominal_sleeves = {.stiffest = 7.3, .softest = 7.2}, .pose = "neutral"};
  AttributedDrop drop;
  drop.resonance = {
      .direction = "ry", .omega_rigid = two_pi * 2.2, .omega = two_pi * 1.9, .mac = 0.87};
  drop.parts = {
      {.part = {.what = Compliance::guide_sleeve, .leg = 3}, .omega = two_pi * 2.1, .share = 0.67}};
  file.drops = {drop};
  file.goal = {.omega = two_pi * 3.3, .direction = 4};
  Remedy remedy{.status = RemedyStatus::found};
  const auto point = [](double first) {
    return RemedyPoint{.factor = first + 0.1,
                       .stiffness = first + 0.2,
                       .omega = two_pi * (first + 0.3),
                       .drop = first + 0.4,
                       .mac = first + 0.45,
                       .softest = first + 0.15};
  };
  const auto point_json = [](double first) {
    return Json{{"factor", first + 0.1},       {"stiffness_N_m", first + 0.2},
                {"frequency_hz", first + 0.3}, {"drop", first + 0.4},
                {"mac", first + 0.45},         {"softest_N_m", first + 0.15}};
  };
  remedy.today = point(1.0);
  remedy.needed = point(2.0);
  remedy.limit = point(3.0);
  remedy.curve = {point(4.0), point(5.0)};
  remedy.changes = {{.pose = "low",
                     .direction = "x",
                     .omega_rigid = two_pi * 6.1,
                     .omega_today = two_pi * 6.2,
                     .omega_needed = two_pi * 6.3,
                     .mac_today = 0.61,
                     .mac_needed = 0.62}};
  file.remedy = remedy;
  expect_numbers(
      report::diagnosis_json(file),
      {{"nominal_sleeve_N_m", 7.3},
       {"softest_nominal_sleeve_N_m", 7.2},
       {"attribution",
        Json::array(
            {{{"rigid_hz", 2.2},
              {"frequency_hz", 1.9},
              {"drop", 1.0 - 1.9 / 2.2},
              {"mac", 0.87},
              {"peak_height", 0.87 * 2.2 * 2.2 / (1.9 * 1.9)},
              {"parts", Json::array({{{"leg", 4}, {"frequency_hz", 2.1}, {"share", 0.67}}})}}})},
       {"remedy",
        {{"goal", {{"frequency_hz", 3.3}}},
         {"present", point_json(1.0)},
         {"required", point_json(2.0)},
         {"rigid_sleeves", point_json(3.0)},
         {"curve", {point_json(4.0), point_json(5.0)}},
         {"changes", Json::array({{{"rigid_hz", 6.1},
                                   {"present_hz", 6.2},
                                   {"required_hz", 6.3},
                                   {"present_mac", 0.61},
                                   {"required_mac", 0.62}}})}}}});
}

}  // namespace
}  // namespace hydrapod::test
