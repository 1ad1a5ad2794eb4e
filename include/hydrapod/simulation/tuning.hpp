#pragma once
/// The controller's parameters for a machine: what its file leaves out follows from the machine.
///
/// With ω_1 the lowest frequency of the rigid model at the pose (the lowest oil mode), k_h the oil
/// spring of a leg there and ζ `feedback_damping`:
///
///     gain G            0.3 ω_1 (ControlSettings::default_bandwidth_share), the same for all
///     integral time     8 / smallest gain above 0: its own pole is then real and four times slower
///     pressure feedback g = 2 ζ ω_1 / k_h;  acceleration feedback  g = 2 ζ / ω_1
///     feedback corner   0.1 ω_1
///
/// For one mass m on one such leg, ṗ ∝ k_h (v_valve − v) with v_valve = −g F gives
/// s² + k_h g s + k_h/m = 0: damping ratio ζ at ω_1. A velocity gain G is then stable up to 2 ζ ω_1
/// in the same picture, whatever the mode, because ζ_j ω_j = ½ k_h g for each.

#include "hydrapod/control/parameters.hpp"

namespace hydrapod::simulation {

struct Tuning {
  control::ControllerParameters parameters{};
  double lowest_oil_mode{};  ///< ω_1 [rad/s]
};

/// Throws base::ComputationError where the machine does not stand at `X_BP`.
Tuning tune_controller(const model::Machine& machine, const spatial::Pose& X_BP);

}  // namespace hydrapod::simulation
