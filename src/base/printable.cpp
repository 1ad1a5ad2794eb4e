#include "hydrapod/base/text.hpp"

namespace hydrapod::base {

namespace {

/// Bytes of the well-formed UTF-8 character at the start of `text`, 0 if there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
  const bool surrogate = byte(0) == 0xED && byte(1) > 0x9F;
  const bool too_large = byte(0) == 0xF4 && byte(1) > 0x8F;
  return overlong || surrogate || too_large ? 0 : length;
}

bool is_control(std::string_view character) {
  const auto c = static_cast<unsigned char>(character[0]);
  const bool c1 = c == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  return c < 0x20 || c == 0x7F || c1;
}

}  // namespace

std::string printable(std::string_view text, std::size_t limit) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::size_t step = length == 0 ? 1 : length;
    if (shown.size() + step > limit) return shown + "...";
    if (length == 0 || is_control(text)) {
      shown += '?';
    } else {
      shown += text.substr(0, length);
    }
    text.remove_prefix(step);
  }
  return shown;
}

std::size_t first_invalid_utf8(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = character_length(text.substr(at));
    if (length == 0) return at;
    at += length;
  }
  return std::string_view::npos;
}

bool is_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  constexpr std::size_t least = 8, most = 256;  // bytes
  text = text.substr(0, most);
  if (text.size() < least) return false;
  const auto zeros_at = [&](std::size_t first) {
    for (std::size_t at = 0; at + 1 < text.size(); at += 2)
      if (text[at + first] != '\0' || text[at + 1 - first] == '\0') return false;
    return true;
  };
  return zeros_at(0) || zeros_at(1);
}

}  // namespace hydrapod::base
