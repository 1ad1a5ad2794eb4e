#include "hydrapod/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "candidate.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "variables.hpp"

namespace hydrapod::calibration {

namespace {

/// Every combination of choices, the first of each first.
std::vector<std::vector<std::size_t>> combinations(const std::vector<Alternative>& alternatives) {
  std::vector<std::vector<std::size_t>> all{{}};
  for (const auto& alternative : alternatives) {
    std::vector<std::vector<std::size_t>> longer;
    for (const auto& chosen : all)
      for (std::size_t k = 0; k < alternative.choices.size(); ++k) {
        longer.push_back(chosen);
        longer.back().push_back(k);
      }
    all = std::move(longer);
  }
  return all;
}

std::string name_of(const std::vector<Alternative>& alternatives,
                    const std::vector<std::size_t>& choice) {
  std::string name;
  for (std::size_t k = 0; k < choice.size(); ++k)
    name += fmt::format("{}{} {}", k == 0 ? "" : ", ", alternatives[k].name,
                        alternatives[k].choices[choice[k]].name);
  return name.empty() ? "the machine as in the file" : name;
}

std::vector<std::string> overrides_of(const std::vector<Alternative>& alternatives,
                                      const std::vector<std::size_t>& choice) {
  std::vector<std::string> overrides;
  for (std::size_t k = 0; k < choice.size(); ++k) {
    const auto& set = alternatives[k].choices[choice[k]].overrides;
    overrides.insert(overrides.end(), set.begin(), set.end());
  }
  return overrides;
}

Combination make_combination(const model::MachineFile& file, const Targets& targets,
                             const Plan& plan, dynamics::ModelKind kind,
                             const std::vector<std::size_t>& choice) {
  Combination made;
  made.candidate.choice = choice;
  made.candidate.name = name_of(plan.alternatives, choice);
  made.candidate.overrides = overrides_of(plan.alternatives, choice);
  const auto with_choices = file_with_choices(file, made.candidate);
  std::vector<base::Diagnostic> errors;
  auto variables = make_variables(plan.free, with_choices, targets, errors);
  if (!plan.alternatives.empty())
    for (auto& error : errors)
      error.message += fmt::format("; tried with \"{}\"", made.candidate.name);
  if (!errors.empty()) throw base::InputError(errors);
  made.problem = std::make_unique<Problem>(with_choices.machine, targets, std::move(variables),
                                           kind, ProblemOptions{});
  made.solutions.resize(static_cast<std::size_t>(plan.options.starts));
  return made;
}

void check_plan(const Targets& targets, const Plan& plan) {
  std::vector<base::Diagnostic> errors;
  if (plan.free.empty())
    errors.push_back(
        {.message =
             "no parameter is free; use --free PATH or tables [[free]] in the targets file"});
  if (targets.modes.empty()) errors.push_back({.message = "there are no targets"});
  constexpr std::size_t most = 1000;
  std::size_t count = 1;
  for (const auto& alternative : plan.alternatives) count *= alternative.choices.size();
  if (count == 0 || count > most)
    errors.push_back({.message = fmt::format(
                          "the alternatives make {} combinations, expected 1 to {}", count, most)});
  if (!errors.empty()) throw base::InputError(errors);
}

bool better(const Candidate& a, const Candidate& b) {
  if (a.fitted != b.fitted) return a.fitted;
  if (a.admissible() != b.admissible()) return a.admissible();
  if (fits_poorly(a) != fits_poorly(b)) return fits_poorly(b);
  // a target that was dropped as wrong counts as one that is off by ten deviations
  constexpr double dropped = 100.0;
  const auto cost = [](const Candidate& c) {
    return c.misfit + dropped * static_cast<double>(
                                    std::count_if(c.targets.begin(), c.targets.end(),
                                                  [](const FittedTarget& t) { return t.outlier; }));
  };
  return cost(a) < cost(b);
}

void rank(std::vector<Combination>& all) {
  std::stable_sort(all.begin(), all.end(), [](const Combination& a, const Combination& b) {
    return better(a.candidate, b.candidate);
  });
}

/// Brings the solutions of least cost that differ to the front, at most `count`, and gives up the
/// others.
void keep_best(std::vector<Solution>& solutions, std::size_t count) {
  constexpr double same_place = 0.01;  // of the variables, most of which are logarithms
  std::ranges::stable_sort(solutions, [](const Solution& a, const Solution& b) {
    return a.usable != b.usable ? a.usable : a.usable && a.cost < b.cost;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < solutions.size() && solutions[i].usable; ++i) {
    const auto& x = solutions[i].x;
    const bool known =
        std::any_of(solutions.begin(), solutions.begin() + static_cast<std::ptrdiff_t>(kept),
                    [&](const Solution& other) {
                      return (other.x - x).lpNorm<Eigen::Infinity>() < same_place;
                    });
    if (known || kept == count)
      solutions[i].usable = false;
    else
      std::swap(solutions[kept++], solutions[i]);
  }
}

/// Solutions from all starts; with fewer `kept` than starts the best ones of a trial go on.
void solve_from_starts(const FitOptions& options, const std::function<bool()>& stop,
                       const Progress& show, std::vector<Combination>& all) {
  const SolverOptions to_the_end{
      .max_iterations = options.max_iterations, .tolerance = options.tolerance, .stop = stop};
  const auto starts = static_cast<std::size_t>(options.starts);
  const bool trial = options.kept > 0 && options.kept < options.starts;
  auto first = to_the_end;
  if (trial) first.max_iterations = options.trial_iterations;
  numerics::parallel_for(
      all.size() * starts, options.threads,
      [&](std::size_t i) {
        auto& combination = all[i / starts];
        const auto number = static_cast<int>(i % starts);
        combination.solutions[i % starts] = solve(
            *combination.problem, start_of(*combination.problem, options.seed, number), first);
      },
      numerics::part_of(show, 0.0, trial ? 0.4 : 0.7));
  if (!trial) return;
  const auto kept = static_cast<std::size_t>(options.kept);
  for (auto& combination : all) keep_best(combination.solutions, kept);
  numerics::parallel_for(
      all.size() * kept, options.threads,
      [&](std::size_t i) {
        auto& combination = all[i / kept];
        auto& solution = combination.solutions[i % kept];
        if (solution.usable && !solution.converged)
          solution = solve(*combination.problem, solution.x, to_the_end);
      },
      numerics::part_of(show, 0.4, 0.7));
}

}  // namespace

Calibration calibrate(const model::MachineFile& file, const Targets& targets, const Plan& plan,
                      dynamics::ModelKind kind, const Progress& progress) {
  check_plan(targets, plan);
  std::vector<Combination> all;
  for (const auto& choice : combinations(plan.alternatives))
    all.push_back(make_combination(file, targets, plan, kind, choice));

  numerics::Watch watch(progress);
  const Progress show = [&](double share) { return watch.at(share); };
  const std::function<bool()> stop = [&] { return watch.stopped(); };
  solve_from_starts(plan.options, stop, show, all);
  for (auto& combination : all) conclude(combination);
  rank(all);
  const bool try_robust = plan.options.loss == Loss::cauchy ||
                          (plan.options.loss == Loss::automatic &&
                           (fits_poorly(all.front().candidate) || !all.front().candidate.fitted));
  if (try_robust && !watch.stopped()) {
    numerics::parallel_for(
        all.size(), plan.options.threads,
        [&](std::size_t i) {
          conclude_robust(all[i], plan.options, plan.options.loss == Loss::cauchy, stop);
        },
        numerics::part_of(show, 0.7, 0.8));
    rank(all);
  }
  constexpr double far_worse = 4.0;
  numerics::parallel_for(
      all.size() - 1, plan.options.threads,
      [&](std::size_t i) {
        auto& combination = all[i + 1];
        const double limit = far_worse * std::max(all.front().candidate.misfit,
                                                  static_cast<double>(targets.modes.size()));
        if (combination.candidate.fitted && combination.candidate.misfit > limit)
          conclude_unbound(combination, plan.options, stop);
      },
      numerics::part_of(show, 0.8, 1.0));

  Calibration result{.alternatives = plan.alternatives, .interrupted = watch.stopped()};
  for (auto& combination : all) result.candidates.push_back(std::move(combination.candidate));
  if (!result.best().fitted) throw base::ComputationError(result.best().problem);
  return result;
}

Candidate compare(const model::MachineFile& file, const Targets& targets,
                  dynamics::ModelKind kind) {
  Combination made = make_combination(file, targets, {.options = {.starts = 1}}, kind, {});
  State state;
  const bool sound = made.problem->evaluate(Eigen::VectorXd(0), false, state);
  made.solutions[0] = {.usable = sound, .converged = true};
  conclude(made);
  return made.candidate;
}

namespace {

/// Where a profile is looked at: twice the parameter's interval, or all there is.
struct Range {
  double low{}, high{};
  bool logarithmic{};
  [[nodiscard]] double at(double share) const {
    return logarithmic ? low * std::pow(high / low, share) : low + (high - low) * share;
  }
};

Range profile_range(const FittedParameter& p) {
  Range range{p.lower, p.upper, p.lower > 0.0};
  if (!std::isfinite(p.interval_high) || !std::isfinite(p.interval_low)) return range;
  const double width = 2.0 * (p.interval_high - p.value);
  const double reach = std::pow(p.interval_high / p.value, 2);
  const double low = range.logarithmic ? p.value / reach : p.value - width;
  const double high = range.logarithmic ? p.value * reach : p.value + width;
  range.low = std::clamp(low, p.lower, p.upper);
  range.high = std::clamp(high, p.lower, p.upper);
  return range;
}

/// Value at which the misfit passes `limit` between two points; where one has no misfit, there.
double crossing(const ProfilePoint& a, const ProfilePoint& b, double limit) {
  if (!std::isfinite(a.misfit)) return a.value;
  if (!std::isfinite(b.misfit)) return b.value;
  return a.value + (b.value - a.value) * (limit - a.misfit) / (b.misfit - a.misfit);
}

void find_interval(Profile& profile, double scatter) {
  const double enough = numerics::chi_squared_quantile(0.95, 1);
  double least = infinite;
  for (const auto& point : profile.points) least = std::min(least, point.misfit);
  const double limit = least + enough * scatter * scatter;
  profile.interval_low = -infinite;
  profile.interval_high = infinite;
  for (std::size_t k = 1; k < profile.points.size(); ++k) {
    const auto& a = profile.points[k - 1];
    const auto& b = profile.points[k];
    if (a.misfit > limit && b.misfit <= limit && std::isinf(profile.interval_low))
      profile.interval_low = crossing(a, b, limit);
    if (a.misfit <= limit && b.misfit > limit) profile.interval_high = crossing(a, b, limit);
  }
}

}  // namespace

Profile profile(const model::MachineFile& file, const Targets& targets, const Plan& plan,
                dynamics::ModelKind kind, const Candidate& candidate, int index,
                const Progress& progress) {
  constexpr int points = 21;
  const auto& parameter = candidate.parameters.at(static_cast<std::size_t>(index));
  const auto range = profile_range(parameter);
  const auto with_choices = file_with_choices(file, candidate);
  std::vector<base::Diagnostic> errors;
  auto variables = make_variables(plan.free, with_choices, targets, errors);
  if (!errors.empty()) throw base::InputError(errors);
  for (std::size_t j = 0; j < variables.size(); ++j) {
    const auto& p = candidate.parameters[j];
    // at a bound, rounding may have put the value outside
    set_range(variables[j], std::clamp(p.value, p.lower, p.upper), p.lower, p.upper);
  }
  const auto held = variables.begin() + index;
  const auto ids = held->ids;
  const auto prior = held->prior;
  variables.erase(held);
  std::vector<std::optional<ProfilePoint>> found(points);
  numerics::Watch watch(progress);
  const Progress show = [&](double share) { return watch.at(share); };
  const std::function<bool()> stop = [&] { return watch.stopped(); };
  numerics::parallel_for(
      points, plan.options.threads,
      [&](std::size_t k) {
        ProfilePoint point{.value = range.at(static_cast<double>(k) / (points - 1))};
        auto machine = with_choices.machine;
        for (const auto& id : ids) assign(machine, std::array{model::Assignment{id, point.value}});
        const Problem problem(machine, targets, variables, kind, {});
        const auto solution = solve(problem, problem.start(),
                                    {.max_iterations = plan.options.max_iterations,
                                     .cauchy = candidate.robust,
                                     .stop = stop});
        // all others fitted, without the parameter's own prior
        point.misfit = solution.usable ? 2.0 * solution.cost : infinite;
        if (prior) point.misfit += std::pow((point.value - prior->value) / prior->spread, 2);
        if (!watch.stopped()) found[k] = point;
      },
      show);
  Profile result{.parameter = index};
  for (const auto& point : found)
    if (point) result.points.push_back(*point);
  find_interval(result, candidate.scatter);
  return result;
}

}  // namespace hydrapod::calibration
