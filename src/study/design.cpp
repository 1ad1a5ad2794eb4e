#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "design_limits.hpp"
#include "design_search.hpp"
#include "hydrapod/base/error.hpp"

namespace hydrapod::study {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

Term term_of(const Requirement& wanted) {
  const double size = std::abs(wanted.bound);
  return {.output = wanted.output,
          .at_least = wanted.at_least,
          .bound = wanted.bound,
          .scale = size > 0.0 ? size : 1.0};
}

Term term_of(const Aim& aim) {
  return {.output = aim.output, .change = aim.change, .at_least = aim.maximise};
}

/// Everything a search has seen, in the order in which it was asked for.
struct Archive {
  std::vector<std::vector<double>> t{};
  std::vector<std::vector<double>> values{};
  /// Per design and pose, the wanted columns and the status in full rows.
  std::vector<std::vector<std::vector<double>>> outputs{};

  [[nodiscard]] Trial trial(std::size_t k, const Goal& goal, int status) const {
    Trial one{.t = t[k], .values = values[k], .outputs = outputs[k]};
    judge(goal, status, one);
    return one;
  }
};

class Designer {
 public:
  Designer(const DesignProblem& problem, const DesignOptions& options,
           const numerics::Progress& progress)
      : problem_(problem), options_(options), watch_(progress) {
    if (problem.changes.empty() || problem.poses.empty() || problem.aims.size() > 2)
      throw std::invalid_argument("design: expected changes, poses and at most two aims");
    status_ = static_cast<int>(std::ranges::find(problem.outputs, "status", &Column::name) -
                               problem.outputs.begin());
    for (const auto& wanted : problem.requirements) want(wanted.output);
    for (const auto& aim : problem.aims)
      if (aim.output >= 0) want(aim.output);
    for (const auto& wanted : problem.requirements) requirements_.push_back(term_of(wanted));
    for (const auto& aim : problem.aims) aims_.push_back(term_of(aim));
  }

  DesignResult run() {
    DesignResult result;
    take_samples();
    result.samples = archive_.t.size();
    scale_aims();
    const Goal all{.objective = aims_.empty() ? std::nullopt : std::optional(aims_.front()),
                   .constraints = requirements_};
    for (std::size_t k = 0; k < archive_.t.size(); ++k) {
      result.feasible_samples += archive_.trial(k, all, status_).violation == 0.0 ? 1 : 0;
      double highest = 0.0;
      for (const auto& outputs : archive_.outputs[k])
        highest = std::max(highest, outputs[static_cast<std::size_t>(status_)]);
      ++result.statuses.at(static_cast<std::size_t>(highest));
    }
    result.present = present_point(all);
    const double end = aims_.size() == 2 ? 0.4 : 0.95;
    auto best = solve(all, {}, 0.2, end);
    if (best.violation == 0.0 && aims_.size() == 2) {
      trade_off(best, result);
      best = nearest_to_ideal(result.front, all);
    }
    result.best = point_of(best);
    if (!result.best.feasible) find_reach(result);
    Bench bench(problem_, wanted_);
    if (result.best.feasible && !aims_.empty() && !watch_.stopped())
      result.limits = limits_of(bench, all, best);
    evaluations_ += bench.evaluations();
    result.evaluations = evaluations_;
    result.interrupted = watch_.stopped();
    return result;
  }

 private:
  void want(int column) {
    if (std::ranges::count(wanted_, column) == 0) wanted_.push_back(column);
  }

  /// The machine as it is, the corners of few changes, Sobol points.
  std::vector<std::vector<double>> places() const {
    constexpr std::size_t few = 6;
    const std::size_t size = problem_.changes.size();
    std::vector<double> present;
    for (const auto& change : problem_.changes)
      present.push_back(model::value(problem_.machine, change.id).value_or(change.distribution.a));
    std::vector<std::vector<double>> all{place_of(problem_.changes, present)};
    for (std::size_t corner = 0; size <= few && corner < (std::size_t{1} << size); ++corner) {
      all.emplace_back(size);
      for (std::size_t k = 0; k < size; ++k) all.back()[k] = (corner >> k & 1U) != 0U ? 1.0 : 0.0;
    }
    const Plan plan{
        .design = study::Design::sobol, .samples = options_.samples, .seed = options_.seed};
    for (std::uint64_t row = 0; row < options_.samples; ++row) {
      all.emplace_back(size);
      place(plan, row, all.back());
    }
    return all;
  }

  /// As many as take a twentieth of a second: between them an interruption is noticed.
  std::size_t designs_together() const {
    constexpr std::size_t most = 64;
    constexpr double long_enough = 0.05;  // [s]
    const auto begun = std::chrono::steady_clock::now();
    const auto values = values_at(problem_.changes, archive_.t.front());
    for (const auto& pose : problem_.poses) {
      std::vector<double> outputs(problem_.outputs.size(), missing);
      DesignModel(problem_, pose, wanted_).outputs(values, outputs);
    }
    const std::chrono::duration<double> one = std::chrono::steady_clock::now() - begun;
    return std::clamp<std::size_t>(static_cast<std::size_t>(long_enough / one.count()), 1, most);
  }

  void take_samples() {
    archive_.t = places();
    const std::size_t together = designs_together();
    const std::size_t count = archive_.t.size(), poses = problem_.poses.size();
    archive_.values.resize(count);
    archive_.outputs.assign(count, std::vector(poses, std::vector<double>()));
    const std::size_t tasks = (count + together - 1) / together;
    std::vector<char> ready(count);
    numerics::parallel_for(
        tasks, options_.threads,
        [&](std::size_t task) {
          const std::size_t from = task * together, to = std::min(count, from + together);
          for (std::size_t k = from; k < to; ++k)
            archive_.values[k] = values_at(problem_.changes, archive_.t[k]);
          for (std::size_t pose = 0; pose < poses; ++pose) {
            DesignModel model(problem_, problem_.poses[pose], wanted_);
            std::vector<Row> rows;
            for (std::size_t k = from; k < to; ++k) {
              archive_.outputs[k][pose].assign(problem_.outputs.size(), missing);
              rows.push_back({archive_.values[k], archive_.outputs[k][pose]});
            }
            model.outputs(rows);
          }
          std::fill(ready.begin() + static_cast<std::ptrdiff_t>(from),
                    ready.begin() + static_cast<std::ptrdiff_t>(to), 1);
        },
        [&](double share) { return watch_.at(0.2 * share); });
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (ready[k] == 0) continue;
      std::swap(archive_.t[kept], archive_.t[k]);
      std::swap(archive_.values[kept], archive_.values[k]);
      std::swap(archive_.outputs[kept], archive_.outputs[k]);
      ++kept;
    }
    if (ready[0] == 0) throw base::ComputationError("interrupted before the first design");
    archive_.t.resize(kept);
    archive_.values.resize(kept);
    archive_.outputs.resize(kept);
    evaluations_ += kept;
  }

  /// An aim counts in shares of its range over the samples.
  void scale_aims() {
    for (auto& aim : aims_) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t k = 0; k < archive_.t.size(); ++k) {
        const Trial one{.t = {}, .values = archive_.values[k], .outputs = archive_.outputs[k]};
        for (std::size_t pose = 0; pose < problem_.poses.size(); ++pose) {
          const double value = value_of(aim, one, pose);
          if (!std::isfinite(value)) continue;
          low = std::min(low, value);
          high = std::max(high, value);
        }
      }
      if (high > low) aim.scale = high - low;
    }
  }

  /// The best samples for a goal that are apart from each other.
  std::vector<Trial> starts(const Goal& goal, std::vector<Trial> first, int count) const {
    constexpr double apart = 0.1;
    std::vector<Trial> all;
    for (std::size_t k = 0; k < archive_.t.size(); ++k)
      all.push_back(archive_.trial(k, goal, status_));
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order,
                             [&](std::size_t a, std::size_t b) { return better(all[a], all[b]); });
    auto chosen = std::move(first);
    const std::size_t wanted = chosen.size() + static_cast<std::size_t>(count);
    for (const std::size_t k : order) {
      if (chosen.size() >= wanted) break;
      const bool near = std::ranges::any_of(chosen, [&](const Trial& other) {
        double most = 0.0;
        for (std::size_t i = 0; i < other.t.size(); ++i)
          most = std::max(most, std::abs(other.t[i] - all[k].t[i]));
        return most < apart;
      });
      if (!near) chosen.push_back(std::move(all[k]));
    }
    return chosen;
  }

  Trial solve(const Goal& goal, std::vector<Trial> first, double from, double to) {
    for (auto& one : first) judge(goal, status_, one);
    auto best = starts(goal, std::move(first), options_.starts);
    std::atomic<std::uint64_t> evaluated{0};
    const auto stop = [&] { return watch_.stopped(); };
    numerics::parallel_for(
        best.size(), options_.threads,
        [&](std::size_t k) {
          Bench bench(problem_, wanted_);
          best[k] = local_search(bench, goal, best[k], stop);
          evaluated += bench.evaluations();
        },
        [&](double share) { return watch_.at(from + (to - from) * share); });
    evaluations_ += evaluated;
    return *std::ranges::min_element(best, better);
  }

  [[nodiscard]] DesignPoint point_of(const Trial& trial) const {
    DesignPoint point{.values = trial.values, .computed = trial.violation < no_outputs};
    point.feasible = point.computed;
    const auto worst_pose = [&](const Term& term) {
      std::size_t worst = 0;
      const auto bad = [&](std::size_t pose) {
        const double margin = margin_of(term, trial, pose);
        return std::isnan(margin) ? -std::numeric_limits<double>::infinity() : margin;
      };
      for (std::size_t pose = 1; pose < trial.outputs.size(); ++pose)
        if (bad(pose) < bad(worst)) worst = pose;
      return worst;
    };
    for (const auto& term : requirements_) {
      const std::size_t pose = worst_pose(term);
      point.worst.push_back(value_of(term, trial, pose));
      point.pose.push_back(static_cast<int>(pose));
      point.feasible = point.feasible && margin_of(term, trial, pose) >= 0.0;
    }
    for (const auto& term : aims_)  // the worst margin of what is minimised is its largest value
      point.aims.push_back(value_of(term, trial, worst_pose(term)));
    return point;
  }

  /// The machine as it is; its numbers may lie beyond the bounds.
  [[nodiscard]] DesignPoint present_point(const Goal& goal) const {
    Trial present;
    for (const auto& change : problem_.changes)
      present.values.push_back(
          model::value(problem_.machine, change.id).value_or(change.distribution.a));
    for (const auto& pose : problem_.poses) {
      present.outputs.emplace_back(problem_.outputs.size(), missing);
      DesignModel(problem_, pose, wanted_).outputs(present.values, present.outputs.back());
    }
    judge(goal, status_, present);
    return point_of(present);
  }

  [[nodiscard]] double aim_cost(std::size_t aim, const DesignPoint& point) const {
    return (aims_[aim].at_least ? -1.0 : 1.0) * point.aims[aim];
  }

  /// The other aim no worse than `cost`.
  [[nodiscard]] Goal with_bound(std::size_t objective, double cost) const {
    Goal goal{.objective = aims_[objective], .constraints = requirements_};
    Term bound = aims_[1 - objective];
    bound.bound = bound.at_least ? -cost : cost;
    goal.constraints.push_back(bound);
    return goal;
  }

  /// Both ends, each made better in the other aim; between them the first aim with bounds on the
  /// second in equal steps.
  void trade_off(const Trial& first_best, DesignResult& result) {
    constexpr double slack = 1e-7;
    Trial ends[2] = {first_best, solve({.objective = aims_[1], .constraints = requirements_},
                                       {first_best}, 0.4, 0.5)};
    for (std::size_t aim = 0; aim < 2; ++aim) {
      const double kept = ends[aim].cost + slack * aims_[aim].scale;
      const auto improved = solve(with_bound(1 - aim, kept), {ends[aim]}, 0.5, 0.55);
      if (improved.violation == 0.0) ends[aim] = improved;
      result.front.push_back(point_of(ends[aim]));
    }
    const double from = aim_cost(1, result.front[0]), to = aim_cost(1, result.front[1]);
    const int between = options_.front - 2;
    std::vector<Trial> last{ends[0], ends[1]};
    for (int k = 1; k <= between && from > to && !watch_.stopped(); ++k) {
      const double bound = from + (to - from) * k / (between + 1.0);
      auto found = solve(with_bound(0, bound), last, 0.55 + 0.4 * (k - 1) / between,
                         0.55 + 0.4 * k / between);
      if (found.violation > 0.0) continue;
      result.front.push_back(point_of(found));
      last = {std::move(found), ends[1]};
    }
    keep_front(result.front);
  }

  /// Ascending in the first aim, without those that another point beats in both.
  void keep_front(std::vector<DesignPoint>& front) const {
    std::erase_if(front, [](const DesignPoint& point) { return !point.feasible; });
    std::ranges::stable_sort(front, [&](const DesignPoint& a, const DesignPoint& b) {
      return std::pair(aim_cost(0, a), aim_cost(1, a)) < std::pair(aim_cost(0, b), aim_cost(1, b));
    });
    std::vector<DesignPoint> kept;
    for (auto& point : front)
      if (kept.empty() || aim_cost(1, point) < aim_cost(1, kept.back()))
        kept.push_back(std::move(point));
    if (!kept.empty() && aims_[0].at_least) std::ranges::reverse(kept);
    front = std::move(kept);
  }

  /// The point of the curve nearest to the best of both aims, each as a share of its range.
  Trial nearest_to_ideal(const std::vector<DesignPoint>& front, const Goal& goal) {
    double low[2] = {}, high[2] = {};
    for (std::size_t aim = 0; aim < 2; ++aim) {
      low[aim] = high[aim] = aim_cost(aim, front.front());
      for (const auto& point : front) {
        low[aim] = std::min(low[aim], aim_cost(aim, point));
        high[aim] = std::max(high[aim], aim_cost(aim, point));
      }
    }
    const auto distance = [&](const DesignPoint& point) {
      double sum = 0.0;
      for (std::size_t aim = 0; aim < 2; ++aim)
        if (high[aim] > low[aim])
          sum += std::pow((aim_cost(aim, point) - low[aim]) / (high[aim] - low[aim]), 2);
      return sum;
    };
    const auto at = std::ranges::min_element(front, {}, distance);
    Bench bench(problem_, wanted_);
    ++evaluations_;
    return bench.at(goal, place_of(problem_.changes, at->values));
  }

  void find_reach(DesignResult& result) {
    for (std::size_t k = 0; k < requirements_.size(); ++k) {
      Term objective = requirements_[k];
      const auto best = solve({.objective = objective}, {}, 0.95, 0.99);
      const double value =
          best.violation == 0.0 ? (objective.at_least ? -best.cost : best.cost) : missing;
      const double above = value - objective.bound;
      result.reach.push_back({.value = value,
                              .enough = objective.at_least ? above >= 0.0 : above <= 0.0,
                              .values = best.values});
    }
  }

  const DesignProblem& problem_;
  const DesignOptions& options_;
  numerics::Watch watch_;
  int status_{};
  std::vector<int> wanted_{};
  std::vector<Term> requirements_{}, aims_{};
  Archive archive_{};
  std::uint64_t evaluations_{};
};

}  // namespace

DesignResult design(const DesignProblem& problem, const DesignOptions& options,
                    const numerics::Progress& progress) {
  return Designer(problem, options, progress).run();
}

std::vector<Slice> design_slices(const DesignProblem& problem, const DesignPoint& at, int count) {
  std::vector<int> wanted;
  Goal goal;
  for (const auto& one : problem.requirements) {
    wanted.push_back(one.output);
    goal.constraints.push_back(term_of(one));
  }
  Bench bench(problem, wanted);
  std::vector<Slice> slices;
  const auto place = place_of(problem.changes, at.values);
  for (std::size_t k = 0; k < problem.changes.size(); ++k) {
    Slice slice{.worst = std::vector<std::vector<double>>(problem.requirements.size())};
    for (int i = 0; i < count; ++i) {
      auto t = place;
      t[k] = i / (count - 1.0);
      const auto trial = bench.at(goal, t);
      slice.values.push_back(trial.values[k]);
      for (std::size_t r = 0; r < goal.constraints.size(); ++r) {
        const auto& term = goal.constraints[r];
        double worst = term.at_least ? std::numeric_limits<double>::infinity()
                                     : -std::numeric_limits<double>::infinity();
        for (std::size_t pose = 0; pose < problem.poses.size(); ++pose) {
          const double value = value_of(term, trial, pose);
          worst = std::isnan(value) || std::isnan(worst) ? missing
                  : term.at_least                        ? std::min(worst, value)
                                                         : std::max(worst, value);
        }
        slice.worst[r].push_back(worst);
      }
    }
    slices.push_back(std::move(slice));
  }
  return slices;
}

}  // namespace hydrapod::study
