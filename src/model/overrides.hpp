#pragma once
/// `PATH=VALUE`, laid over the tree of a machine file. Private to the reader.

#include <string>
#include <vector>

#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

/// Lays the overrides over `root` in their order; what is wrong with one of them goes to `faults`.
/// Whether the path means anything is for the schema to say, as for the file.
void lay_over(Node& root, const std::vector<std::string>& overrides, Faults& faults);

/// What messages call an override: `--set platform.mass=-3`.
std::string source_name(const std::string& override_text);

}  // namespace hydrapod::model
