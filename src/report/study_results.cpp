#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

namespace hydrapod::report {

namespace {

Json interval_json(const std::optional<study::Interval>& interval) {
  if (!interval) return nullptr;
  return Json::array({interval->low, interval->high});
}

Json output_json(const study::Column& column, const study::OutputSummary& output) {
  Json json{{"name", column.name},
            {"unit", column.unit},
            {"meaning", column.meaning},
            {"count", output.count}};
  if (output.count == 0) return json;
  json["mean"] = output.mean;
  json["mean_interval"] = interval_json(output.mean_interval);
  json["standard_deviation"] = output.deviation;
  json["least"] = output.least;
  json["least_row"] = output.least_row;
  json["most"] = output.most;
  json["most_row"] = output.most_row;
  json["quantiles"] = Json::array();
  for (const auto& quantile : output.quantiles)
    json["quantiles"].push_back({{"probability", quantile.probability},
                                 {"value", quantile.value},
                                 {"interval", interval_json(quantile.interval)}});
  if (output.between)
    json["worst_between"] = {{"value", output.between->value}, {"inputs", output.between->inputs}};
  return json;
}

Json requirement_json(const study::Requirement& wanted, const study::RequirementSummary& result) {
  return {{"requirement", wanted.text},
          {"samples", result.count},
          {"missed", result.missed},
          {"probability_of_missing", result.probability},
          {"interval", interval_json(result.interval)},
          {"worst_row", result.worst ? Json(*result.worst) : Json(nullptr)}};
}

Json index_json(const study::Index& index) {
  return {{"value", index.value}, {"interval", {index.interval.low, index.interval.high}}};
}

}  // namespace

Json study_json(const study::Problem& problem, const study::Plan& plan,
                const std::vector<study::Requirement>& requirements,
                const study::Summary& summary) {
  const auto planned = rows_of(plan, problem.inputs.size());
  Json json{{"rows", summary.rows},
            {"rows_planned", planned},
            {"complete", summary.rows == planned},
            {"samples", plan.samples},
            {"seed", plan.seed}};
  json["inputs"] = Json::array();
  for (const auto& input : problem.inputs)
    json["inputs"].push_back({{"path", input.name}, {"unit", input.unit}});
  if (problem.beneath)
    for (std::size_t k = problem.inputs.size(); k < problem.beneath->inputs.size(); ++k) {
      const auto& input = problem.beneath->inputs[k];
      json["worst_over"].push_back(
          {{"path", input.name}, {"unit", input.unit}, {"values", input.distribution.list}});
    }
  constexpr std::array names{"computed", "not_allowed", "out_of_reach", "no_equilibrium",
                             "buckled"};
  for (std::size_t k = 0; k < names.size(); ++k)
    json["statuses"][names[k]] = k < summary.statuses.size() ? summary.statuses[k] : 0;
  json["outputs"] = Json::array();
  for (std::size_t k = 0; k < summary.outputs.size(); ++k)
    if (static_cast<int>(k) != problem.status)
      json["outputs"].push_back(output_json(problem.outputs[k], summary.outputs[k]));
  json["requirements"] = Json::array();
  for (std::size_t k = 0; k < requirements.size(); ++k)
    json["requirements"].push_back(requirement_json(requirements[k], summary.requirements[k]));
  if (summary.reached)
    json["reached"] = {{"least", summary.reached->least},
                       {"most", summary.reached->most},
                       {"whole", summary.reached->whole},
                       {"unit", summary.reached->unit}};
  for (std::size_t k = 0; k < summary.indices.size(); ++k) {
    const auto& indices = summary.indices[k];
    if (indices.first.empty() || static_cast<int>(k) == problem.status) continue;
    Json of_output{{"output", problem.outputs[k].name}, {"samples_used", indices.used}};
    for (std::size_t i = 0; i < indices.first.size(); ++i)
      of_output["inputs"].push_back({{"path", problem.inputs[i].name},
                                     {"first_order", index_json(indices.first[i])},
                                     {"total_order", index_json(indices.total[i])}});
    json["indices"].push_back(of_output);
  }
  return json;
}

}  // namespace hydrapod::report
