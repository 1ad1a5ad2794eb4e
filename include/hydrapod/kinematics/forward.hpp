#pragma once
/// Forward kinematics: the pose that gives measured leg lengths.
///
/// Newton on r(X) = l(X) − l_given with the exact Jacobian, pose updates on the rotation manifold
/// and a step limit, so a start within the same assembly mode converges quadratically. A hexapod
/// has up to 40 assembly modes; the one nearest the start is found, which is what a controller
/// wants.
///
/// It stops as converged when max|r| ≤ tolerance. Valid range: the start's Jacobian must be
/// regular.

#include "hydrapod/kinematics/inverse.hpp"

namespace hydrapod::kinematics {

struct ForwardOptions {
  double tolerance{1e-12};  ///< [m], on the largest residual: max|l(X) − l_given|
  int max_iterations{50};
  double max_translation{0.25};  ///< [m] largest step of one iteration
  double max_rotation{0.5};      ///< [rad] largest step of one iteration
};

enum class ForwardStatus { converged, singular, not_converged };

struct ForwardResult {
  Pose X_BP{};
  ForwardStatus status{ForwardStatus::not_converged};
  int iterations{};
  double residual{};  ///< max|l(X) − l_given| [m] at X_BP
};

/// The pose near `start` at which the legs have `lengths` [m]. Never throws; read `status`.
ForwardResult forward_kinematics(const model::Machine& machine, const Vector6& lengths,
                                 const Pose& start, const ForwardOptions& options = {});

}  // namespace hydrapod::kinematics
