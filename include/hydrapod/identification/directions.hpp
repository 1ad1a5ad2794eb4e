#pragma once
/// From what sensors measure to directions of the platform.
///
/// Small motions about the pose: leg lengths l = J_l_q q, so q = J_l_q⁻¹ l with q = (x, y, z, rx,
/// ry, rz) of the point Q in base axes. Drives, to which the legs' speeds are proportional, are
/// brought to directions in the same way. Accelerometers at p_k with axis e_k, both in base axes,
/// measure a_k = e_kᵀ (q̈_lin + q̈_rot × (p_k − Q)); six or more that see all directions give q̈ by
/// least squares.

#include "hydrapod/identification/spectra.hpp"
#include "hydrapod/kinematics/inverse.hpp"

namespace hydrapod::identification {

struct LinearSensor {
  spatial::Vector3 position{};  ///< in B [m]
  spatial::Vector3 axis{};      ///< unit vector in B
};

/// q from leg lengths, 6×6. Throws base::ComputationError at a singular pose.
Eigen::MatrixXd platform_from_legs(const model::Machine& machine, const spatial::Pose& X_BP,
                                   const spatial::Vector3& p_BQ);

/// q̈ from accelerations, 6×n. Throws base::ComputationError when the sensors do not see all
/// directions.
Eigen::MatrixXd platform_from_accelerometers(const std::vector<LinearSensor>& sensors,
                                             const spatial::Vector3& p_BQ);

/// The spectra with `channels` replaced by six platform channels, `map` times the former, which
/// come last; the numbers of the other channels close up. Names: `prefix` and x … rz. Units: those
/// of a length channel give "m" and "rad" with the same powers of time, those of drives "1" and
/// "1/m".
CrossSpectra to_platform(const CrossSpectra& spectra, const std::vector<int>& channels,
                         const Eigen::MatrixXd& map, const std::string& prefix = {});

/// The channels of a role with the directions leg 1 … 6 in this order, if all are there once;
/// responses if they are lengths, speeds or accelerations.
std::optional<std::vector<int>> leg_channels(const CrossSpectra& spectra,
                                             data::Role role = data::Role::response);

}  // namespace hydrapod::identification
