/// Trajectories: the signal and its file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/signals/signals.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

/// Names of the columns: time, then the directions.
constexpr std::array<std::string_view, 7> column_names = [] {
  std::array<std::string_view, 7> names{"time"};
  std::ranges::copy(spatial::direction_names, names.begin() + 1);
  return names;
}();
constexpr std::size_t most_faults = 20;
constexpr std::size_t most_points = 1'000'000;  // 56 MB

/// What a column holds: its place in column_names and the factor of its unit to SI.
struct Column {
  std::size_t quantity{};
  double factor{1.0};
};

class TrajectoryReader {
 public:
  TrajectoryReader(base::TableReader table, const Units& units)
      : table_(std::move(table)), units_(units) {}

  Trajectory read() {
    read_titles();
    std::vector<base::TableCell> cells;
    while (!columns_.empty() && faults_.size() < most_faults && table_.row(cells)) read_row(cells);
    if (faults_.empty() && trajectory_.times.empty())
      fault(0, "holds no point, expected rows of numbers below the header");
    if (!faults_.empty()) throw base::InputError(faults_);
    return std::move(trajectory_);
  }

 private:
  void fault(unsigned column, std::string message) {
    faults_.push_back(table_.fault(column, "", std::move(message)));
  }

  void read_titles() {
    const auto titles = table_.titles();
    if (titles.empty())
      return fault(0, "holds no header, expected a line such as \"time [s], x [mm], rz [deg]\"");
    std::array<bool, column_names.size()> seen{};
    std::vector<Column> columns;
    for (const auto& title : titles) {
      const auto at = std::ranges::find(column_names,
                                        title.name == "t" ? std::string_view("time") : title.name);
      if (at == column_names.end()) {
        unknown(title);
        continue;
      }
      columns.push_back({.quantity = static_cast<std::size_t>(at - column_names.begin())});
      auto& column = columns.back();
      if (std::exchange(seen[column.quantity], true))
        fault(title.column, fmt::format("{} is given twice", *at));
      if (title.unit.empty()) continue;
      const auto read =
          base::read_quantity(fmt::format("1 {}", title.unit),
                              column.quantity == 0 ? "s" : units_[column.quantity - 1]);
      if (!read.ok()) fault(title.unit_column, fmt::format("unit of {}: {}", *at, read.problem));
      column.factor = read.value;
    }
    if (!faults_.empty()) return;
    if (!seen[0]) fault(1, "no column `time`, expected a header such as \"time [s], x [mm]\"");
    if (columns.size() < 2)
      fault(1, "no motion column, expected at least one of x, y, z, rx, ry, rz");
    if (faults_.empty()) columns_ = std::move(columns);
  }

  void unknown(const base::TableTitle& title) {
    const auto near = base::nearest(title.name, column_names);
    fault(title.column,
          fmt::format("unknown column '{}'; {}", base::printable(title.name),
                      near ? fmt::format("did you mean '{}'?", *near)
                           : fmt::format("known are {}", fmt::join(column_names, ", "))));
  }

  void read_row(const std::vector<base::TableCell>& cells) {
    if (cells.size() != columns_.size())
      return fault(cells.back().column, fmt::format("{} values, expected {} as in the header",
                                                    cells.size(), columns_.size()));
    std::array<double, column_names.size()> row{};
    unsigned time_column = 1;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto& [quantity, factor] = columns_[i];
      const auto value = base::table_number(cells[i].text, table_.style.decimal_comma);
      if (!value || !std::isfinite(*value))
        return fault(cells[i].column,
                     fmt::format("{} is '{}', expected a finite number", column_names[quantity],
                                 base::printable(cells[i].text)));
      row[quantity] = *value * factor;
      if (quantity == 0) time_column = cells[i].column;
    }
    auto& times = trajectory_.times;
    if (!times.empty() && row[0] <= times.back())
      return fault(time_column,
                   fmt::format("time is {:.9g} s after {:.9g} s, expected times that ascend",
                               row[0], times.back()));
    if (times.size() == most_points)
      throw base::InputError({table_.fault(
          1, "", fmt::format("holds more than {} points, expected at most so many", most_points))});
    times.push_back(row[0]);
    trajectory_.points.emplace_back(Vector6::Map(row.data() + 1));
  }

  base::TableReader table_;
  Units units_;
  std::vector<Column> columns_{};
  Trajectory trajectory_{};
  std::vector<base::Diagnostic> faults_{};
};

}  // namespace

Trajectory parse_trajectory(const std::string& text, const std::string& file, const Units& units) {
  return TrajectoryReader(base::TableReader(text, file), units).read();
}

Trajectory read_trajectory(const std::string& path, const Units& units) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw base::InputError(
        {{.file = path, .message = "is a directory, expected a CSV file with a trajectory"}});
  auto trajectory = TrajectoryReader(base::TableReader(path), units).read();
  trajectory.source = path;
  return trajectory;
}

Source make_source(const Trajectory& given, const Context& context) {
  // shared: sources are copied, and a trajectory may be long
  const auto trajectory = std::make_shared<const Trajectory>(given);
  const auto slope = [trajectory](std::size_t k) -> Vector6 {
    const auto& [times, points, source] = *trajectory;
    if (k == 0 || k + 1 == times.size()) return Vector6::Zero();  // at rest before and after
    const double before = times[k] - times[k - 1], after = times[k + 1] - times[k];
    return (after / before * (points[k] - points[k - 1]) +
            before / after * (points[k + 1] - points[k])) /
           (before + after);
  };
  return [trajectory, slope, rate = context.rate](long sample) -> Sample {
    const auto& [times, points, source] = *trajectory;
    const double time = static_cast<double>(sample) / rate;
    if (time <= times.front()) return {points.front(), Vector6::Zero()};
    if (time >= times.back()) return {points.back(), Vector6::Zero()};
    const auto k = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) -
                                            times.begin()) -
                   1;
    const double h = times[k + 1] - times[k];
    const double r = (time - times[k]) / h;
    const Vector6 rise = points[k + 1] - points[k];
    const Vector6 m_0 = h * slope(k), m_1 = h * slope(k + 1);
    const Vector6 b = 3.0 * rise - 2.0 * m_0 - m_1, c = m_0 + m_1 - 2.0 * rise;
    return {points[k] + r * (m_0 + r * (b + r * c)), (m_0 + r * (2.0 * b + 3.0 * r * c)) / h};
  };
}

}  // namespace hydrapod::signals
