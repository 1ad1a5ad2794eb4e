/// The worst between the rows of a grid: a compass search from the worst row.

#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

constexpr double least_step = 1e-3;  ///< of the distance between rows
constexpr int most_rounds = 200;

/// The larger distance of a value to its neighbours in a list.
double spacing(const std::vector<double>& list, double value) {
  constexpr double none = std::numeric_limits<double>::infinity();
  double below = none, above = none;
  for (const double other : list) {
    if (other < value) below = std::min(below, value - other);
    if (other > value) above = std::min(above, other - value);
  }
  return std::max(below < none ? below : 0.0, above < none ? above : 0.0);
}

/// Rows at ± a step along each input, those within the grid.
std::vector<std::vector<double>> around(const Problem& problem, const std::vector<double>& center,
                                        const std::vector<double>& steps) {
  std::vector<std::vector<double>> places;
  for (std::size_t k = 0; k < center.size(); ++k)
    for (const double sign : {-1.0, 1.0}) {
      const auto& list = problem.inputs[k].distribution.list;
      const auto [low, high] = std::ranges::minmax(list);
      const double value = std::clamp(center[k] + sign * steps[k], low, high);
      if (value == center[k]) continue;
      places.push_back(center);
      places.back()[k] = value;
    }
  return places;
}

}  // namespace

std::optional<WorstBetween> worst_between(const Problem& problem, std::span<const double> inputs,
                                          double value, int column) {
  const auto c = static_cast<std::size_t>(column);
  const double sign = problem.outputs[c].worse == Worse::more ? -1.0 : 1.0;  // less is worse
  const std::size_t width = problem.outputs.size();
  const auto batch = problem.batch();
  std::vector<double> outputs;
  const auto worst_of = [&](const std::vector<std::vector<double>>& places) {
    outputs.assign(places.size() * width, 0.0);
    std::vector<Row> rows;
    for (std::size_t k = 0; k < places.size(); ++k)
      rows.push_back({places[k], std::span(outputs).subspan(k * width, width)});
    batch(rows);
    std::optional<WorstBetween> worst;
    for (const auto& row : rows) {
      const double there = row.outputs[c];
      if (!std::isnan(there) && (!worst || sign * there < sign * worst->value))
        worst = WorstBetween{there, {row.inputs.begin(), row.inputs.end()}};
    }
    return worst;
  };
  WorstBetween found{value, {inputs.begin(), inputs.end()}};
  std::vector<double> steps;
  for (std::size_t k = 0; k < inputs.size(); ++k)
    steps.push_back(spacing(problem.inputs[k].distribution.list, inputs[k]) / 2.0);
  double step = 0.5;
  for (int round = 0; round < most_rounds && step >= least_step; ++round) {
    auto next = worst_of(around(problem, found.inputs, steps));
    if (next && sign * next->value < sign * found.value) {
      found = std::move(*next);
      continue;
    }
    step /= 2.0;
    for (double& one : steps) one /= 2.0;
  }
  constexpr double rounding = 1e-9;
  if (sign * (value - found.value) <= rounding * std::abs(value)) return std::nullopt;
  return found;
}

}  // namespace hydrapod::study
