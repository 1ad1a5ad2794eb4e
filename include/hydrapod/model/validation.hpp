#pragma once
/// What a description must satisfy to be a machine, whichever way it was made.

#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/parameters.hpp"

namespace hydrapod::model {

/// One finding; `key` is the path in a machine file (`legs.rod.length`, `leg.3.rod.length`), so
/// that whoever read the file can add line and column.
struct Finding {
  base::Severity severity{base::Severity::error};
  std::string key{};
  std::string message{};
  bool unusual{};  ///< of unusual_numbers()
};

/// Everything that is wrong with the numbers of `machine` themselves: signs, ranges, values that
/// are not finite, an inertia tensor that no body can have, two joints in one place, an oil spring
/// with both or neither description, a guide sleeve or piston that cannot be where it is said to
/// be. What depends on a pose (leg lengths, strokes, singularity) is kinematics::check_machine. All
/// findings at once; empty when the machine is sound. Never throws.
std::vector<Finding> validate(const Machine& machine);

/// Whether every value within_bound() of that number leaves a sound machine sound: the machine has
/// the number, and validate() relates it to no other one.
bool stands_alone(const Machine& machine, const ParameterId& id);
/// Whether the value is finite and within the bound of its row.
bool within_bound(const Assignment& assignment);

/// Numbers that a machine may have and that none is known to have, as warnings: beyond what is
/// usual by their rows (Bound::usual_most) or for their unit; a platform that weighs less than a
/// twentieth of its legs; one whose inertia and mass do not go together. With a guess where another
/// unit makes the number usual: "is 1050 m, …; did you mean 1050 mm?". Never throws for a machine
/// of finite numbers.
struct UnusualNumbers {
  std::vector<Finding> findings{};
  Machine guessed{};  ///< with the numbers that were probably meant
};
UnusualNumbers unusual_numbers(const Machine& machine);

}  // namespace hydrapod::model
