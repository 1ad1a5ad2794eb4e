#pragma once
/// Which arrays of a MAT or HDF5 file may be frequency responses.

#include <optional>
#include <string>
#include <vector>

#include "variable_file.hpp"

namespace hydrapod::data {

/// Complex numbers: one array, or two with their real and imaginary parts.
struct Candidate {
  std::string name{};
  std::size_t variable{};
  std::optional<std::size_t> imaginary{};
  std::vector<std::uint64_t> sizes{};  ///< as the user of the file counts the indices
};

std::vector<Candidate> candidates(const VariableFile& file);
bool has_size(const Candidate& candidate, std::uint64_t size);

/// Is a list of this name one of angular frequencies?
bool is_circular_frequency(const std::string& name);
/// Lists of frequencies as long as one index of a candidate.
std::vector<std::size_t> frequency_lists(const VariableFile& file,
                                         const std::vector<Candidate>& arrays);

/// Did hydrapod write it?
bool holds_own_responses(const VariableFile& file);

}  // namespace hydrapod::data
