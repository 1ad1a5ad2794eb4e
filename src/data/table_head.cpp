#include "table_head.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "hydrapod/base/text.hpp"
#include "time_stamp.hpp"

namespace hydrapod::data {

namespace {

using base::TableStyle;

constexpr unsigned most_header_lines = 1'000'000;  // machine files stand in them
constexpr std::size_t most_columns = 100'000;

/// How the cells of a line of numbers are apart, if it is one. Times may stand among them, and the
/// date before one as a cell of its own.
std::optional<TableStyle> row_style(std::string_view line) {
  constexpr std::array candidates{TableStyle{';', false},  TableStyle{';', true},
                                  TableStyle{'\t', false}, TableStyle{'\t', true},
                                  TableStyle{',', false},  TableStyle{' ', false},
                                  TableStyle{' ', true}};
  const auto fits = [&](const TableStyle& style) {
    if (style.separator != ' ' && line.find(style.separator) == line.npos) return false;
    base::TableCells cells(line, style.separator);
    bool any = false;
    for (std::string_view cell; cells.next(cell);) {
      const bool number = base::table_number(cell, style.decimal_comma).has_value();
      if (!number && !time_stamp(cell)) return false;
      any = any || (number && !cell.empty());
    }
    return any;
  };
  const auto found = std::ranges::find_if(candidates, fits);
  return found == candidates.end() ? std::nullopt : std::optional(*found);
}

/// "0,0050,-3,1416" under "t,a": a whole number and digits for each of the titles.
void refuse_commas_for_all(const TableHead& head, const TableStyle& style, unsigned line,
                           const Notes& notes) {
  if (style.separator != ',' || (head.texts.empty() && head.comment.text.empty())) return;
  const std::string& names = head.texts.empty() ? head.comment.text : head.texts.back().text;
  const std::size_t titles = base::table_cells(names, ',').size();
  if (titles < 2 || head.columns != 2 * titles) return;
  bool is_fraction = false;
  for (const base::TableCell& cell : base::table_cells(head.first_line, ',')) {
    std::string_view digits = cell.text;
    if (!is_fraction && (digits.starts_with('-') || digits.starts_with('+')))
      digits.remove_prefix(1);
    if (digits.empty() || digits.find_first_not_of("0123456789") != digits.npos) return;
    is_fraction = !is_fraction;
  }
  notes.fail(fmt::format("{} fields for {} titles: decimal commas together with commas between "
                         "fields; write decimal points, or semicolons between fields",
                         head.columns, titles),
             line);
}

}  // namespace

TableHead read_table_head(base::TableReader& table, const Notes& notes,
                          const std::function<void(std::string_view, unsigned)>& comment) {
  TableHead head;
  constexpr std::size_t kept = 8;             // lines of text that may be titles
  constexpr std::size_t longest = 1U << 20U;  // bytes of one
  for (std::string_view line; table.line() < most_header_lines && table.next_line(line, true);) {
    const std::string_view text = line.substr(0, longest);
    if (base::is_table_comment(base::trimmed(line))) {
      comment(line, table.line());
      const std::size_t begin = text.find_first_not_of(" \t#%/");
      head.comment = {std::string(begin == text.npos ? "" : text.substr(begin)), table.line()};
    } else if (const auto style = row_style(line)) {
      table.style = *style;
      head.columns = base::table_cells(line, style->separator).size();
      head.first_line = line;
      head.first_row = table.line_place();
      break;
    } else {
      if (head.texts.size() == kept) head.texts.erase(head.texts.begin());
      head.texts.push_back({std::string(text), table.line()});
    }
  }
  if (head.columns > most_columns)
    notes.fail(
        fmt::format("{} columns are more than the {} that are read", head.columns, most_columns),
        table.line());
  if (head.first_row) refuse_commas_for_all(head, table.style, table.line(), notes);
  return head;
}

TableNames table_names(const TableHead& head, char separator, bool two_for_time, Notes& notes) {
  const auto cells_of = [&](const std::string& text) {
    auto cells = base::table_cells(text, separator);
    if (separator == ' ' && two_for_time && cells.size() + 1 == head.columns)
      cells.insert(cells.begin(), base::TableCell{});
    return cells;
  };
  std::vector<std::vector<base::TableCell>> rows;
  for (const TableHead::Text& line : head.texts) {
    auto cells = cells_of(line.text);
    if (cells.size() == head.columns) {
      rows.push_back(std::move(cells));
    } else {
      rows.clear();
      notes.add(fmt::format("skipped \"{}\"", base::printable(line.text)), line.number, 0, "text");
    }
  }
  TableNames names;
  if (rows.empty() && head.columns > 1 && !head.comment.text.empty()) {
    auto cells = cells_of(head.comment.text);  // as numpy.savetxt writes titles
    if (cells.size() == head.columns) rows.push_back(std::move(cells));
  }
  names.titles.resize(head.columns);
  if (rows.empty()) return names;
  names.titles = rows.size() > 1 ? rows[rows.size() - 2] : rows.back();
  if (rows.size() < 2) return names;
  for (const base::TableCell& cell : rows.back()) {
    const std::string& unit = cell.text;
    const bool enclosed = unit.size() > 1 && (unit.front() == '[' || unit.front() == '(');
    names.units.push_back(enclosed ? unit.substr(1, unit.size() - 2) : unit);
  }
  return names;
}

}  // namespace hydrapod::data
