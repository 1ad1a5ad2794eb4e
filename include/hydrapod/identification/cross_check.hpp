#pragma once
/// What another method says of the same responses: the eigensystem realisation (realisation.hpp)
/// beside the modes of identify.hpp. Modes that both see, each by its own criteria, are hardly made
/// by the method.

#include <optional>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct CrossCheck {
  double omega{}, damping_ratio{};  ///< mean over the model orders that know it
  double mac{};                     ///< of its shape with what realised modes within 2 % span
  /// Within 1 % in frequency, 20 % (and 0.002) in damping and 80 % in MAC: SelectionOptions.
  bool agrees{};
};

/// Per mode of `found` what the realisation has near it (3 % in frequency), each of its modes once.
/// `responses`: all lines that were measured, of which those up to the band's end are used. Throws
/// base::ComputationError where there is no impulse response: frequencies that are not even.
std::vector<std::optional<CrossCheck>> cross_check(const Identification& found,
                                                         const FrequencyResponses& responses);

}  // namespace hydrapod::identification
