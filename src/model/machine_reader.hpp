#pragma once
/// The tree of a machine file, read into a Machine. Private to the module.

#include <string_view>
#include <vector>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

struct ReadMachine {
  Machine machine{};
  std::vector<GivenNumber> given{};  ///< in the order of the file, then of the overrides
  std::vector<Finding> findings{};   ///< of what was fitted to tables
};

/// Reads all of the machine. What is wrong goes to `faults`; a value that could not be read is NaN.
ReadMachine read_machine(const Node& root, Faults& faults);

/// Warnings of the numbers that the file gives and that have no effect without another one.
std::vector<Finding> without_effect(const ReadMachine& read);

/// Reports what a leg of that type has no place for. All of it is one mistake.
void refuse_beside(LegType type, const Section& leg);

/// What would do in place of a missing table of the legs, for the end of a message.
std::string_view instead_of_table(std::string_view path);

/// Reports keys that mean nothing, with the nearest known one, and values where a table must stand.
void check_keys(const Node& root, Faults& faults);

}  // namespace hydrapod::model
