#include "target_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "target_tables.hpp"

namespace hydrapod::calibration {

namespace {

using base::two_pi;

struct Cell {
  std::string text{};
  unsigned column{};  ///< in the line, from 1
};

struct Title {
  std::string name{};
  std::string unit{};
};

/// Without quotes and blanks around it.
std::string unquoted(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

/// Where the cell that begins at `begin` ends; separators within quotes belong to it.
std::size_t cell_end(const std::string& line, std::size_t begin, char separator) {
  const auto open = line.find_first_not_of(" \t", begin);
  if (open == std::string::npos || line[open] != '"')
    return std::min(line.find(separator, begin), line.size());
  const auto close = line.find('"', open + 1);
  return close == std::string::npos ? line.size()
                                    : std::min(line.find(separator, close), line.size());
}

std::vector<Cell> cells_of(const std::string& line, char separator) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const auto end = cell_end(line, begin, separator);
    cells.push_back({unquoted(line.substr(begin, end - begin)), static_cast<unsigned>(begin) + 1});
    begin = end + 1;
  }
  return cells;
}

/// "frequency [Hz]" in its two parts.
Title title_of(const std::string& text) {
  const auto open = text.find('[');
  if (open == std::string::npos) return {text, ""};
  return {unquoted(text.substr(0, open)),
          unquoted(text.substr(open + 1, text.find(']') - open - 1))};
}

class CsvReader {
 public:
  explicit CsvReader(std::string file) : file_(std::move(file)) {}

  Targets read(const std::string& text) {
    if (base::first_invalid_utf8(text) != std::string::npos) {
      fault(0, "", "not UTF-8 text");
      throw base::InputError(faults_);
    }
    Targets targets;
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // spreadsheets begin with it
    std::istringstream lines(
        text.substr(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0));
    std::string line;
    while (std::getline(lines, line)) {
      ++line_;
      if (unquoted(line).empty() || unquoted(line)[0] == '#') continue;
      if (titles_.empty()) {
        read_titles(line);
      } else {
        read_row(line, targets);
      }
      if (faults_.size() > most_faults) break;
    }
    line_ = 0;  // what follows is about the file as a whole
    if (titles_.empty()) {
      fault(0, "", "is empty, expected a title row such as `frequency [Hz],direction`");
    } else if (targets.modes.empty() && faults_.empty()) {
      fault(0, "", "there is no mode below the title row");
    }
    if (!faults_.empty()) throw base::InputError(faults_);
    targets.deviations_given = deviations_given_;
    return targets;
  }

 private:
  static constexpr std::size_t most_faults = 50;

  void fault(unsigned column, const std::string& key, std::string message) {
    faults_.push_back(
        {base::Severity::error, file_, line_, line_ == 0 ? 0 : column, key, std::move(message)});
  }

  bool has(std::string_view name) const {
    return std::any_of(titles_.begin(), titles_.end(),
                       [&](const Title& t) { return t.name == name; });
  }

  bool has_twice(std::string_view name) const {
    return std::count_if(titles_.begin(), titles_.end(),
                         [&](const Title& t) { return t.name == name; }) > 1;
  }

  void read_titles(const std::string& line) {
    separator_ = line.find(';') != std::string::npos    ? ';'
                 : line.find('\t') != std::string::npos ? '\t'
                                                        : ',';
    static constexpr std::array<std::string_view, 8> words{
        "frequency", "direction", "deviation",         "damping",
        "pose",      "name",      "damping_deviation", "shape_against"};
    for (const auto& cell : cells_of(line, separator_)) {
      titles_.push_back(title_of(cell.text));
      const auto& name = titles_.back().name;
      if (has_twice(name)) fault(cell.column, name, "this column is there twice");
      const bool known =
          std::find(words.begin(), words.end(), name) != words.end() || direction_index(name) >= 0;
      if (!known) {
        const auto meant = base::nearest(name, words);
        fault(cell.column, base::printable(name),
              meant ? fmt::format("unknown column; did you mean `{}`?", *meant)
                    : fmt::format("unknown column; known are {} and a shape's {}",
                                  fmt::join(words, ", "), fmt::join(direction_names, ", ")));
      }
    }
    if (!has("frequency") && faults_.empty())
      fault(1, "frequency", "the title row has no column `frequency [Hz]`");
  }

  /// The cells of a row, decimal commas made points where commas do not separate cells.
  std::vector<Cell> row_of(const std::string& line) const {
    auto cells = cells_of(line, separator_);
    for (auto& cell : cells) {
      const auto comma = cell.text.find(',');
      const bool decimal = separator_ != ',' && comma != std::string::npos && comma > 0 &&
                           std::isdigit(static_cast<unsigned char>(cell.text[comma - 1])) != 0 &&
                           cell.text.find_first_of(",.", comma + 1) == std::string::npos;
      const bool word = cell.text.find_first_not_of("0123456789,+-eE %") != std::string::npos;
      if (decimal && !word) cell.text[comma] = '.';
    }
    return cells;
  }

  /// A cell as a number in `unit`: with a unit of its own, in that of its column, or plain.
  double number(const Cell& cell, const Title& title, const std::string& unit) {
    double plain = 0.0;
    const char* end = cell.text.data() + cell.text.size();
    const auto [stop, status] = std::from_chars(cell.text.data(), end, plain);
    const bool is_plain = status == std::errc{} && stop == end;
    if (is_plain && !std::isfinite(plain)) {
      fault(cell.column, title.name, fmt::format("is {}, expected a finite number", cell.text));
      return std::nan("");
    }
    if (is_plain && title.unit.empty()) return plain;
    const auto read =
        base::read_quantity(is_plain ? cell.text + " " + title.unit : cell.text, unit);
    if (read.ok()) return read.value;
    fault(cell.column, title.name, read.problem);
    return std::nan("");
  }

  double frequency(const Cell& cell, const Title& title) {
    const bool plain =
        std::isdigit(static_cast<unsigned char>(cell.text.back())) != 0 || cell.text.back() == '.';
    const auto read =
        read_frequency(plain ? cell.text + " " + title.unit : cell.text, false, 0.0, "");
    if (read.problem.empty() && read.omega > 0.0) return read.omega;
    fault(
        cell.column, title.name,
        title.unit.empty() && plain
            ? fmt::format("is {} without a unit; title the column `{} [Hz]`", cell.text, title.name)
        : read.problem.empty() ? "expected a frequency above 0"
                               : read.problem);
    return std::nan("");
  }

  void read_row(const std::string& line, Targets& targets) {
    const auto cells = row_of(line);
    if (std::all_of(cells.begin(), cells.end(), [](const Cell& c) { return c.text.empty(); }))
      return;  // what spreadsheets leave below a table
    if (cells.size() != titles_.size()) {
      fault(1, "",
            fmt::format("has {} cells, expected {} as in the title row", cells.size(),
                        titles_.size()));
      return;
    }
    ModeTarget mode;
    Vector6 shape = Vector6::Zero();
    bool has_shape = false;
    std::optional<double> deviation;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto& [name, unit] = titles_[i];
      const auto& cell = cells[i];
      if (cell.text.empty()) continue;
      if (name == "frequency") mode.omega = frequency(cell, titles_[i]);
      if (name == "direction") mode.direction = direction(cell);
      if (name == "deviation") deviation = deviation_of(cell, titles_[i]);
      if (name == "damping") mode.damping = number(cell, titles_[i], "1");
      if (name == "damping_deviation") mode.damping_deviation = damping_deviation(cell, titles_[i]);
      if (name == "shape_against") mode.shape_against = shape_against(cell);
      if (name == "pose") mode.pose = cell.text;
      if (name == "name") mode.name = cell.text;
      if (const int k = direction_index(name); k >= 0) {
        shape[k] = number(cell, titles_[i], k < 3 ? "m" : "rad");
        has_shape = true;
      }
    }
    finish(mode, deviation, has_shape ? &shape : nullptr, targets);
  }

  std::optional<int> direction(const Cell& cell) {
    const int index = direction_index(cell.text);
    if (index >= 0) return index;
    fault(cell.column, "direction",
          fmt::format("is \"{}\", expected one of {}", base::printable(cell.text),
                      fmt::join(direction_names, ", ")));
    return {};
  }

  MotionAgainst shape_against(const Cell& cell) {
    for (const auto against : {MotionAgainst::ground, MotionAgainst::base})
      if (cell.text == observation::name(against)) return against;
    fault(cell.column, "shape_against",
          fmt::format("is \"{}\", expected ground or base", base::printable(cell.text)));
    return {};
  }

  double damping_deviation(const Cell& cell, const Title& title) {
    const double value = number(cell, title, "1");
    if (value > 0.0 || std::isnan(value)) return value;
    fault(cell.column, title.name, "expected more than 0");
    return std::nan("");
  }

  /// Below zero: a share of the frequency, minus it.
  double deviation_of(const Cell& cell, const Title& title) {
    const bool share = title.unit == "%" || cell.text.ends_with('%') || title.unit == "1";
    const double value = share ? number(cell, title, "1") : frequency(cell, title);
    if (value > 0.0) return share ? -value : value;
    if (value <= 0.0) fault(cell.column, "deviation", "expected more than 0");
    return std::nan("");
  }

  void finish(ModeTarget& mode, const std::optional<double>& deviation, const Vector6* shape,
              Targets& targets) {
    if (mode.omega == 0.0) return fault(1, "frequency", "is missing in this row");
    deviations_given_ = deviations_given_ || deviation;
    mode.deviation = !deviation         ? default_deviation * mode.omega
                     : *deviation < 0.0 ? -*deviation * mode.omega
                                        : *deviation;
    if (mode.damping && mode.damping_deviation == 0.0)
      mode.damping_deviation = std::max(0.1 * *mode.damping, 1e-4);
    if (shape != nullptr && !shape->isZero(0.0)) {
      mode.shape = *shape;
      mode.shape_deviation = 0.05;
    }
    if (mode.name.empty()) mode.name = fmt::format("{:g} Hz", mode.omega / two_pi);
    for (const auto& [key, message] : target_faults(mode)) fault(1, key, message);
    targets.modes.push_back(mode);
  }

  std::string file_;
  unsigned line_{};
  char separator_{','};
  std::vector<Title> titles_{};
  bool deviations_given_{};
  std::vector<base::Diagnostic> faults_{};
};

}  // namespace

Targets parse_target_csv(const std::string& text, const std::string& file) {
  return CsvReader(file).read(text);
}

}  // namespace hydrapod::calibration
