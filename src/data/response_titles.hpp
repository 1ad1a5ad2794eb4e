#pragma once
/// The titles of a table of frequency responses: what each column holds.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/file.hpp"

namespace hydrapod::data {

enum class TablePart {
  none,
  frequency,
  real,
  imaginary,
  magnitude,
  phase,
  deviation,
  coherence,
  time
};

/// What the numbers are of, see response_comments.hpp.
enum class TableGroup { response, beside_axis, noise, input_factor };

/// What a column of a table holds: its part of a response, and the name that is left of its title.
struct TableColumn {
  TableGroup group{};
  TablePart part{};
  std::string name{};
  std::string unit{};
  unsigned column{};  ///< of its title in the line
  bool circular{};    ///< frequencies called omega: in rad/s, unless their unit says otherwise
};

/// A title of any program.
TableColumn table_column(const base::TableCell& title);
/// A title as response_table() writes it, whose names may hold anything.
TableColumn own_column(const base::TableCell& title);

struct PairColumns {
  TableGroup group{};
  std::string name{};
  std::size_t first{}, second{};  ///< real and imaginary part, or magnitude and phase
  std::optional<std::size_t> deviation{};
  bool polar{};
};

/// Without blanks, marks and brackets around.
std::string bare_name(std::string_view text);

/// The columns that are one response each, in the order of their first ones.
std::vector<PairColumns> pairs_of(const std::vector<TableColumn>& columns);

}  // namespace hydrapod::data
