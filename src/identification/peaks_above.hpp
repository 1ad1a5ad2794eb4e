#pragma once
/// Peaks of the responses above the band that modes were found in. Private to the module.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// [Hz], those of lines above `to` that stand above their noise, the largest first. `all`: with
/// errors.
std::vector<double> peaks_above(const FrequencyResponses& all, double to,
                                const IdentifyOptions& options);

}  // namespace hydrapod::identification
