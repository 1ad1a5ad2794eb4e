/// Any bytes as a table: the first byte selects how it is read.
///
/// Cells must stand where their columns say they do, and what is written as a cell must come back.

#include <vector>

#include "fuzz.hpp"
#include "hydrapod/base/file.hpp"

namespace {

using namespace hydrapod;

void read_rows(base::TableReader& table) {
  for (const auto& title : table.titles())
    if (title.column == 0 || title.unit_column == 0) std::abort();
  std::vector<base::TableCell> cells;
  while (table.row(cells))
    for (const auto& cell : cells) {
      base::table_number(cell.text, table.style.decimal_comma);
      base::with_decimal_point(cell.text);
      base::table_title(cell);
      fuzz::require_presentable(table.fault(cell.column, base::printable(cell.text), "message"));
    }
}

/// Line by line, and each line again from its place.
void read_lines(base::TableReader& table) {
  std::string_view line;
  for (int count = 0; table.next_line(line, true) && count < 1000; ++count) {
    const std::string first(line);
    const auto number = table.line();
    table.go_to(table.line_place());
    if (!table.next_line(line, true) || line != first || table.line() != number) std::abort();
    base::is_table_comment(line);
    base::table_cells(line, count % 2 == 0 ? ',' : ' ');
  }
}

void write_cell(const std::string& text) {
  if (text.find_first_of("\r\n") != text.npos) return;
  const auto cells = base::table_cells(base::quoted_cell(text) + ",1", ',');
  if (cells.size() != 2 || cells[0].text != text || cells[1].text != "1") std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::accepted([&] {
    if (data[0] % 4 == 0) {
      base::TableReader table(text, "table.csv");
      read_rows(table);
    } else if (data[0] % 4 == 1) {
      base::TableReader table(fuzz::file_of(text));
      read_rows(table);
    } else if (data[0] % 4 == 2) {
      base::TableReader table(fuzz::file_of(text));
      read_lines(table);
    } else {
      write_cell(text);
    }
  });
  return 0;
}
