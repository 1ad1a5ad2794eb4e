#include <algorithm>
#include <cmath>
#include <limits>

#include "design_search.hpp"

namespace hydrapod::study {

namespace {

/// Both bounds positive and a decade apart: steps of equal ratio.
bool in_ratios(const Input& change) {
  constexpr double decade = 10.0;
  const auto& d = change.distribution;
  return d.a > 0.0 && d.b >= decade * d.a;
}

}  // namespace

bool better(const Trial& one, const Trial& other) {
  if (one.violation != other.violation) return one.violation < other.violation;
  return one.cost < other.cost;
}

std::vector<double> values_at(const std::vector<Input>& changes, std::span<const double> t) {
  std::vector<double> values;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const auto& d = changes[k].distribution;
    const double value =
        in_ratios(changes[k]) ? d.a * std::pow(d.b / d.a, t[k]) : d.a + t[k] * (d.b - d.a);
    values.push_back(t[k] <= 0.0 ? d.a : t[k] >= 1.0 ? d.b : std::clamp(value, d.a, d.b));
  }
  return values;
}

std::vector<double> place_of(const std::vector<Input>& changes, std::span<const double> values) {
  std::vector<double> t;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const auto& d = changes[k].distribution;
    const double value = std::clamp(values[k], d.a, d.b);
    t.push_back(in_ratios(changes[k]) ? std::log(value / d.a) / std::log(d.b / d.a)
                                      : (value - d.a) / (d.b - d.a));
  }
  return t;
}

double slope_at(const Input& change, double value) {
  const auto& d = change.distribution;
  return in_ratios(change) ? value * std::log(d.b / d.a) : d.b - d.a;
}

double value_of(const Term& term, const Trial& trial, std::size_t pose) {
  if (term.change >= 0) return trial.values[static_cast<std::size_t>(term.change)];
  return trial.outputs[pose][static_cast<std::size_t>(term.output)];
}

double margin_of(const Term& term, const Trial& trial, std::size_t pose) {
  const double above = value_of(term, trial, pose) - term.bound;
  return (term.at_least ? above : -above) / term.scale;
}

void judge(const Goal& goal, int status, Trial& trial) {
  trial.violation = 0.0;
  int without = 0;
  for (const auto& outputs : trial.outputs)
    without += outputs[static_cast<std::size_t>(status)] == 0.0 ? 0 : 1;
  double worst = 0.0;
  trial.cost = -std::numeric_limits<double>::infinity();
  for (std::size_t pose = 0; pose < trial.outputs.size(); ++pose) {
    if (trial.outputs[pose][static_cast<std::size_t>(status)] != 0.0) continue;
    for (const auto& term : goal.constraints) {
      const double margin = margin_of(term, trial, pose);
      if (!std::isfinite(margin)) {
        ++without;
        break;
      }
      worst = std::max(worst, reserve - margin);
    }
    if (!goal.objective) continue;
    const double value = value_of(*goal.objective, trial, pose);
    if (!std::isfinite(value)) {
      ++without;
      continue;
    }
    trial.cost = std::max(trial.cost, goal.objective->at_least ? -value : value);
  }
  if (!goal.objective) trial.cost = 0.0;
  if (worst > 0.0) trial.violation = std::min(worst, 0.5 * no_outputs);
  if (without > 0) trial.violation = no_outputs * without;
}

Bench::Bench(const DesignProblem& problem, const std::vector<int>& wanted)
    : problem_(problem), wanted_(wanted) {
  status_ = static_cast<int>(std::ranges::find(problem.outputs, "status", &Column::name) -
                             problem.outputs.begin());
  for (const auto& pose : problem.poses) models_.emplace_back(problem, pose, wanted);
}

Trial Bench::at(const Goal& goal, std::vector<double> t) {
  ++evaluations_;
  Trial trial{.t = std::move(t)};
  trial.values = values_at(problem_.changes, trial.t);
  for (auto& model : models_) {
    trial.outputs.emplace_back(problem_.outputs.size());
    model.outputs(trial.values, trial.outputs.back());
  }
  judge(goal, status_, trial);
  return trial;
}

std::vector<DesignModel::Derivatives> Bench::derivatives(const Trial& trial) {
  std::vector<DesignModel::Derivatives> all;
  for (std::size_t pose = 0; pose < models_.size(); ++pose)
    all.push_back(models_[pose].derivatives(trial.values, trial.outputs[pose]));
  return all;
}

Eigen::RowVectorXd Bench::gradient(const Term& term, const Trial& trial,
                                   const std::vector<DesignModel::Derivatives>& derivatives,
                                   std::size_t pose) const {
  const auto size = static_cast<Eigen::Index>(problem_.changes.size());
  Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(size);
  if (term.change >= 0) {
    slope[term.change] = 1.0;
  } else {
    const auto row = std::ranges::find(wanted_, term.output) - wanted_.begin();
    slope = derivatives[pose].by_change.row(row);
  }
  for (Eigen::Index k = 0; k < size; ++k) {
    const auto at = static_cast<std::size_t>(k);
    slope[k] *= slope_at(problem_.changes[at], trial.values[at]);
  }
  return slope;
}

}  // namespace hydrapod::study
