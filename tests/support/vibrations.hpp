#pragma once
/// Free vibrations of a plant whose cylinders are blocked: valves shut, nothing leaks.

#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::test {

/// Overlapped valves without leakage, tight pistons.
void block_cylinders(model::Machine& machine);

/// Scales of small changes: those of the state, the rotation vector's for the quaternion's.
Eigen::VectorXd tangent_scales(const simulation::Plant& plant);

/// Poles that vibrate [1/s] of the plant linearised at rest at `X_BP`, Im > 1 rad/s, by Im; without
/// those of the spools (Re < −100 1/s).
Eigen::VectorXcd vibrations(const simulation::Plant& plant, const spatial::Pose& X_BP);

/// Im of vibrations(), which must be undamped: |Re| ≤ 1e-4 Im.
Eigen::VectorXd undamped_frequencies(const simulation::Plant& plant, const spatial::Pose& X_BP);

}  // namespace hydrapod::test
