#pragma once
/// Which mode of the model is which target.
///
/// Every pair costs (ln ω/ω_t / 0.1)², and where the target names a direction or a shape, 25 (1 −
/// s) more, s being how much the mode is like it: a mode of the wrong shape is as bad as one that
/// is off by half. Modes off by more than a factor e are not asked for their shapes. The assignment
/// with the smallest sum is found exactly; without names that is the order of the frequencies.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "hydrapod/dynamics/normal_modes.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::observation {

/// For every row of `cost` a column of its own, so that the sum is smallest (Hungarian method,
/// O(rows² columns)). Throws std::invalid_argument when there are more rows than columns.
std::vector<int> assign(const Eigen::MatrixXd& cost);

/// Share of the platform's kinetic energy in mode k that is motion in `direction`; 0 for modes that
/// the platform cannot feel.
double direction_share(const dynamics::LinearModel& model, const dynamics::NormalModes& modes,
                       int k, int direction);

/// MAC of a platform shape, that of the mass centre, and mode k, with the platform's mass as the
/// metric.
double platform_mac(const dynamics::LinearModel& model, const dynamics::NormalModes& modes, int k,
                    const Vector6& shape);

/// Modes nearer than this share of ω² are hardly told apart by a measurement, and their shapes turn
/// into each other at the least change.
inline constexpr double seen_as_one = 1e-2;

/// W = (1 + ε/max) A (AᵀA + ε)⁻¹ for platform motions A of modes that are seen as one, in the
/// metric of the platform's mass: A Wᵀ takes out of a shape what they show of it, where those count
/// little that the platform feels less than ε, 3 % (in energy) of the one that it feels most.
inline constexpr double weak_mode = 0.03;
inline constexpr double regularised_gain = 1.0 + weak_mode;
Eigen::MatrixXd regularised(const Eigen::MatrixXd& A);
Eigen::MatrixXcd regularised(const Eigen::MatrixXcd& A);

/// What is seen of the mass centre's motion against the ground: 1, or LinearModel::against_base.
spatial::Matrix6 seen_motion(const dynamics::LinearModel& model, MotionAgainst against);

/// MAC of a shape of the mass centre with mode k and those that are seen as one with it.
double resonance_mac(const dynamics::LinearModel& model, const dynamics::NormalModes& modes, int k,
                     const Vector6& shape, MotionAgainst against = MotionAgainst::ground);

/// The target's shape as motion of the model's mass centre. It must have one.
Vector6 shape_at_center(const dynamics::LinearModel& model, const ModeTarget& target);

/// Per target the index of its mode.
std::vector<int> pair_modes(const dynamics::LinearModel& model, const dynamics::NormalModes& modes,
                            std::span<const ModeTarget* const> targets);

}  // namespace hydrapod::observation
