#pragma once
/// From what somebody wrote about parameters to variables in SI. Private to the module.

#include <limits>

#include "problem.hpp"

namespace hydrapod::calibration {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// Resolves `free` against the numbers of `file`. Mistakes of all of them go to `errors`; the
/// result is then of no use. `targets`: friction can be fitted where they have amplitudes.
std::vector<Variable> make_variables(const std::vector<FreeParameter>& free,
                                     const model::MachineFile& file, const Targets& targets,
                                     std::vector<base::Diagnostic>& errors);

/// Start and bounds of the variable, and how it is scaled between them.
void set_range(Variable& variable, double start, double lower, double upper);

/// The same variables with neither signs nor bounds to hold to, but for some decades of room.
std::vector<Variable> unbound(std::vector<Variable> variables);

}  // namespace hydrapod::calibration
