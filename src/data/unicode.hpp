#pragma once
/// Text as MATLAB keeps it.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::data {

/// `text` must be UTF-8.
std::u16string utf16_from(std::string_view text);

/// Code units of UTF-16 (surrogate pairs are joined) or UTF-32; what is no character becomes "?".
std::string utf8_from(const std::vector<std::uint32_t>& units);

}  // namespace hydrapod::data
