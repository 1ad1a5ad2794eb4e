#pragma once
/// What of responses modes can be identified from. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// The lines of `r` with these numbers.
FrequencyResponses lines_of(const FrequencyResponses& r, const std::vector<std::size_t>& lines);

/// `r` without
///
/// - lines at f ≤ lowest · the highest frequency, where the residual terms s⁻² of a modal model have
///   no value: files of analysers begin with one at 0 Hz;
/// - lines with a number that is not finite, with a warning;
/// - outputs and inputs whose responses are 0 at all lines, with a warning each.
///
/// Throws base::ComputationError where no response is left, and where the largest is no size that
/// units could give it.
FrequencyResponses usable_responses(FrequencyResponses r, double lowest = 1e-6);

}  // namespace hydrapod::identification
