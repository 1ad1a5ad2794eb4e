#pragma once
/// What a description must satisfy to be a machine, whichever way it was made.

#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::model {

/// One finding; `key` is the path in a machine file (`legs.rod.length`, `leg.3.rod.length`), so
/// that whoever read the file can add line and column.
struct Finding {
  base::Severity severity{base::Severity::error};
  std::string key{};
  std::string message{};
};

/// Everything that is wrong with the numbers of `machine` themselves: signs, ranges, values that
/// are not finite, an inertia tensor that no body can have, two joints in one place, an oil spring
/// with both or neither description, a guide sleeve or piston that cannot be where it is said to
/// be. What depends on a pose (leg lengths, strokes, singularity) is kinematics::check_machine. All
/// findings at once; empty when the machine is sound. Never throws.
std::vector<Finding> validate(const Machine& machine);

}  // namespace hydrapod::model
