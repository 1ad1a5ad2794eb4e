#include "csv_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>

namespace hydrapod::data {

namespace {

bool equal_but_for_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char p, unsigned char q) {
    return std::tolower(p) == std::tolower(q);
  });
}

std::optional<double> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::result_out_of_range) {
    // beyond the range of double: what the number tends to
    const bool small = text.find("e-") != text.npos || text.find("E-") != text.npos;
    const double size = small ? 0.0 : std::numeric_limits<double>::infinity();
    return text.starts_with('-') ? -size : size;
  }
  if (status != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

std::string unquoted(std::string_view field) {
  field = trimmed_view(field);
  if (field.size() < 2 || field.front() != '"' || field.back() != '"') return std::string(field);
  std::string text;
  for (std::size_t i = 1; i + 1 < field.size(); ++i) {
    text += field[i];
    if (field[i] == '"' && field[i + 1] == '"') ++i;
  }
  return text;
}

}  // namespace

std::string_view trimmed_view(std::string_view text) {
  constexpr const char* blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string quoted_field(std::string_view text) {
  const bool plain = text.find_first_of(",;\"") == text.npos && trimmed_view(text) == text;
  if (plain) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\\\";
    else if (c == '\r')
      out += "\\r";
    else
      out += c;
  }
  return out;
}

std::string unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '\\' && i + 1 < text.size();
    if (escape && text[i + 1] == 'r')
      out += '\r';
    else if (escape && text[i + 1] == '\\')
      out += '\\';
    else
      out += text[i];
    if (escape && (text[i + 1] == 'r' || text[i + 1] == '\\')) ++i;
  }
  return out;
}

std::vector<std::string> split_fields(std::string_view line, char separator) {
  std::vector<std::string> fields;
  if (separator == ' ') {
    line = trimmed_view(line);
    while (!line.empty()) {
      const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
      fields.push_back(unquoted(line.substr(0, end)));
      line = trimmed_view(line.substr(end));
    }
    return fields;
  }
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != separator)) continue;
    fields.push_back(unquoted(line.substr(begin, i - begin)));
    begin = i + 1;
  }
  return fields;
}

std::optional<double> field_number(std::string_view field, bool decimal_comma) {
  field = trimmed_view(field);
  if (field.size() > 1 && field.front() == '"' && field.back() == '"')
    field = trimmed_view(field.substr(1, field.size() - 2));
  constexpr std::array<std::string_view, 5> missing{"", "nan", "na", "n/a", "-nan"};
  if (const auto value = parsed(field); value && !decimal_comma) return value;
  if (std::any_of(missing.begin(), missing.end(),
                  [&](std::string_view word) { return equal_but_for_case(field, word); }))
    return std::numeric_limits<double>::quiet_NaN();
  if (!decimal_comma || field.size() > 64) return parsed(field);
  std::array<char, 64> buffer{};
  std::replace_copy(field.begin(), field.end(), buffer.begin(), ',', '.');
  return parsed({buffer.data(), field.size()});
}

NameAndUnit name_and_unit(const std::string& title) {
  const auto name_until = [&](std::size_t at) {
    return std::string(trimmed_view(std::string_view(title).substr(0, at)));
  };
  for (const char* pair : {"[]", "()"}) {
    const std::size_t open = title.rfind(pair[0]);
    if (open == std::string::npos || open == 0 || title.back() != pair[1]) continue;
    return {name_until(open), title.substr(open + 1, title.size() - open - 2)};
  }
  if (const std::size_t slash = title.rfind(" / "); slash != std::string::npos && slash > 0)
    return {name_until(slash), title.substr(slash + 3)};
  return {title, ""};
}

}  // namespace hydrapod::data
