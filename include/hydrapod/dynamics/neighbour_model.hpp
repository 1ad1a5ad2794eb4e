#pragma once
/// The linear model of a machine a little beside one whose model is known: for central differences.
///
/// The search for the equilibrium starts at the known one and ends after the first Newton step that
/// leaves less than 1e-6 of the weight. What is left is of second order in the change, and the same
/// on both sides of a central difference.

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

/// Throws as linear_model() does.
LinearModel neighbour_model(const model::Machine& machine, const spatial::Pose& X_BP,
                            const LinearModel& center);

}  // namespace hydrapod::dynamics
