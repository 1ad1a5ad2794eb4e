#include "design_limits.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hydrapod::study {

namespace {

constexpr double active_margin = 1e-4;
constexpr double at_bound = 1e-6;

/// min ‖A x − b‖ with x ≥ 0 (C. L. Lawson & R. J. Hanson, Solving Least Squares Problems, 1974,
/// ch. 23).
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const Eigen::Index n = A.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<bool> free(static_cast<std::size_t>(n));
  const auto solved = [&] {
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Index> columns;
    for (Eigen::Index k = 0; k < n; ++k)
      if (free[static_cast<std::size_t>(k)]) columns.push_back(k);
    if (columns.empty()) return z;
    const Eigen::MatrixXd part = A(Eigen::all, columns);
    const Eigen::VectorXd found = part.completeOrthogonalDecomposition().solve(b);
    for (std::size_t k = 0; k < columns.size(); ++k)
      z[columns[k]] = found[static_cast<Eigen::Index>(k)];
    return z;
  };
  const double little = 1e-12 * (1.0 + b.norm());
  for (Eigen::Index round = 0; round < 3 * n; ++round) {
    const Eigen::VectorXd w = A.transpose() * (b - A * x);
    Eigen::Index enters = -1;
    for (Eigen::Index k = 0; k < n; ++k)
      if (!free[static_cast<std::size_t>(k)] && w[k] > little && (enters < 0 || w[k] > w[enters]))
        enters = k;
    if (enters < 0) break;
    free[static_cast<std::size_t>(enters)] = true;
    for (Eigen::VectorXd z = solved();; z = solved()) {
      double step = 1.0;
      for (Eigen::Index k = 0; k < n; ++k)
        if (free[static_cast<std::size_t>(k)] && z[k] <= 0.0 && x[k] > z[k])
          step = std::min(step, x[k] / (x[k] - z[k]));
      x += step * (z - x);
      if (step >= 1.0) break;
      for (Eigen::Index k = 0; k < n; ++k)
        if (free[static_cast<std::size_t>(k)] && x[k] <= little) {
          free[static_cast<std::size_t>(k)] = false;
          x[k] = 0.0;
        }
    }
  }
  return x;
}

/// Columns of the system, in order: poses of the objective, active margins, bounds.
struct Conditions {
  std::vector<Eigen::RowVectorXd> costs{}, others{};
};

std::vector<std::size_t> worst_poses(const Bench& bench, const Goal& goal, const Trial& best) {
  constexpr double same = 1e-6;
  const auto& term = *goal.objective;
  if (term.change >= 0) return {0};
  std::vector<std::size_t> poses;
  for (std::size_t pose = 0; pose < bench.problem().poses.size(); ++pose) {
    const double value = value_of(term, best, pose);
    if (best.cost - (term.at_least ? -value : value) <= same * term.scale) poses.push_back(pose);
  }
  return poses;
}

/// The multipliers of `others`; nothing where they do not explain the gradient of the cost.
std::optional<Eigen::VectorXd> multipliers(const Conditions& conditions) {
  constexpr double left_over = 0.05, weight = 1e3;
  const auto costs = static_cast<Eigen::Index>(conditions.costs.size());
  const auto others = static_cast<Eigen::Index>(conditions.others.size());
  const Eigen::Index size = conditions.costs.front().size();
  double scale = 0.0;
  for (const auto& cost : conditions.costs) scale = std::max(scale, cost.norm());
  if (scale == 0.0) return {};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size + 1, costs + others);
  for (Eigen::Index k = 0; k < costs; ++k) {
    A.col(k).head(size) = conditions.costs[static_cast<std::size_t>(k)].transpose() / scale;
    A(size, k) = weight;
  }
  for (Eigen::Index k = 0; k < others; ++k)
    A.col(costs + k).head(size) =
        -conditions.others[static_cast<std::size_t>(k)].transpose() / scale;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size + 1);
  b[size] = weight;
  const Eigen::VectorXd x = nonnegative_least_squares(A, b);
  const Eigen::VectorXd left = A * x - b;
  if (left.head(size).norm() > left_over) return {};
  return Eigen::VectorXd(x.tail(others));
}

/// Beside `best`, along single changes, requirements that are missed at once.
void add_jumps(Bench& bench, const Goal& goal, const Trial& best, std::size_t requirements,
               std::vector<Limit>& limits) {
  constexpr double step = 1e-5, far = 1e-3;
  for (std::size_t k = 0; k < best.t.size(); ++k)
    for (const double sign : {-1.0, 1.0}) {
      auto t = best.t;
      t[k] += sign * step;
      if (t[k] < 0.0 || t[k] > 1.0) continue;
      const auto beside = bench.at(goal, t);
      if (beside.violation == 0.0) continue;
      if (beside.violation < no_outputs && beside.cost >= best.cost) continue;
      Limit limit{.kind = Limit::Kind::jump, .change = static_cast<int>(k)};
      limit.beyond = std::numeric_limits<double>::quiet_NaN();
      if (beside.violation >= no_outputs) {
        limits.push_back(limit);
        continue;
      }
      for (std::size_t r = 0; r < requirements; ++r)
        for (std::size_t pose = 0; pose < bench.problem().poses.size(); ++pose) {
          if (margin_of(goal.constraints[r], beside, pose) > -far) continue;
          limit.requirement = static_cast<int>(r);
          limit.pose = static_cast<int>(pose);
          limit.beyond = value_of(goal.constraints[r], beside, pose);
          limits.push_back(limit);
        }
    }
}

}  // namespace

std::vector<Limit> limits_of(Bench& bench, const Goal& goal, const Trial& best) {
  const auto& problem = bench.problem();
  const auto derivatives = bench.derivatives(best);
  const auto& objective = *goal.objective;
  const double sign = objective.at_least ? -1.0 : 1.0;
  Conditions conditions;
  for (const std::size_t pose : worst_poses(bench, goal, best))
    conditions.costs.push_back(sign * bench.gradient(objective, best, derivatives, pose));
  std::vector<Limit> limits;
  std::vector<double> sizes;  // of the bound per unit of the multiplier's condition
  const std::size_t requirements = problem.requirements.size();
  for (std::size_t r = 0; r < requirements; ++r)
    for (std::size_t pose = 0; pose < problem.poses.size(); ++pose) {
      const auto& term = goal.constraints[r];
      if (margin_of(term, best, pose) > active_margin) continue;
      limits.push_back({.kind = Limit::Kind::requirement,
                        .requirement = static_cast<int>(r),
                        .pose = static_cast<int>(pose)});
      const double side = (term.at_least ? 1.0 : -1.0) / term.scale;
      conditions.others.push_back(side * bench.gradient(term, best, derivatives, pose));
      sizes.push_back(side);
    }
  for (std::size_t k = 0; k < best.t.size(); ++k) {
    const bool low = best.t[k]<at_bound, high = best.t[k]> 1.0 - at_bound;
    if (!low && !high) continue;
    limits.push_back({.kind = low ? Limit::Kind::lower_bound : Limit::Kind::upper_bound,
                      .change = static_cast<int>(k)});
    Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(best.t.size()));
    slope[static_cast<Eigen::Index>(k)] = low ? 1.0 : -1.0;
    conditions.others.push_back(slope);
    sizes.push_back((low ? 1.0 : -1.0) / slope_at(problem.changes[k], best.values[k]));
  }
  if (const auto found = multipliers(conditions)) {
    for (std::size_t k = 0; k < limits.size(); ++k)
      limits[k].price = sign * (*found)[static_cast<Eigen::Index>(k)] * sizes[k];
    // A bound at which the design stands without pressing on it limits nothing.
    constexpr double nothing = 1e-12;
    std::erase_if(limits, [&](const Limit& limit) {
      return limit.kind != Limit::Kind::requirement && std::abs(*limit.price) <= nothing;
    });
  }
  add_jumps(bench, goal, best, requirements, limits);
  return limits;
}

}  // namespace hydrapod::study
