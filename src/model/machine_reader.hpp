#pragma once
/// The tree of a machine file, read into a Machine. Private to model/machine_file.cpp.

#include "faults.hpp"
#include "hydrapod/model/machine.hpp"
#include "value_tree.hpp"

namespace hydrapod::model {

/// Reads all of the machine. What is wrong goes to `faults`; a value that could not be read is NaN.
Machine read_machine(const Node& root, Faults& faults);

}  // namespace hydrapod::model
