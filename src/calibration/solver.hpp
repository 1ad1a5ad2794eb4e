#pragma once
/// Least squares by Ceres. The only translation unit with its headers. Private to the module.

#include <functional>

#include "problem.hpp"

namespace hydrapod::calibration {

struct SolverOptions {
  int max_iterations{200};
  double tolerance{1e-9};  ///< relative change of the cost
  bool cauchy{false};      ///< data residuals in a Cauchy loss of scale `cauchy_scale`
  double cauchy_scale{2.0};
  /// Called after every step; true stops, with the best so far.
  std::function<bool()> stop{};
};

struct Solution {
  bool usable{};     ///< the machine had modes where it ended
  bool converged{};  ///< by its own criteria, not by the number of steps
  bool stopped{};
  double cost{};  ///< ½ Σ ρ(r²), constraints and priors included
  Eigen::VectorXd x{};
};

/// The problem at `x`, with nothing solved.
Solution evaluated(const Problem& problem, const Eigen::VectorXd& x, const SolverOptions& options);

Solution solve(const Problem& problem, const Eigen::VectorXd& start, const SolverOptions& options);

}  // namespace hydrapod::calibration
