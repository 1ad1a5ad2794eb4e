#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/nearest.hpp"
#include "hydrapod/base/printable.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/simulation/command_text.hpp"

namespace hydrapod::simulation {

namespace {

constexpr std::array<std::string_view, 7> column_names{"time", "x", "y", "z", "rx", "ry", "rz"};
constexpr std::size_t most_faults = 20;

struct Cell {
  std::string_view text{};
  unsigned column{};  ///< of its first character, from 1
};

Cell trimmed(std::string_view line, std::size_t begin, std::size_t end) {
  while (begin < end && (line[begin] == ' ' || line[begin] == '\t')) ++begin;
  while (end > begin && (line[end - 1] == ' ' || line[end - 1] == '\t')) --end;
  return {line.substr(begin, end - begin), static_cast<unsigned>(begin) + 1};
}

std::vector<Cell> cells(std::string_view line, char separator) {
  std::vector<Cell> found;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    found.push_back(trimmed(line, begin, end));
    begin = end + 1;
  }
  return found;
}

/// What a column holds: its place in column_names and the factor of its unit to SI.
struct Column {
  std::size_t quantity{};
  double factor{1.0};
};

class TrajectoryParser {
 public:
  explicit TrajectoryParser(std::string file) : file_(std::move(file)) {}

  Trajectory parse(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line) && faults_.size() < most_faults;) {
      ++line_;
      if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      const auto first = line.find_first_not_of(" \t");
      if (first == std::string::npos || line[first] == '#') continue;
      if (columns_.empty()) {
        read_header(line);
        if (!faults_.empty()) break;
      } else {
        read_row(line);
      }
    }
    if (faults_.empty() && columns_.empty())
      add(0, "holds no header, expected a line such as \"time [s], x [mm], rz [deg]\"");
    else if (faults_.empty() && trajectory_.times.empty())
      add(0, "holds no point, expected rows of numbers below the header");
    if (!faults_.empty()) throw base::InputError(faults_);
    trajectory_.source = file_;
    return std::move(trajectory_);
  }

 private:
  void add(unsigned column, std::string message) {
    faults_.push_back({.file = file_,
                       .line = column > 0 ? line_ : 0,
                       .column = column,
                       .message = std::move(message)});
  }

  void read_header(std::string_view line) {
    separator_ = line.find(';') != std::string_view::npos    ? ';'
                 : line.find(',') != std::string_view::npos  ? ','
                 : line.find('\t') != std::string_view::npos ? '\t'
                                                             : ',';
    std::array<bool, column_names.size()> seen{};
    for (const Cell& cell : cells(line, separator_)) {
      const auto column = read_column(cell);
      if (column && seen[column->quantity])
        add(cell.column, fmt::format("{} is there twice", column_names[column->quantity]));
      if (column) seen[column->quantity] = true;
      columns_.push_back(column.value_or(Column{}));
    }
    if (!faults_.empty()) return;
    if (!seen[0]) add(1, "no column `time`, expected a header such as \"time [s], x [mm]\"");
    if (columns_.size() < 2)
      add(1, "no column that moves, expected at least one of x, y, z, rx, ry, rz");
  }

  /// `rz [deg]`, `rz (deg)` or `rz`.
  std::optional<Column> read_column(const Cell& cell) {
    const auto bracket = cell.text.find_first_of("[(");
    const Cell name = trimmed(cell.text, 0, std::min(bracket, cell.text.size()));
    const auto at = std::find(column_names.begin(), column_names.end(),
                              name.text == "t" ? std::string_view("time") : name.text);
    if (at == column_names.end()) {
      const auto near = base::nearest(name.text, column_names);
      add(cell.column,
          fmt::format("unknown column '{}'; {}", base::printable(name.text),
                      near && near->size() > 2
                          ? fmt::format("did you mean '{}'?", *near)
                          : fmt::format("known are {}", fmt::join(column_names, ", "))));
      return std::nullopt;
    }
    Column column{static_cast<std::size_t>(at - column_names.begin())};
    if (bracket == std::string_view::npos) return column;
    const char closing = cell.text[bracket] == '[' ? ']' : ')';
    const auto end = cell.text.find(closing, bracket);
    if (end == std::string_view::npos) {
      add(cell.column, fmt::format("'{}' lacks a '{}'", base::printable(cell.text), closing));
      return std::nullopt;
    }
    const Cell unit = trimmed(cell.text, bracket + 1, end);
    const char* expected = column.quantity == 0 ? "s" : column.quantity < 4 ? "m" : "rad";
    const auto read = base::read_quantity(fmt::format("1 {}", unit.text), expected);
    if (!read.ok()) {
      add(cell.column + static_cast<unsigned>(bracket) + 1,
          fmt::format("unit of {}: {}", *at, read.problem));
      return std::nullopt;
    }
    column.factor = read.value;
    return column;
  }

  std::optional<double> read_number(const Cell& cell, const Column& column) {
    double value = 0.0;
    const auto* begin = cell.text.data();
    const auto* end = begin + cell.text.size();
    if (begin != end && *begin == '+') ++begin;
    const auto [stop, status] = std::from_chars(begin, end, value);
    if (cell.text.empty() || status != std::errc{} || stop != end || !std::isfinite(value)) {
      add(cell.column, fmt::format("{} is '{}', expected a finite number",
                                   column_names[column.quantity], base::printable(cell.text)));
      return std::nullopt;
    }
    return value * column.factor;
  }

  void read_row(std::string_view line) {
    const auto row = cells(line, separator_);
    if (row.size() != columns_.size())
      return add(row.back().column, fmt::format("{} values, expected {} as in the header",
                                                row.size(), columns_.size()));
    double time = 0.0;
    unsigned time_column = 1;
    Vector6 point = Vector6::Zero();
    for (std::size_t i = 0; i < row.size(); ++i) {
      const auto value = read_number(row[i], columns_[i]);
      if (!value) return;
      if (columns_[i].quantity == 0) {
        time = *value;
        time_column = row[i].column;
      } else {
        point[static_cast<int>(columns_[i].quantity) - 1] = *value;
      }
    }
    if (!trajectory_.times.empty() && time <= trajectory_.times.back())
      return add(time_column, fmt::format("time is {:.9g} s after {:.9g} s, expected times that "
                                          "ascend",
                                          time, trajectory_.times.back()));
    trajectory_.times.push_back(time);
    trajectory_.points.push_back(point);
  }

  std::string file_;
  unsigned line_{};
  char separator_{','};
  std::vector<Column> columns_{};
  Trajectory trajectory_{};
  std::vector<base::Diagnostic> faults_{};
};

}  // namespace

Trajectory parse_trajectory(const std::string& text, const std::string& file) {
  return TrajectoryParser(file).parse(text);
}

Trajectory read_trajectory(const std::string& path) {
  constexpr std::uintmax_t largest = std::uintmax_t{1} << 29;
  const auto reject = [&](std::string message) {
    throw base::InputError({{.file = path, .message = std::move(message)}});
  };
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    reject("is a directory, expected a CSV file with a trajectory");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) reject(fmt::format("cannot be opened: {}", std::generic_category().message(errno)));
  const auto size = std::filesystem::file_size(path, error);
  if (!error && size > largest) reject("is larger than 512 MiB");
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_trajectory(text.str(), path);
}

}  // namespace hydrapod::simulation
