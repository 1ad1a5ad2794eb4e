#pragma once
/// The readers of frequency responses behind frequency_response.hpp, one per format.

#include <string>

#include "hydrapod/data/frequency_response.hpp"
#include "notes.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

ReadFrequencyResponsesResult read_uff_responses(const std::string& path);

/// A table of text; its titles tell.
bool is_response_table(const std::string& path);
ReadFrequencyResponsesResult read_response_table(const std::string& path);

/// A MAT or HDF5 file: one that hydrapod wrote, or one of another program with complex arrays as
/// long as a list of frequencies beside them and no times.
bool holds_responses(VariableFile& file);
/// What a MAT or HDF5 file holds that is no record, in words; null: it may be one.
const char* what_else(VariableFile& file);
ReadFrequencyResponsesResult read_response_arrays(const std::string& path, OpenVariableFile open);

/// Fails where all imaginary parts are exactly 0: these are magnitudes, or real parts alone.
void require_imaginary_parts(const FrequencyResponses& all, const Notes& notes);

/// Behind a frequency below 0.
inline constexpr const char* two_sided_remedy =
    ", below 0 as in two-sided responses; expected are those from 0 Hz on alone";

inline constexpr const char* responses_mark = "hydrapod responses";
inline constexpr int responses_version = 1;

}  // namespace hydrapod::data
