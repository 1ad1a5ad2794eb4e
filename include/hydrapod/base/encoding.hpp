#pragma once
/// Text that is not UTF-8.

#include <string_view>

namespace hydrapod::base {

/// Two bytes per character, as "Unicode" of editors and spreadsheets: by the byte order mark, or by
/// a zero in every second byte of the beginning.
bool is_utf16(std::string_view text);

inline constexpr std::string_view utf16_refused = "UTF-16 text; save the file as UTF-8";

}  // namespace hydrapod::base
