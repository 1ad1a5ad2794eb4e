#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "channel_roles.hpp"
#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "record_comments.hpp"
#include "table_head.hpp"
#include "time_column.hpp"
#include "time_grid.hpp"
#include "time_stamp.hpp"

namespace hydrapod::data {

namespace {

using base::TableStyle;
using base::TableTitle;

/// "5,054.94", "5.054,94", "1'005'054": digits in threes behind a mark, which is always the same
/// and not that of the decimals.
bool has_marks_of_thousands(std::string_view cell) {
  constexpr std::array<std::string_view, 7> marks{",", ".", "'", " ", "\u00a0", "\u202f", "\u2019"};
  const auto digits = [&] {
    const std::size_t count = std::min(cell.find_first_not_of("0123456789"), cell.size());
    cell.remove_prefix(count);
    return count;
  };
  if (cell.starts_with('-') || cell.starts_with('+')) cell.remove_prefix(1);
  if (const std::size_t first = digits(); first < 1 || first > 3) return false;
  const auto mark =
      std::ranges::find_if(marks, [&](std::string_view known) { return cell.starts_with(known); });
  if (mark == marks.end()) return false;
  while (cell.starts_with(*mark)) {
    cell.remove_prefix(mark->size());
    if (digits() != 3) return false;
  }
  if (cell.starts_with('.') || cell.starts_with(',')) {
    cell.remove_prefix(1);
    digits();
  }
  return cell.empty();
}

/// The cells that hold the times of the rows: numbers, or stamps of one cell or two (date, time).
class TimeCells {
 public:
  TimeCells(std::size_t column, double factor) : column_(column), factor_(factor) {}
  TimeCells(std::size_t column, bool date_apart)
      : column_(column), stamps_(true), date_apart_(date_apart) {}

  [[nodiscard]] bool has(std::size_t column) const {
    return column == column_ || (date_apart_ && column == column_ + 1);
  }
  [[nodiscard]] bool stamps() const { return stamps_; }

  /// Of a line, in seconds; since the first one where they are stamps. NaN: there is none.
  double time(std::string_view line, const TableStyle& style) {
    base::TableCells cells(line, style.separator);
    std::string_view cell;
    for (std::size_t c = 0; c <= column_; ++c)
      if (!cells.next(cell)) return missing;
    if (!stamps_) return number(cell, style.decimal_comma);
    std::string text(cell);
    if (date_apart_ && cells.next(cell)) text += 'T' + std::string(cell);
    const auto stamp = time_stamp(text);
    if (!stamp || !stamp->has_clock) return missing;
    if (!origin_) {
      origin_ = stamp->nanoseconds;
      if (stamp->has_date) date_ = date_of_stamp(text);
    }
    finest_ = std::max(finest_, stamp->decimals);
    constexpr double nanosecond = 1e-9;
    return nanosecond * static_cast<double>(stamp->nanoseconds - *origin_);
  }
  /// ISO 8601 of the first one; empty for times without a date.
  [[nodiscard]] const std::string& date() const { return date_; }

  /// The resolution of a time [s], by the digits of those that were read: the decimals of the
  /// finest, and the most digits that a time has.
  [[nodiscard]] double resolution(double time) const {
    if (finest_ == coarse) return 0.0;
    if (stamps_) return finest_ < 0 ? minute : std::pow(10.0, -finest_);
    const double written = std::abs(time) / factor_;
    constexpr int least_digits = 5;  // fewer are a matter of the values
    const double by_digits = written > 0.0 && digits_ >= least_digits
                                 ? std::pow(10.0, std::floor(std::log10(written)) + 1.0 - digits_)
                                 : 0.0;
    return factor_ * std::max(std::pow(10.0, -finest_), by_digits);
  }

 private:
  double number(std::string_view cell, bool decimal_comma) {
    const auto value = base::table_number(cell, decimal_comma);
    if (!value || !std::isfinite(*value)) return missing;
    const std::size_t end = std::min(cell.find_first_of("eE"), cell.size());
    int digits = 0, decimals = 0;
    bool behind = false;
    for (const char c : cell.substr(0, end)) {
      behind = behind || c == '.' || c == ',';
      if (c < '0' || c > '9') continue;
      if (c != '0' || digits > 0) ++digits;
      if (behind) ++decimals;
    }
    if (end < cell.size())
      if (const auto power = base::table_number(cell.substr(end + 1), false))
        decimals -= static_cast<int>(std::clamp(*power, -400.0, 400.0));
    finest_ = std::max(finest_, decimals);
    digits_ = std::max(digits_, digits);
    return *value * factor_;
  }

  static constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  static constexpr double minute = 60.0;
  static constexpr int coarse = std::numeric_limits<int>::min();

  std::size_t column_;
  double factor_{1.0};  ///< of numbers, to seconds
  bool stamps_{}, date_apart_{};
  std::optional<std::int64_t> origin_{};
  std::string date_{};
  int finest_{coarse}, digits_{};
};

class CsvReader final : public RecordReader {
 public:
  CsvReader(const std::string& path, const ReadOptions& options, bool damaged)
      : RecordReader(path), table_(path), damaged_(damaged) {
    format_ = RecordFormat::csv;
    read_header();
    settle_channels(by_hydrapod_);
    if (!by_hydrapod_) guess_roles(header_.channels, notes_);
    if (header_.sample_rate == 0.0) find_grid(options);
    if (header_.channels.empty()) notes_.fail("there is no column besides the times");
    to_first_sample();
    if (by_hydrapod_) begin_checksum();
  }

 private:
  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    std::int64_t rows = 0;
    if (grid_) {
      Eigen::RowVectorXd values(block.cols());
      for (; rows < block.rows() && grid_->next(fetch_, values); ++rows) block.row(rows) = values;
      return rows;
    }
    for (; rows < block.rows() && next_row(); ++rows) put_values(block.row(rows));
    return rows;
  }

  /// What next_row() has read, without the times.
  template <class Row>
  void put_values(Row&& row) const {
    Eigen::Index out = 0;
    for (std::size_t c = 0; c < columns_; ++c)
      if (!is_time(c)) row[out++] = row_[c];
  }

  [[nodiscard]] bool is_time(std::size_t column) const { return times_ && times_->has(column); }

  void to_first_sample() override {
    if (first_row_) table_.go_to(*first_row_);
    parsed_ = 0;
    end_noted_ = unreadable_ = false;
    if (grid_) grid_->rewind();
  }

  // what stands above the numbers

  void read_header() {
    RecordComments comments;
    const TableHead head = read_table_head(
        table_, notes_,
        [&](std::string_view line, unsigned number) { comments.take(line, number); });
    columns_ = head.columns;
    first_row_ = head.first_row;
    if (first_row_) find_stamps(head.first_line);
    by_hydrapod_ = comments.by_hydrapod(notes_);
    if (by_hydrapod_) {
      header_ = comments.header(notes_);
      stated_checksum_ = comments.text_of(checksum_name);  // here where there are no samples
      const std::size_t described = header_.channels.size();
      if (first_row_ && described > 0 && described + 1 != columns_)
        notes_.fail(
            fmt::format("{} channels are described, but the lines of numbers have a time and {}",
                        described, columns_ - 1),
            table_.line());
      times_.emplace(std::size_t{0}, 1.0);
      if (columns_ == 0) columns_ = described + 1;
      if (described > 0) return;
    }
    if (!first_row_)
      notes_.fail(
          "no line of numbers was found; expected is a table of samples, one line each, the "
          "fields apart by comma, semicolon, tabulator or blanks, times as numbers or as "
          "2026-11-20T09:00:00.125Z; a list of modes has a title row with `frequency [Hz]` or "
          "`omega [rad/s]`");
    if (!by_hydrapod_ && !comments.text_of("sample_rate_hz").empty()) notes_.add(damaged_mark);
    const auto found = titles(head);
    if (!times_) take_time_column(found);
    for (std::size_t c = 0; c < columns_; ++c)
      if (!is_time(c)) header_.channels.push_back({.name = found[c].name, .unit = found[c].unit});
  }

  /// Stamps tell by themselves that they are the times.
  void find_stamps(std::string_view line) {
    const auto cells = base::table_cells(line, table_.style.separator);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto stamp = time_stamp(cells[c].text);
      if (!stamp || base::table_number(cells[c].text, table_.style.decimal_comma)) continue;
      const auto next =
          stamp->has_clock || c + 1 == cells.size() ? std::nullopt : time_stamp(cells[c + 1].text);
      if (!stamp->has_clock && !(next && next->has_clock && !next->has_date)) continue;
      times_.emplace(c, !stamp->has_clock);
      return;
    }
  }

  std::vector<TableTitle> titles(const TableHead& head) {
    const TableNames names = table_names(head, table_.style.separator, is_time(1), notes_);
    std::vector<TableTitle> found;
    for (std::size_t c = 0; c < columns_; ++c) {
      found.push_back(base::table_title(names.titles[c]));
      if (!names.units.empty()) found.back().unit = names.units[c];
    }
    return found;
  }

  void take_time_column(const std::vector<TableTitle>& found) {
    if (columns_ < 2 && !by_hydrapod_) return;
    const auto times = find_time_column(found);
    if (!times) return;
    times_.emplace(times->column, times->factor);
    assumed_seconds_ = !times->has_unit;
  }

  // the numbers

  /// In a damaged file, what stands before a line that cannot be read is all there is.
  bool next_line(std::string_view& line, bool with_comments) {
    try {
      return !unreadable_ && table_.next_line(line, with_comments);
    } catch (const base::InputError& error) {
      if (!damaged_) throw;
      const base::Diagnostic& why = error.diagnostics().back();
      if (!std::exchange(unreadable_noted_, true))
        notes_.add(why.message + "; this line and what follows are left out", why.line);
      unreadable_ = true;
      return false;
    }
  }

  /// A number at the end of a file may be cut off too. It is known to be whole where hydrapod wrote
  /// the table, as it ends each line; in others the last line often has no end.
  [[nodiscard]] bool may_be_cut(bool all_cells) const {
    return !table_.line_was_ended() && (!all_cells || by_hydrapod_ || damaged_);
  }

  /// Of the line that was read last, which is a comment.
  void take_checksum(std::string_view line) {
    RecordComments comment;
    comment.take(line, table_.line());
    const std::string text = comment.text_of(checksum_name);
    const bool whole = table_.line_was_ended() || text.size() == std::strlen(no_checksum_yet);
    if (!text.empty() && whole) stated_checksum_ = text;
  }

  /// The next line of numbers in row_, and its time in time_.
  bool next_row() {
    std::string_view line;
    while (true) {
      if (!next_line(line, by_hydrapod_)) {
        if (by_hydrapod_ && stated_checksum_.empty() && !std::exchange(end_noted_, true))
          notes_.add(
              "the checksum at the end is missing: the file was cut off or not completed, or an "
              "early version of hydrapod wrote it");
        return false;
      }
      if (!base::is_table_comment(base::trimmed(line))) break;
      take_checksum(line);
    }
    row_.assign(columns_, std::numeric_limits<double>::quiet_NaN());
    std::size_t found = 0;
    base::TableCells cells(line, table_.style.separator);
    for (std::string_view cell; cells.next(cell); ++found) {
      if (found >= columns_ || (is_time(found) && times_->stamps())) continue;
      if (const auto value = base::table_number(cell, table_.style.decimal_comma))
        row_[found] = *value;
      else
        note_no_number(cell, cells.column());
    }
    if (may_be_cut(found == columns_)) {
      notes_.add(found == columns_ && !by_hydrapod_
                     ? "the last line has no end, and its last number may be cut off: the line is "
                       "left out"
                     : "the file is cut off within this line, which is left out",
                 table_.line());
      return false;
    }
    if (found != columns_)
      notes_.add(fmt::format("{} fields instead of {}; {}", found, columns_,
                             found < columns_ ? "absent ones are taken as missing samples"
                                              : "those beyond are left out"),
                 table_.line(), 0, found < columns_ ? "short" : "long");
    if (times_) time_ = times_->time(line, table_.style);
    if (!grid_)
      check_time();
    else if (std::isnan(time_))
      notes_.add("the time is missing; the row is taken for the next sample", table_.line(), 0,
                 "no time");
    return true;
  }

  void note_no_number(std::string_view cell, unsigned column) {
    const bool thousands = has_marks_of_thousands(cell);
    notes_.add(
        fmt::format("\"{}\" is not a number{}; the sample is taken as missing",
                    base::printable(cell, 30),
                    thousands ? ", as it has marks of thousands; write it without them" : ""),
        table_.line(), column, thousands ? "thousands" : "text");
  }

  /// Of a file whose header states the rate.
  void check_time() {
    const std::uint64_t index = parsed_++;
    const double rate = header_.sample_rate;
    if (!times_ || rate == 0.0) return;
    if (is_time_of_sample(time_, header_.start, 1.0 / rate, index)) return;
    notes_.add(fmt::format("the time {} s does not fit the sample rate of {} Hz, which makes it "
                           "{} s; the rate is kept",
                           time_, rate, header_.start + static_cast<double>(index) / rate),
               table_.line(), 0, "time");
  }

  void find_grid(const ReadOptions& options) {
    if (options.sample_rate) header_.sample_rate = *options.sample_rate;
    if (!times_ && !options.sample_rate)
      notes_.fail(
          "the file states no sample rate: no column of times was found; give the rate in Hz with "
          "--rate");
    if (!times_) return;
    std::optional<StatedRate> stated;
    if (options.sample_rate)
      stated = {*options.sample_rate, fmt::format("--rate {}", *options.sample_rate)};
    std::uint64_t rows = 0;
    const TimeSource source{
        [&](const TimeSource::Use& use) {
          to_first_sample();
          rows = 0;
          for (std::string_view line; next_line(line, false);)
            if (!may_be_cut(base::table_cells(line, table_.style.separator).size() == columns_)) {
              ++rows;
              use(times_->time(line, table_.style), table_.line());
            }
        },
        [this](double time) { return times_->resolution(time); }};
    const TimeGrid grid = find_time_grid(source, stated, notes_);
    header_.sample_rate = grid.rate;
    header_.start = grid.start;
    header_.date = times_->date();
    if (assumed_seconds_ && !times_->stamps())
      note_assumed_unit(times_taken_for_seconds, grid.rate, rows,
                        "a title such as \"time [ms]\" states another", notes_);
    grid_.emplace(grid, static_cast<Eigen::Index>(header_.channels.size()));
  }

  base::TableReader table_;
  bool damaged_;                            ///< as far as is known
  bool unreadable_{}, unreadable_noted_{};  ///< a line of it is
  bool by_hydrapod_{};
  bool assumed_seconds_{};  ///< the times have no unit
  bool end_noted_{};        ///< that there is no checksum
  std::size_t columns_{};   ///< the column of times, if any, included
  std::optional<TimeCells> times_{};
  std::optional<base::TableReader::Place> first_row_{};
  std::vector<double> row_{};
  double time_{};  ///< of row_
  std::uint64_t parsed_{};
  std::optional<GridRows> grid_{};  ///< where the rate is found from the times
  GridRows::Fetch fetch_{[this](double& time, Eigen::RowVectorXd& row) {
    if (!next_row()) return false;
    time = time_;
    put_values(row);
    return true;
  }};
};

}  // namespace

std::unique_ptr<RecordReader> make_csv_reader(const std::string& path, const ReadOptions& options,
                                              bool damaged) {
  return std::make_unique<CsvReader>(path, options, damaged);
}

}  // namespace hydrapod::data
