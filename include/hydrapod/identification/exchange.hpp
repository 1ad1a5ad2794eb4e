#pragma once
/// Frequency responses to and from the form that files of other programs have.

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// With the variance of every entry and the multiple coherence.
data::FrequencyResponse to_exchange(const FrequencyResponses& responses, const std::string& title);

/// Variances per entry V_oi become noise and input factor V_oi ≈ n_o q_i, by their means over rows
/// and columns. Pairs that are missing in the file (NaN) are an error: base::InputError with
/// `file`.
FrequencyResponses from_exchange(const data::FrequencyResponse& response, const std::string& file);

}  // namespace hydrapod::identification
