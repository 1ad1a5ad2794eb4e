#pragma once
/// Which column of a table holds the times of the rows, by its title.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/base/file.hpp"

namespace hydrapod::data {

struct TimeColumn {
  std::size_t column{};
  double factor{1.0};  ///< to seconds
  bool has_unit{};     ///< stated by the title, else seconds are assumed
};

/// A column with the name of times, in a unit of time or without one, or else the first column
/// where it is in a unit of time; the first that there is.
std::optional<TimeColumn> find_time_column(const std::vector<base::TableTitle>& titles);

/// The same of one title, by its name alone.
std::optional<TimeColumn> named_time(const base::TableTitle& title);

}  // namespace hydrapod::data
