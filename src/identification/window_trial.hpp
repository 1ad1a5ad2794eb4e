#pragma once
/// Which window the averages of another program had. Private to the module.

#include <functional>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Of responses as they are, without a trial of windows.
using IdentifyWhole = std::function<Identification(
    const FrequencyResponses&, const IdentifyOptions&, const std::function<void(double)>&)>;

/// Where modes leave more than noise, resonances may be wider than the machine's by a window that
/// the file does not name: then, with its effect, they leave noise alone.
void try_windows(const FrequencyResponses& given, const IdentifyOptions& options,
                 const IdentifyWhole& identified, const std::function<void(double)>& progress,
                 Identification& result);

}  // namespace hydrapod::identification
