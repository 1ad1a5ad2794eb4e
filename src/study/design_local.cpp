/// Local searches: NLopt's SLSQP (D. Kraft, ACM Trans. Math. Softw. 20 (1994) 262) with
/// derivatives, its COBYLA (M. J. D. Powell, 1994) without, then steps along single changes.

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

#include "design_search.hpp"

namespace hydrapod::study {

namespace {

/// The margin that NLopt keeps: its own tolerance on constraints is smaller.
constexpr double kept_margin = 2e-8;
/// What stands for an objective or a constraint where the design has no outputs.
constexpr double nowhere = 1e3;

/// A goal as NLopt sees it. Variables: t, and with `level` one more, s: the largest of several
/// values (of an objective over poses, or of violations), which is minimised itself.
class Nlp {
 public:
  Nlp(Bench& bench, const Goal& goal, const Trial& start, const Stop& stop)
      : bench_(bench), goal_(goal), stop_(stop), best_(start), last_(start) {
    poses_ = bench.problem().poses.size();
    const bool seeks = start.violation > 0.0 || !goal.objective;
    feasibility_ = seeks;
    level_ = seeks || (goal.objective->output >= 0 && poses_ > 1);
    if (goal.objective) unit_ = goal.objective->scale;
  }

  [[nodiscard]] unsigned variables() const {
    return static_cast<unsigned>(bench_.problem().changes.size()) + (level_ ? 1U : 0U);
  }
  [[nodiscard]] unsigned constraints() const {
    std::size_t count = feasibility_ || !level_ ? 0 : poses_;
    for (const auto& term : goal_.constraints) count += term.output >= 0 ? poses_ : 1;
    return static_cast<unsigned>(count);
  }

  /// Runs `algorithm` from the best so far.
  void run(nlopt_algorithm algorithm, int evaluations, double step) {
    const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)> opt(
        nlopt_create(algorithm, variables()), &nlopt_destroy);
    opt_ = opt.get();
    std::vector<double> low(variables(), 0.0), high(variables(), 1.0);
    if (level_) {
      low.back() = -nowhere;
      high.back() = nowhere;
    }
    if (feasibility_) low.back() = -kept_margin;
    nlopt_set_lower_bounds(opt_, low.data());
    nlopt_set_upper_bounds(opt_, high.data());
    nlopt_set_min_objective(opt_, &Nlp::objective, this);
    const std::vector<double> exactly(constraints(), 0.0);
    if (constraints() > 0)
      nlopt_add_inequality_mconstraint(opt_, constraints(), &Nlp::constrain, this, exactly.data());
    nlopt_set_maxeval(opt_, evaluations);
    nlopt_set_xtol_rel(opt_, 1e-10);
    nlopt_set_ftol_rel(opt_, 1e-12);
    if (step > 0.0) nlopt_set_initial_step1(opt_, step);
    std::vector<double> x = best_.t;
    if (level_) x.push_back(level_of(best_));
    double found = 0.0;
    nlopt_optimize(opt_, x.data(), &found);  // how it ended does not matter: best_ was evaluated
    opt_ = nullptr;
    if (failure_) std::rethrow_exception(failure_);
  }

  [[nodiscard]] const Trial& best() const { return best_; }

 private:
  static double objective(unsigned n, const double* x, double* gradient, void* self) {
    return static_cast<Nlp*>(self)->guarded([&](Nlp& nlp) { return nlp.cost(n, x, gradient); });
  }
  static void constrain(unsigned m, double* result, unsigned n, const double* x, double* gradient,
                        void* self) {
    static_cast<Nlp*>(self)->guarded([&](Nlp& nlp) {
      nlp.rows(m, result, n, x, gradient);
      return 0.0;
    });
  }
  /// No exception may go through NLopt, which is C.
  template <class Do>
  double guarded(const Do& work) {
    try {
      if (!failure_) return work(*this);
    } catch (...) {
      failure_ = std::current_exception();
      nlopt_force_stop(opt_);
    }
    return nowhere;
  }

  [[nodiscard]] double level_of(const Trial& trial) const {
    return std::min(feasibility_ ? trial.violation : trial.cost / unit_, 0.5 * nowhere);
  }

  void go_to(const double* x, bool with_derivatives) {
    std::vector<double> t(x, x + bench_.problem().changes.size());
    for (double& one : t) one = std::isfinite(one) ? std::clamp(one, 0.0, 1.0) : 0.5;
    if (t != last_.t) {
      last_ = bench_.at(goal_, std::move(t));
      derivatives_.clear();
      if (better(last_, best_)) best_ = last_;
    }
    if (with_derivatives && derivatives_.empty() && last_.violation < no_outputs)
      derivatives_ = bench_.derivatives(last_);
    if (stop_ && stop_()) nlopt_force_stop(opt_);
  }

  double cost(unsigned n, const double* x, double* gradient) {
    if (gradient != nullptr) std::fill_n(gradient, n, 0.0);
    if (level_) {
      if (gradient != nullptr) gradient[n - 1] = 1.0;
      return x[n - 1];
    }
    go_to(x, gradient != nullptr);
    if (last_.violation >= no_outputs || !std::isfinite(last_.cost)) return nowhere;
    if (gradient != nullptr) {
      const auto slope = bench_.gradient(*goal_.objective, last_, derivatives_, 0);
      const double sign = goal_.objective->at_least ? -1.0 : 1.0;
      for (unsigned k = 0; k < n; ++k) gradient[k] = sign * slope[k] / unit_;
    }
    return last_.cost / unit_;
  }

  /// Constraints c ≤ 0: c = kept_margin − margin (− s).
  void rows(unsigned m, double* result, unsigned n, const double* x, double* gradient) {
    go_to(x, gradient != nullptr);
    if (gradient != nullptr) std::fill_n(gradient, std::size_t{m} * n, 0.0);
    std::size_t row = 0;
    const auto add = [&](const Term& term, std::size_t pose, double value, double sign,
                         bool with_level) {
      const double s = with_level ? x[n - 1] : 0.0;
      const bool there = last_.violation < no_outputs && std::isfinite(value);
      result[row] = there ? value - s : nowhere;
      if (gradient != nullptr) {
        double* to = gradient + row * n;
        if (with_level) to[n - 1] = -1.0;
        if (there) {
          const auto slope = bench_.gradient(term, last_, derivatives_, pose);
          for (Eigen::Index k = 0; k < slope.size(); ++k) to[k] = sign * slope[k];
        }
      }
      ++row;
    };
    for (const auto& term : goal_.constraints)
      for (std::size_t pose = 0; pose < (term.output >= 0 ? poses_ : 1); ++pose)
        add(term, pose, kept_margin - margin_of(term, last_, pose),
            (term.at_least ? -1.0 : 1.0) / term.scale, feasibility_);
    if (feasibility_ || !level_) return;
    const double sign = (goal_.objective->at_least ? -1.0 : 1.0) / unit_;
    for (std::size_t pose = 0; pose < poses_; ++pose)
      add(*goal_.objective, pose, sign * value_of(*goal_.objective, last_, pose), sign, true);
  }

  Bench& bench_;
  const Goal& goal_;
  const Stop& stop_;
  std::size_t poses_{};
  bool feasibility_{}, level_{};
  double unit_{1.0};
  Trial best_, last_;
  std::vector<DesignModel::Derivatives> derivatives_{};
  nlopt_opt opt_{};
  std::exception_ptr failure_{};
};

/// Steps along single changes, halved where none is better: ends at a jump as well.
Trial stepped(Bench& bench, const Goal& goal, Trial best, double step, const Stop& stop) {
  constexpr double finest = 1e-9;
  for (; step > finest && !(stop && stop()); step *= 0.5) {
    bool moved = true;
    for (int round = 0; moved && round < 4; ++round) {
      moved = false;
      for (std::size_t k = 0; k < best.t.size(); ++k)
        for (const double sign : {-1.0, 1.0}) {
          auto t = best.t;
          t[k] = std::clamp(t[k] + sign * step, 0.0, 1.0);
          if (t[k] == best.t[k]) continue;
          auto trial = bench.at(goal, std::move(t));
          if (!better(trial, best)) continue;
          best = std::move(trial);
          moved = true;
        }
    }
  }
  return best;
}

Trial by_nlopt(Bench& bench, const Goal& goal, const Trial& from, nlopt_algorithm algorithm,
               int evaluations, double step, const Stop& stop) {
  Nlp nlp(bench, goal, from, stop);
  nlp.run(algorithm, evaluations, step);
  return nlp.best();
}

}  // namespace

Trial local_search(Bench& bench, const Goal& goal, const Trial& start, const Stop& stop) {
  const auto size = static_cast<int>(start.t.size());
  constexpr int smooth = 120, rounds = 4;
  constexpr double radius = 0.05, first_step = 0.05, little = 1e-9;
  Trial best = start;
  for (int round = 0; round < rounds && !(stop && stop()); ++round) {
    const Trial before = best;
    best = by_nlopt(bench, goal, best, NLOPT_LD_SLSQP, smooth, 0.0, stop);
    // A start without feasible designs around it was led to one; now the objective counts.
    if (before.violation > 0.0 && best.violation == 0.0 && goal.objective)
      best = by_nlopt(bench, goal, best, NLOPT_LD_SLSQP, smooth, 0.0, stop);
    best = by_nlopt(bench, goal, best, NLOPT_LN_COBYLA, 60 + 25 * size, radius, stop);
    best = stepped(bench, goal, best, first_step, stop);
    const double gain = before.violation > 0.0 || best.violation > 0.0
                            ? before.violation - best.violation
                            : (before.cost - best.cost) / (goal.objective->scale);
    if (gain <= little) break;
  }
  return best;
}

}  // namespace hydrapod::study
