#pragma once
/// What stands above the numbers of a comma-separated file.

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "line_reader.hpp"
#include "notes.hpp"

namespace hydrapod::data {

struct CsvHeader {
  RecordHeader record{};  ///< units as the file has them
  bool by_hydrapod{};     ///< the file has the marks of hydrapod's own
  char separator{','};    ///< ' ': blanks and tabulators
  bool decimal_comma{};
  std::size_t columns{};  ///< the column of times, if any, included
  std::optional<std::size_t> time_column{};
  double time_factor{1.0};      ///< its unit in seconds
  std::string first_row{};      ///< the first line of numbers, already taken from the file
  unsigned first_row_number{};  ///< 0: there is none
  bool first_row_ended{true};
};

/// Reads up to the first line of numbers. Throws base::InputError where none comes.
CsvHeader read_csv_header(LineReader& lines, Notes& notes);

}  // namespace hydrapod::data
