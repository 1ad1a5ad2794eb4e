#pragma once
/// The keys a machine file may have: those of parameter_table(). Private to the module.

#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

/// Reports keys that mean nothing, with the nearest known one, and values where a table must stand.
void check_keys(const Node& root, Faults& faults);

}  // namespace hydrapod::model
