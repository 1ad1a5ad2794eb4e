#pragma once
/// The controller for small motions about an equilibrium: as a sampled system, and as the
/// continuous one that it approaches with ever faster sampling.
///
///     ξ_{k+1} = A_d ξ_k + B_d u_k   or   ξ̇ = A ξ + B u,      drives = C ξ + D u
///
/// u = (leg lengths 6, cap pressures 6, rod pressures 6, piston accelerations 6, commanded
/// displacement of the pose 6 (as in spatial::displaced), commanded velocity 6), ξ = (∫e 6; slow
/// part of force or acceleration 6, where feedback is on). Limits, rounding, noise and the
/// computation's delay are not in it. The slow load's effect on the speed per drive is left out: at
/// rest nothing is driven but leakage.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "hydrapod/control/controller.hpp"

namespace hydrapod::control {

/// Where the inputs of a LinearController begin.
struct ControllerInputs {
  static constexpr int length = 0, cap_pressure = 6, rod_pressure = 12, acceleration = 18,
                       command = 24, velocity = 30, count = 36;
};

struct LinearController {
  Eigen::MatrixXd A{}, B{};           ///< continuous
  Eigen::MatrixXd A_d{}, B_d{};       ///< sampled
  Eigen::MatrixXd C{}, D{};           ///< both
  std::vector<std::string> states{};  ///< "integral x", …, "slow force of leg 1", …
};

/// About `X_BP`, commanded and measured, with the drives [shares] that hold it and the load forces
/// [N] at it.
LinearController linear_controller(const model::Machine& machine,
                                   const ControllerParameters& parameters, const Pose& X_BP,
                                   const Vector6& drives, const Vector6& loads);

}  // namespace hydrapod::control
