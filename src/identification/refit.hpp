#pragma once
/// Modes that were found, in other responses of the same system. Private to the module.

#include <vector>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// A fit to `responses` that begins at all poles of `found`, whose modes come first.
ModalModel refitted(const FrequencyResponses& responses, const Identification& found,
                    FitOptions options, Deviations deviations);

/// The modes of `found` in the order of its list, from a fit to `responses` that began at all poles
/// of its model.
std::vector<FittedMode> refitted_modes(const FrequencyResponses& responses,
                                       const Identification& found, FitOptions options,
                                       Deviations deviations);

}  // namespace hydrapod::identification
