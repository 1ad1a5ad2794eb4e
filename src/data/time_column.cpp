#include "time_column.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "channel_units.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::data {

namespace {

using base::TableTitle;

bool is_time_name(const std::string& name) {
  constexpr std::array<std::string_view, 12> words{
      "time",         "t",           "zeit",      "temps",   "tiempo",  "timestamp", "time stamp",
      "elapsed time", "zeitstempel", "rel. time", "seconds", "sekunden"};
  return std::ranges::find(words, base::lower_case(name)) != words.end();
}

/// The factor of a unit of time to seconds, if it is one.
std::optional<double> seconds(const std::string& unit) {
  const ChannelUnit found = channel_unit(unit);
  if (found.unit != "s") return {};
  return found.factor;
}

/// To many programs "time_s" is what "time [s]" is to others.
TableTitle with_unit_of_time(const TableTitle& title) {
  const auto at = title.name.rfind('_');
  if (!title.unit.empty() || at == std::string::npos) return title;
  TableTitle apart{.name = title.name.substr(0, at), .unit = title.name.substr(at + 1)};
  return is_time_name(apart.name) && seconds(apart.unit) ? apart : title;
}

}  // namespace

std::optional<TimeColumn> named_time(const TableTitle& title) {
  const TableTitle apart = with_unit_of_time(title);
  const auto factor = apart.unit.empty() ? std::optional(1.0) : seconds(apart.unit);
  if (!factor || !is_time_name(apart.name)) return {};
  return TimeColumn{.factor = *factor, .has_unit = !apart.unit.empty()};
}

std::optional<TimeColumn> find_time_column(const std::vector<TableTitle>& titles) {
  for (std::size_t c = 0; c < titles.size(); ++c) {
    if (auto found = named_time(titles[c])) {
      found->column = c;
      return found;
    }
    if (c > 0 || titles[c].unit.empty()) continue;
    if (const auto factor = seconds(titles[c].unit)) return TimeColumn{0, *factor, true};
  }
  return {};
}

}  // namespace hydrapod::data
