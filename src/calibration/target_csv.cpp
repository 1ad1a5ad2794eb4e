#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "target_tables.hpp"

namespace hydrapod::calibration {

namespace {

using base::TableCell;
using base::TableTitle;
using base::two_pi;

class CsvReader {
 public:
  CsvReader(const std::string& text, const std::string& file, const std::vector<std::string>& poses)
      : poses_(poses), table_(text, file) {
    if (base::is_utf16(text) || base::first_invalid_utf8(text) != std::string::npos) {
      fault(0, "", std::string(base::is_utf16(text) ? base::utf16_refused : "not UTF-8 text"));
      throw base::InputError(faults_);
    }
  }

  Targets read() {
    targets_.deviations_given = false;
    read_titles();
    std::vector<TableCell> cells;
    while (faults_.size() <= most_faults && !titles_.empty() && table_.row(cells)) read_row(cells);
    if (titles_.empty()) {
      fault(0, "", "is empty, expected a title row such as `frequency [Hz],direction`");
    } else if (targets_.modes.empty() && faults_.empty()) {
      fault(0, "", "there is no mode below the title row");
    }
    if (!faults_.empty()) throw base::InputError(faults_);
    return std::move(targets_);
  }

 private:
  static constexpr std::size_t most_faults = 50;
  inline static const std::string rad_per_s = "rad/s";  ///< ω has no other unit

  /// At `column` of the line that was read last; 0: about the file as a whole.
  void fault(unsigned column, const std::string& key, std::string message) {
    faults_.push_back(table_.fault(column, key, std::move(message)));
  }

  void read_titles() {
    static constexpr std::array<std::string_view, 10> words{
        "frequency", "omega", "direction", "deviation",         "damping",
        "pose",      "name",  "amplitude", "damping_deviation", "shape_against"};
    titles_ = table_.titles();
    const auto there = [&](std::string_view name) {
      return std::ranges::count(titles_, name, &TableTitle::name) > 0;
    };
    if (there("omega_rad_s") && there("frequency_hz"))
      throw base::InputError({table_.fault(
          1, "",
          "is a table of `hydrapod modes`, which has neither shapes nor a pose; give the JSON of "
          "the same command (-o modes.json)")});
    std::vector<std::string_view> seen;
    for (const auto& [name, unit, column, unit_column] : titles_) {
      if (std::ranges::count(seen, name) > 0) fault(column, name, "this column is there twice");
      seen.push_back(name);
      if (std::ranges::count(words, name) > 0 || direction_index(name) >= 0) continue;
      const auto meant = base::nearest(name, words);
      fault(column, base::printable(name),
            meant ? fmt::format("unknown column; did you mean `{}`?", *meant)
                  : fmt::format("unknown column; known are {} and a shape's {}",
                                fmt::join(words, ", "), fmt::join(direction_names, ", ")));
    }
    if (titles_.empty() || !faults_.empty()) return;
    if (!there("frequency") && !there("omega"))
      fault(1, "frequency", "the title row has no column `frequency [Hz]`");
    if (there("frequency") && there("omega"))
      fault(1, "omega", "there is a column `frequency` too; give one of the two");
  }

  /// The text of a number or quantity with a decimal point.
  std::string with_point(const TableCell& cell) const {
    return table_.style.decimal_comma ? base::with_decimal_point(cell.text) : cell.text;
  }

  /// A cell as a number in `unit`: with a unit of its own, in that of its column, or plain.
  double number(const TableCell& cell, const TableTitle& title, const std::string& unit) {
    const std::string text = with_point(cell);
    const auto plain = base::table_number(text, false);
    if (plain && !std::isfinite(*plain)) {
      fault(cell.column, title.name, fmt::format("is {}, expected a finite number", text));
      return std::nan("");
    }
    if (plain && title.unit.empty()) return *plain;
    const auto read = base::read_quantity(plain ? text + " " + title.unit : text, unit);
    if (!read.ok()) fault(cell.column, title.name, read.problem);
    return read.value;
  }

  double frequency(const TableCell& cell, const TableTitle& title) {
    const std::string text = with_point(cell);
    const bool plain =
        std::isdigit(static_cast<unsigned char>(text.back())) != 0 || text.back() == '.';
    const auto& unit = title.unit.empty() && title.name == "omega" ? rad_per_s : title.unit;
    if (plain && unit.empty()) {  // of the column, not of the cell: said once
      if (unit_missed_.insert(title.name).second)
        fault(cell.column, title.name,
              fmt::format("is {} without a unit; title the column `{} [Hz]`", text, title.name));
      return std::nan("");
    }
    const auto read = read_frequency(plain ? text + " " + unit : text, false, 0.0, "");
    if (read.problem.empty() && read.omega > 0.0) return read.omega;
    fault(cell.column, title.name,
          read.problem.empty()
              ? fmt::format("is {}, expected a frequency above 0", base::printable(cell.text))
              : read.problem);
    return std::nan("");
  }

  void read_row(const std::vector<TableCell>& cells) {
    if (cells.size() != titles_.size())
      return fault(1, "",
                   fmt::format("has {} cell{}, expected {} as in the title row", cells.size(),
                               cells.size() == 1 ? "" : "s", titles_.size()));
    ModeTarget mode{.damped = true};
    Vector6 shape = Vector6::Zero();
    std::optional<double> deviation;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto& title = titles_[i];
      const auto& name = title.name;
      const auto& cell = cells[i];
      if (cell.text.empty()) continue;
      if (name == "frequency" || name == "omega") mode.omega = frequency(cell, title);
      if (name == "direction") mode.direction = direction(cell);
      if (name == "deviation") deviation = deviation_of(cell, title);
      if (name == "amplitude") mode.amplitude = number(cell, title, "m");
      if (name == "damping") mode.damping = damping(cell, title);
      if (name == "damping_deviation") mode.damping_deviation = damping_deviation(cell, title);
      if (name == "shape_against") mode.shape_against = shape_against(cell);
      if (name == "pose") {
        mode.pose = cell.text;
        const auto problem = pose_fault(cell.text, poses_);
        if (!problem.empty()) fault(cell.column, "pose", problem);
      }
      if (name == "name") mode.name = cell.text;
      if (const int k = direction_index(name); k >= 0)
        shape[k] = number(cell, title, k < 3 ? "m" : "rad");
    }
    finish(mode, deviation, shape);
  }

  /// A column without a unit in which a number is 1 or more is in %: said once.
  std::optional<double> damping(const TableCell& cell, const TableTitle& title) {
    const double value = number(cell, title, "1");
    if (!(value >= 1.0) || !title.unit.empty() || cell.text.ends_with('%')) return value;
    if (!std::exchange(percent_missed_, true))
      fault(cell.column, title.name,
            fmt::format("is {}, expected a damping ratio of at least 0 and below 1; title the "
                        "column `damping [%]` where it is in percent",
                        base::printable(cell.text)));
    return std::nullopt;
  }

  std::optional<int> direction(const TableCell& cell) {
    const int index = direction_index(cell.text);
    if (index >= 0) return index;
    fault(cell.column, "direction",
          fmt::format("is \"{}\", expected one of {}", base::printable(cell.text),
                      fmt::join(direction_names, ", ")));
    return {};
  }

  MotionAgainst shape_against(const TableCell& cell) {
    for (const auto against : {MotionAgainst::ground, MotionAgainst::base})
      if (cell.text == observation::name(against)) return against;
    fault(cell.column, "shape_against",
          fmt::format("is \"{}\", expected ground or base", base::printable(cell.text)));
    return {};
  }

  double damping_deviation(const TableCell& cell, const TableTitle& title) {
    const double value = number(cell, title, "1");
    if (value > 0.0 || std::isnan(value)) return value;
    fault(cell.column, title.name,
          fmt::format("is {}, expected more than 0", base::printable(cell.text)));
    return std::nan("");
  }

  /// Below zero: a share of the frequency, minus it.
  double deviation_of(const TableCell& cell, const TableTitle& title) {
    const bool share = title.unit == "%" || cell.text.ends_with('%') || title.unit == "1";
    const double value = share ? number(cell, title, "1") : frequency(cell, title);
    if (value > 0.0) return share ? -value : value;
    if (value <= 0.0)
      fault(cell.column, "deviation",
            fmt::format("is {}, expected more than 0", base::printable(cell.text)));
    return std::nan("");
  }

  void finish(ModeTarget& mode, const std::optional<double>& deviation, const Vector6& shape) {
    if (mode.omega == 0.0) return fault(1, "frequency", "is missing in this row");
    targets_.deviations_given = targets_.deviations_given || deviation;
    mode.deviation = !deviation         ? default_deviation * mode.omega
                     : *deviation < 0.0 ? -*deviation * mode.omega
                                        : *deviation;
    if (mode.damping && mode.damping_deviation == 0.0)
      mode.damping_deviation = std::max(0.1 * *mode.damping, 1e-4);
    if (!shape.isZero(0.0)) {
      mode.shape = shape;
      mode.shape_deviation = 0.05;
    }
    if (mode.name.empty()) mode.name = fmt::format("{:g} Hz", mode.omega / two_pi);
    for (const auto& [key, message] : target_faults(mode)) fault(1, key, message);
    targets_.modes.push_back(mode);
  }

  const std::vector<std::string>& poses_;
  base::TableReader table_;
  std::vector<TableTitle> titles_{};
  Targets targets_{};
  std::set<std::string> unit_missed_{};  ///< columns
  bool percent_missed_{};
  std::vector<base::Diagnostic> faults_{};
};

}  // namespace

Targets parse_target_csv(const std::string& text, const std::string& file,
                         const std::vector<std::string>& poses) {
  return CsvReader(text, file, poses).read();
}

}  // namespace hydrapod::calibration
