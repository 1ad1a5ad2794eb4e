#pragma once
/// What a commanded motion asks of the machine, before it is simulated. Private to the module.

#include <string>
#include <vector>

#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::tasks {

/// Throws for a motion that cannot be; returns what else there is to say: valves too small for it.
/// `texts`: of `commands`. What is after the time at which `keep_going` ends it is not looked at.
std::vector<std::string> require_possible(const Machine& machine,
                                          const simulation::ClosedLoop& loop,
                                          const std::vector<std::string>& texts,
                                          const std::vector<signals::Signal>& commands,
                                          signals::Generator& signal, double until,
                                          const simulation::KeepGoing& keep_going = {});

}  // namespace hydrapod::tasks
