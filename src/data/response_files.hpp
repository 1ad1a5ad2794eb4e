#pragma once
/// The readers of frequency responses behind frequency_response.hpp, one per format.

#include <string>

#include "hydrapod/data/frequency_response.hpp"

namespace hydrapod::data {

ReadFrequencyResponsesResult read_uff_responses(const std::string& path);

/// A table of text; its titles tell.
bool is_response_table(const std::string& path);
ReadFrequencyResponsesResult read_response_table(const std::string& path);

}  // namespace hydrapod::data
