#pragma once
/// Targets from CSV. Private to the module.

#include "hydrapod/observation/targets.hpp"

namespace hydrapod::calibration {

/// A title row, then a mode per row. Throws base::InputError with every mistake.
observation::Targets parse_target_csv(const std::string& text, const std::string& file);

}  // namespace hydrapod::calibration
