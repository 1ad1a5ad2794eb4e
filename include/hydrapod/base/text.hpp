#pragma once
/// Small operations on text. Letters are those of ASCII.

#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::base {

/// `text` without blanks, tabs and line ends at both ends.
std::string_view trimmed(std::string_view text);

std::string lower_case(std::string_view text);

/// `text` cut at each `separator`, every part trimmed. An empty text is one empty part.
std::vector<std::string> split(std::string_view text, std::string_view separator);

/// Does `path` end with one of `endings`? Upper and lower case are the same.
bool has_ending(std::string_view path, std::initializer_list<std::string_view> endings);

}  // namespace hydrapod::base
