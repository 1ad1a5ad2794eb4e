#pragma once
/// The controller's parameters for a machine: what its file leaves out follows from the machine.
///
/// With ω_1 and ω_6 the lowest and highest frequency of the rigid model at the pose (oil modes),
/// k_h the oil spring of a leg there and ζ `feedback_damping`:
///
///     gain G            0.3 ω_1 with pressure feedback, else 0.05 ω_1, the same for all six
///     integral time     8 / smallest gain above 0: its own pole is then real and some times slower
///     pressure feedback g = 2 ζ ω_1 / k_h;  acceleration feedback  g = 2 ζ / ω_6
///     feedback corner   0.1 ω_1
///
/// One mass m on one such leg, Ḟ = k_h (v_valve − v), m v̇ = F, answers to v_valve = −g F with
/// s² + k_h g s + k_h/m = 0: damping ratio ζ_j = k_h g / 2ω_j for a mode at ω_j, and a velocity
/// gain is stable up to 2 ζ_j ω_j = k_h g, whatever the mode. Fed-back acceleration gives ζ_j = g
/// ω_j / 2: most to the highest mode, where valve and delay lag most, so that one bounds it, and
/// leaves little to the lowest, hence the smaller gain.

#include "hydrapod/control/parameters.hpp"

namespace hydrapod::simulation {

struct Tuning {
  control::ControllerParameters parameters{};
  double lowest_oil_mode{};  ///< ω_1 [rad/s]
};

/// Throws base::ComputationError where the machine does not stand at `X_BP`.
Tuning tune_controller(const model::Machine& machine, const spatial::Pose& X_BP);

}  // namespace hydrapod::simulation
