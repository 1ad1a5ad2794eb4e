#include "hydrapod/kinematics/legs.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace hydrapod::kinematics {

namespace {

/// Shortens `step` so that neither part exceeds its limit.
Vector6 limited(const Vector6& step, const ForwardOptions& options) {
  const double scale =
      std::min({1.0, options.max_translation / std::max(step.head<3>().norm(), 1e-300),
                options.max_rotation / std::max(step.tail<3>().norm(), 1e-300)});
  return scale * step;
}

double residual_at(const LegGeometries& legs, const Vector6& lengths, Vector6& residual) {
  for (int i = 0; i < model::leg_count; ++i) residual[i] = legs[i].length - lengths[i];
  return residual.lpNorm<Eigen::Infinity>();
}

/// Whether the smallest pivot is rounding error against the largest.
bool is_singular(const Eigen::PartialPivLU<Matrix6>& lu) {
  const Vector6 pivots = lu.matrixLU().diagonal().cwiseAbs();
  return !(pivots.minCoeff() > 1e-14 * pivots.maxCoeff());
}

}  // namespace

ForwardResult forward_kinematics(const model::Machine& machine, const Vector6& lengths,
                                 const Pose& start, const ForwardOptions& options) {
  ForwardResult result{.X_BP = start};
  Vector6 residual;
  for (;; ++result.iterations) {
    const auto legs = inverse_kinematics(machine, result.X_BP);
    result.residual = residual_at(legs, lengths, residual);
    if (result.residual <= options.tolerance) {
      result.status = ForwardStatus::converged;
      return result;
    }
    if (result.iterations == options.max_iterations || !(result.residual < 1e300)) return result;

    const Eigen::PartialPivLU<Matrix6> lu(leg_jacobian(legs, result.X_BP.p_BP));
    const Vector6 step = -lu.solve(residual);
    if (!step.allFinite() || is_singular(lu)) {
      result.status = ForwardStatus::singular;
      return result;
    }
    result.X_BP = spatial::displaced(result.X_BP, limited(step, options));
  }
}

}  // namespace hydrapod::kinematics
