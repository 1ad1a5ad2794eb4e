#pragma once
/// Lines and fields of comma-separated files.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::data {

/// In quotes where it has a comma, quote or blank at an end.
std::string quoted_field(std::string_view text);

/// Carriage returns as \r and backslashes as \\, so that they survive in a comment line.
std::string escaped(std::string_view text);
std::string unescaped(std::string_view text);

/// The fields of a line; `separator` ' ' stands for any number of blanks and tabulators. Quotes are
/// taken off, blanks around fields as well.
std::vector<std::string> split_fields(std::string_view line, char separator);

/// A number with a point or, where `decimal_comma`, a comma; "nan", "inf" in any case, an empty
/// field and "NA" are numbers too (missing ones). None: it is text.
std::optional<double> field_number(std::string_view field, bool decimal_comma);

/// "pressure [bar]", "pressure (bar)", "pressure / bar" as name and unit.
struct NameAndUnit {
  std::string name{};
  std::string unit{};
};
NameAndUnit name_and_unit(const std::string& title);

std::string_view trimmed_view(std::string_view text);

}  // namespace hydrapod::data
