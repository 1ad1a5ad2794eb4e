#include "solver.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <cmath>
#include <limits>
#include <mutex>

namespace hydrapod::calibration {

namespace {

/// The state at the solver's current x, computed once for all residuals.
class SharedState : public ceres::EvaluationCallback {
 public:
  SharedState(const Problem& problem, const double* x) : problem_(problem), x_(x) {}

  void PrepareForEvaluation(bool jacobians, bool new_point) override {
    if (!new_point && (has_derivatives_ || !jacobians)) return;
    at_ = Eigen::Map<const Eigen::VectorXd>(x_, problem_.size());
    sound_ = problem_.evaluate(at_, jacobians, state_);
    has_derivatives_ = jacobians;
    if (sound_) problem_.residuals(at_, state_, r_, jacobians ? &J_ : nullptr);
  }

  [[nodiscard]] bool sound() const { return sound_ && r_.allFinite(); }
  [[nodiscard]] const Eigen::VectorXd& r() const { return r_; }
  [[nodiscard]] const Eigen::MatrixXd& J() const { return J_; }

 private:
  const Problem& problem_;
  const double* x_;
  Eigen::VectorXd at_{};
  State state_{};
  Eigen::VectorXd r_{};
  Eigen::MatrixXd J_{};
  bool sound_{}, has_derivatives_{};
};

/// Rows of the shared residuals as one of Ceres's.
class Rows : public ceres::CostFunction {
 public:
  Rows(const SharedState& shared, int first, int count, int parameters)
      : shared_(shared), first_(first), count_(count) {
    set_num_residuals(count);
    mutable_parameter_block_sizes()->push_back(parameters);
  }

  bool Evaluate(double const* const*, double* r, double** J) const override {
    if (!shared_.sound()) return false;
    Eigen::Map<Eigen::VectorXd>(r, count_) = shared_.r().segment(first_, count_);
    if (J == nullptr || J[0] == nullptr) return true;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto columns = parameter_block_sizes()[0];
    const auto part = shared_.J().middleRows(first_, count_);
    if (!part.allFinite()) return false;
    if (columns == 1) {
      Eigen::Map<Eigen::VectorXd>(J[0], count_) = part.col(0);
    } else {
      Eigen::Map<RowMajor>(J[0], count_, columns) = part;
    }
    return true;
  }

 private:
  const SharedState& shared_;
  int first_, count_;
};

class StopCallback : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::function<bool()>& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop_ && stop_() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& stop_;
};

/// Ceres tells its log what it dislikes about a step; the caller hears it from the result.
void quieten_log() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
}

void add_residuals(const Problem& problem, const SharedState& shared, const SolverOptions& options,
                   double* x, ceres::Problem& ceres_problem) {
  int row = 0;
  for (const auto& kind : problem.residuals()) {
    ceres::LossFunction* loss =
        options.cauchy && kind->is_data() ? new ceres::CauchyLoss(options.cauchy_scale) : nullptr;
    ceres_problem.AddResidualBlock(new Rows(shared, row, kind->size(), problem.size()), loss, x);
    row += kind->size();
  }
}

void set_bounds(const Problem& problem, double* x, ceres::Problem& ceres_problem) {
  for (int j = 0; j < problem.size(); ++j) {
    const auto& variable = problem.variables()[static_cast<std::size_t>(j)];
    const double low = variable.x_lower(), high = variable.x_upper();
    if (std::isfinite(low)) ceres_problem.SetParameterLowerBound(x, j, low);
    if (std::isfinite(high)) ceres_problem.SetParameterUpperBound(x, j, high);
    x[j] = std::clamp(x[j], low, high);
  }
}

}  // namespace

Solution evaluated(const Problem& problem, const Eigen::VectorXd& x, const SolverOptions& options) {
  Solution solution{.converged = true, .x = x};
  State state;
  if (!problem.evaluate(solution.x, false, state)) return solution;
  Eigen::VectorXd r;
  problem.residuals(solution.x, state, r, nullptr);
  const double c2 = options.cauchy_scale * options.cauchy_scale;
  int row = 0;
  for (const auto& kind : problem.residuals()) {
    const double s = r.segment(row, kind->size()).squaredNorm();
    solution.cost += 0.5 * (options.cauchy && kind->is_data() ? c2 * std::log1p(s / c2) : s);
    row += kind->size();
  }
  solution.usable = std::isfinite(solution.cost);
  return solution;
}

Solution solve(const Problem& problem, const Eigen::VectorXd& start, const SolverOptions& options) {
  if (problem.size() == 0) return evaluated(problem, start, options);
  quieten_log();
  Solution solution{.x = start};
  SharedState shared(problem, solution.x.data());
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &shared;
  ceres::Problem ceres_problem(problem_options);
  add_residuals(problem, shared, options, solution.x.data(), ceres_problem);
  set_bounds(problem, solution.x.data(), ceres_problem);

  StopCallback callback(options.stop);
  ceres::Solver::Options solver_options;
  solver_options.max_num_iterations = options.max_iterations;
  solver_options.linear_solver_type = ceres::DENSE_QR;
  // with bounds every step is followed by a line search; this one needs no derivatives
  solver_options.line_search_interpolation_type = ceres::QUADRATIC;
  solver_options.logging_type = ceres::SILENT;
  solver_options.num_threads = 1;
  solver_options.function_tolerance = options.tolerance;
  solver_options.parameter_tolerance = 1e-10;
  solver_options.gradient_tolerance = 1e-12;
  solver_options.max_num_consecutive_invalid_steps = 20;
  solver_options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &ceres_problem, &summary);
  solution.usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  solution.stopped = summary.termination_type == ceres::USER_SUCCESS;
  solution.cost = summary.final_cost;
  return solution;
}

}  // namespace hydrapod::calibration
