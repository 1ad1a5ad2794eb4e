#pragma once
/// What a description must satisfy to be a machine, whichever way it was made.

#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::model {

/// One finding; `key` is the path in a machine file (`legs.rod.length`, `leg.3.rod.length`), so that
/// whoever read the file can add line and column.
struct Finding {
  base::Severity severity{base::Severity::error};
  std::string key{};
  std::string message{};
};

/// Everything that is wrong with the numbers of `machine` themselves: signs, ranges, an inertia
/// tensor that no body can have, two joints in one place, guide sleeve outside the rod, and for every
/// named pose: a leg shorter than its rod, a piston outside its stroke, a singular pose, joint limits.
/// All findings at once; empty when the machine is sound. Never throws.
std::vector<Finding> validate(const Machine& machine);

/// The same for one pose only (used for a pose given on the command line). `key` names the pose.
std::vector<Finding> validate_pose(const Machine& machine, const Pose& X_BP, const std::string& key);

}  // namespace hydrapod::model
