#include "hydrapod/report/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fields.hpp"
#include "hydrapod/base/constants.hpp"

namespace hydrapod::report {

namespace {

using namespace calibration;
using observation::ModeTarget;
using observation::Targets;

using base::two_pi;

/// Infinite and undefined numbers do not exist in JSON.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json parameter_json(const FittedParameter& p) {
  return {{"paths", p.paths},
          {"unit", p.unit},
          {"start", p.start},
          {"bounds", {p.lower, p.upper}},
          {"value", p.value},
          {"deviation", number(p.deviation)},
          {"interval_95", {number(p.interval_low), number(p.interval_high)}},
          {"deviation_data_alone", number(p.data_deviation)},
          {"other_value", p.other_value ? Json(*p.other_value) : Json(nullptr)},
          {"verdict", verdict_word(p.verdict)}};
}

Json target_json(const ModeTarget& target, const FittedTarget& fit) {
  Json json{{"name", target.name},
            {"pose", target.pose},
            {"mode", fit.mode + 1},
            {"target_rad_s", target.omega},
            {"model_rad_s", fit.omega},
            {"deviation_rad_s", target.deviation},
            {"difference_in_deviations", fit.difference},
            {"outlier", fit.outlier}};
  if (target.damping) {
    json["target_damping_ratio"] = *target.damping;
    json["model_damping_ratio"] = fit.damping;
  }
  if (target.shape) json["shape_mac"] = fit.shape_mac;
  return json;
}

Json matrix_json(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(number(matrix(i, j)));
    rows.push_back(row);
  }
  return rows;
}

Json identifiability_json(const Identifiability& found) {
  Json trades = Json::array();
  for (const auto& trade : found.trades)
    trades.push_back({{"parameters", trade.parameters},
                      {"relative_direction",
                       std::vector<double>(trade.direction.begin(), trade.direction.end())},
                      {"relative_deviation", number(trade.deviation)},
                      {"words", trade.words}});
  return {{"singular_values",
           std::vector<double>(found.singular_values.begin(), found.singular_values.end())},
          {"directions", matrix_json(found.directions)},
          {"rank", found.rank},
          {"numerical_rank", found.numerical_rank},
          {"correlations", matrix_json(found.correlations)},
          {"trades", trades}};
}

Json candidate_json(const Candidate& candidate, const Targets& targets) {
  Json json{{"name", candidate.name},
            {"overrides", candidate.overrides},
            {"fitted", candidate.fitted},
            {"admissible", candidate.admissible()}};
  if (!candidate.fitted) {
    json["problem"] = candidate.problem;
    return json;
  }
  json["violated"] = candidate.violated;
  json["converged"] = candidate.converged;
  json["starts"] = candidate.starts;
  json["starts_that_agree"] = candidate.starts_that_agree;
  json["loss"] = candidate.robust ? "cauchy" : "squares";
  json["misfit"] = candidate.misfit;
  json["worst_rad_s"] = candidate.worst;
  json["scatter"] = candidate.scatter;
  json["parameters"] = Json::array();
  for (const auto& p : candidate.parameters) json["parameters"].push_back(parameter_json(p));
  json["targets"] = Json::array();
  for (std::size_t i = 0; i < candidate.targets.size(); ++i)
    json["targets"].push_back(target_json(targets.modes[i], candidate.targets[i]));
  json["identifiability"] = identifiability_json(candidate.identifiability);
  if (candidate.unbound)
    json["unbound"] = {{"misfit", candidate.unbound->misfit},
                       {"worst_rad_s", candidate.unbound->worst},
                       {"violated", candidate.unbound->violated},
                       {"values", candidate.unbound->values}};
  return json;
}

}  // namespace

const char* verdict_word(Verdict verdict) {
  switch (verdict) {
    case Verdict::determined:
      return "determined";
    case Verdict::ambiguous:
      return "one of several";
    case Verdict::at_bound:
      return "at its bound";
    case Verdict::by_prior:
      return "by the prior";
    case Verdict::undetermined:
      break;
  }
  return "not determined";
}

Json calibration_json(const Calibration& result, const Targets& targets) {
  Json json{{"targets_title", targets.title},
            {"targets_source", targets.source},
            {"interrupted", result.interrupted},
            {"remarks", calibration_remarks(result, targets)},
            {"candidates", Json::array()}};
  for (const auto& candidate : result.candidates)
    json["candidates"].push_back(candidate_json(candidate, targets));
  return json;
}

Json profile_json(const Profile& profile, const Candidate& candidate) {
  Json json{{"paths", candidate.parameters.at(static_cast<std::size_t>(profile.parameter)).paths},
            {"interval_95", {number(profile.interval_low), number(profile.interval_high)}},
            {"values", Json::array()},
            {"misfits", Json::array()}};
  for (const auto& point : profile.points) {
    json["values"].push_back(point.value);
    json["misfits"].push_back(number(point.misfit));
  }
  return json;
}

template <class Fields>
void describe(Fields& f, model::FileNumber& number) {
  f("path", number.path);
  f("unit", number.unit);
  f("value", number.value);
}

template <class Fields>
void describe(Fields& f, Sensitivities& s) {
  if constexpr (Fields::reads) s.omega.resize(static_cast<Eigen::Index>(f.size("modes")));
  f.list("modes", static_cast<std::size_t>(s.omega.size()), [&](auto& mode, std::size_t k) {
    double& omega = s.omega[static_cast<Eigen::Index>(k)];
    mode("omega_rad_s", omega);
    mode.derived("frequency_hz", omega / two_pi);
  });
  f("parameters", s.parameters);
  f("percent_per_percent", s.percent_per_percent);
}

Json sensitivity_json(const Sensitivities& sensitivities) { return written(sensitivities); }

Sensitivities sensitivity_from_json(const Json& json, const std::string& file) {
  Sensitivities sensitivities;
  read(json, file, sensitivities);
  return sensitivities;
}

std::vector<std::string> calibration_remarks(const Calibration& result, const Targets& targets) {
  std::vector<std::string> remarks;
  const auto& best = result.best();
  if (result.interrupted)
    remarks.push_back("interrupted: these are the best values so far, not the best there are");
  for (std::size_t i = 0; i < best.targets.size(); ++i)
    if (best.targets[i].outlier)
      remarks.push_back(fmt::format(
          "target {} does not fit the others: it is {:.1f} deviations off and was left out; is it "
          "wrong?",
          targets.modes[i].name, std::abs(best.targets[i].difference)));
  const double count = static_cast<double>(best.targets.size());
  if (best.misfit > 9.0 * count)
    remarks.push_back(fmt::format(
        "the targets cannot be met: the worst is off by {:.3g} rad/s; the model lacks something, a "
        "bound is too tight, or a target is wrong",
        best.worst));
  if (!best.converged && !result.interrupted)
    remarks.push_back(
        "the last step still found a little; more steps (`max_iterations` in [fit]) may help");
  if (best.targets.size() < best.parameters.size())
    remarks.push_back(fmt::format("{} parameters are free, but there are only {} targets",
                                  best.parameters.size(), best.targets.size()));
  for (const auto& p : best.parameters) {
    if (p.verdict == Verdict::by_prior)
      remarks.push_back(fmt::format("{}: its prior decides, not the data", p.paths.front()));
    if (p.verdict == Verdict::ambiguous)
      remarks.push_back(fmt::format(
          "{}: {:.5g} {} meets the targets as well; bounds or a prior can say which it is",
          p.paths.front(), *p.other_value, p.unit == "1" ? "" : p.unit));
    if (p.verdict == Verdict::at_bound)
      remarks.push_back(fmt::format("{} ended at its bound, {:.5g} {}; is the bound right?",
                                    p.paths.front(), p.value, p.unit == "1" ? "" : p.unit));
  }
  for (const auto& broken : best.violated)
    remarks.push_back("no such machine can be built; this does not hold: " + broken);
  if (!targets.deviations_given)
    remarks.push_back(
        fmt::format("the targets do not say how exact they are; {:g} % was assumed, and the "
                    "uncertainties follow "
                    "from how well they are met",
                    100.0 * observation::default_deviation));
  return remarks;
}

}  // namespace hydrapod::report
