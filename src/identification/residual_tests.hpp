#pragma once
/// Whether noise explains what a modal model leaves of the responses. Private to the module.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Responses and parts of the band where it does not, worst first. `assumed`: the errors are, see
/// assumed_errors.hpp.
std::vector<Unexplained> unexplained_parts(const FrequencyResponses& responses,
                                           const ModalModel& model, const IdentifyOptions& options,
                                           bool assumed);

}  // namespace hydrapod::identification
