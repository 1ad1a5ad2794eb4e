#pragma once
/// Calibrations and sensitivities as people read them.

#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/calibration/sensitivity.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Combinations, targets against model, parameters, what is determined and what is not, remarks.
std::string calibration_text(const calibration::Calibration& result,
                             const observation::Targets& targets,
                             const std::vector<calibration::Profile>& profiles, bool colour,
                             std::size_t width);

/// Modes across, parameters downwards, in per cent per per cent, the most important first.
std::string sensitivity_text(const calibration::Sensitivities& sensitivities,
                             const TableStyle& style);
std::string sensitivity_csv(const calibration::Sensitivities& sensitivities);

}  // namespace hydrapod::cli
