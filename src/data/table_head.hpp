#pragma once
/// What stands above the numbers of a table in a text file: comments, titles, units.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/file.hpp"
#include "notes.hpp"

namespace hydrapod::data {

struct TableHead {
  struct Text {
    std::string text{};
    unsigned number{};  ///< of its line
  };
  std::vector<Text> texts{};  ///< lines above the numbers that may be titles, the last few
  Text comment{};             ///< the last one, without its mark
  std::size_t columns{};
  std::string first_line{};                             ///< of numbers
  std::optional<base::TableReader::Place> first_row{};  ///< none: there is no line of numbers
};

/// Reads to the first line of numbers, with times among them, and sets the style of `table`.
/// `comment` gets every comment line and its number.
TableHead read_table_head(base::TableReader& table, const Notes& notes,
                          const std::function<void(std::string_view, unsigned)>& comment);

/// The titles of the columns, empty ones where there are none, and the units of a row of units
/// below them. Where the first two columns are a date and a time (`two_for_time`), they may have
/// one title.
struct TableNames {
  std::vector<base::TableCell> titles{};
  std::vector<std::string> units{};  ///< empty: no such row
};
TableNames table_names(const TableHead& head, char separator, bool two_for_time, Notes& notes);

}  // namespace hydrapod::data
