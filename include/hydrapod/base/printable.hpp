#pragma once
/// Text from outside, made fit for a message.

#include <cstddef>
#include <string>
#include <string_view>

namespace hydrapod::base {

/// `text` in one line of valid UTF-8: control characters and broken bytes become `?`, and what goes
/// beyond `limit` bytes is cut off between two characters and marked with `...`.
std::string printable(std::string_view text, std::size_t limit = 60);

/// Byte at which `text` stops being valid UTF-8; npos when all of it is.
std::size_t first_invalid_utf8(std::string_view text);

}  // namespace hydrapod::base
