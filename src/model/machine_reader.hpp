#pragma once
/// The tree of a machine file, read into a Machine. Private to the module.

#include <vector>

#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

struct ReadMachine {
  Machine machine{};
  std::vector<GivenNumber> given{};  ///< in the order of the file, then of the overrides
};

/// Reads all of the machine. What is wrong goes to `faults`; a value that could not be read is NaN.
ReadMachine read_machine(const Node& root, Faults& faults);

/// Reports keys that mean nothing, with the nearest known one, and values where a table must stand.
void check_keys(const Node& root, Faults& faults);

}  // namespace hydrapod::model
