#pragma once
/// Experiments in the files of records. Private to the module.

#include <string>

#include "hydrapod/data/record.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// Fills header.experiment, but for the machine file that is there already, from its JSON; where
/// that is empty, from what older records of hydrapod say in header.notes.
void settle_experiment(const std::string& json, Notes& notes, RecordHeader& header);

}  // namespace hydrapod::data
