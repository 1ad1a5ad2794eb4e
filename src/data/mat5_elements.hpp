#pragma once
/// Data elements of MAT files of version 5 as bytes. Private to the module.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::data {

inline constexpr std::uint64_t mat5_most_bytes = 0x7FFFFFFF;  ///< of one variable, as MATLAB reads

/// Four bytes, little-endian.
std::string mat5_word(std::uint32_t value);
/// Tag, data and what fills up to eight bytes.
std::string mat5_element(std::uint32_t type, std::string_view bytes);
/// Flags, sizes and name of an array of class `kind`.
std::string mat5_array_head(std::uint32_t kind, const std::vector<int>& size,
                            const std::string& name, bool complex = false);
std::string mat5_text(const std::string& name, const std::string& text);
std::string mat5_text_list(const std::string& name, const std::vector<std::string>& texts);
std::string mat5_numbers(const std::string& name, const std::vector<double>& values);
/// The 128 bytes at the beginning.
std::string mat5_file_head();

}  // namespace hydrapod::data
