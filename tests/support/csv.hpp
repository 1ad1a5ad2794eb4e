#pragma once
/// CSV (RFC 4180: comma, double quotes) read for tests.

#include <string>
#include <utility>
#include <vector>

namespace hydrapod::test {

using CsvRow = std::vector<std::string>;

inline std::vector<CsvRow> parse_csv(const std::string& text) {
  std::vector<CsvRow> rows;
  CsvRow row;
  std::string cell;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      const bool escaped = c == '"' && i + 1 < text.size() && text[i + 1] == '"';
      if (escaped) cell += text[++i];
      if (!escaped && c == '"') quoted = false;
      if (c != '"') cell += c;
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',' || c == '\n') {
      row.push_back(std::move(cell));
      cell.clear();
      if (c == '\n') rows.push_back(std::exchange(row, {}));
    } else {
      cell += c;
    }
  }
  return rows;
}

}  // namespace hydrapod::test
