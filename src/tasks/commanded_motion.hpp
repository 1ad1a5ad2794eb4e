#pragma once
/// What a commanded motion asks of the machine, before it is simulated. Private to the module.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::tasks {

/// Throws for a motion that cannot be; returns what else there is to say: valves too small for it.
/// `texts`: of `commands`.
std::vector<std::string> require_possible(const Machine& machine,
                                          const simulation::ClosedLoop& loop,
                                          const std::vector<std::string>& texts,
                                          const std::vector<signals::Signal>& commands,
                                          signals::Generator& signal, double until);

/// The first place of the command at which the machine does not stand, though it does at its pose:
/// the legs buckle there, and the loop is unstable. At most 500 places are looked at.
std::optional<std::string> loss_of_rest(const Machine& machine, const simulation::ClosedLoop& loop,
                                        signals::Generator& signal, double until);

}  // namespace hydrapod::tasks
