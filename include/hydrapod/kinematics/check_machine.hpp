#pragma once
/// What a machine file is judged by: the numbers themselves, and every named pose.

#include "hydrapod/kinematics/inverse.hpp"
#include "hydrapod/model/validation.hpp"

namespace hydrapod::kinematics {

/// Findings about one pose: a leg shorter than its rod, a piston outside its stroke, a guide sleeve
/// beyond the rod, a joint beyond its limit, a singular pose. `key` is what the findings are filed
/// under, for instance `poses.neutral`.
std::vector<model::Finding> check_pose(const model::Machine& machine, const Pose& X_BP,
                                       const std::string& key);

/// model::validate, then check_pose for every named pose. This is the model::Check to read machine
/// files with.
std::vector<model::Finding> check_machine(const model::Machine& machine);

}  // namespace hydrapod::kinematics
