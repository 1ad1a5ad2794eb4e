#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "record_comments.hpp"

namespace hydrapod::data {

namespace {

using base::TableStyle;
using base::TableTitle;

constexpr unsigned most_header_lines = 1'000'000;  // machine files stand in them
constexpr std::size_t most_columns = 100'000;
constexpr std::size_t rows_for_rate = 1000;  ///< looked at to find the sample rate

/// How the cells of a line of numbers are apart, if it is one.
std::optional<TableStyle> row_style(std::string_view line) {
  constexpr std::array candidates{TableStyle{';', false},  TableStyle{';', true},
                                  TableStyle{'\t', false}, TableStyle{'\t', true},
                                  TableStyle{',', false},  TableStyle{' ', false},
                                  TableStyle{' ', true}};
  const auto fits = [&](const TableStyle& style) {
    if (style.separator != ' ' && line.find(style.separator) == line.npos) return false;
    base::TableCells cells(line, style.separator);
    bool any = false;
    for (std::string_view cell; cells.next(cell); any = any || !cell.empty())
      if (!base::table_number(cell, style.decimal_comma)) return false;
    return any;
  };
  const auto found = std::ranges::find_if(candidates, fits);
  return found == candidates.end() ? std::nullopt : std::optional(*found);
}

bool is_time_name(const std::string& name) {
  constexpr std::array<std::string_view, 5> words{"time", "t", "zeit", "temps", "tiempo"};
  return std::ranges::find(words, base::lower_case(name)) != words.end();
}

/// The factor of a unit of time to seconds, if it is one.
std::optional<double> seconds(const std::string& unit) {
  const ChannelUnit found = channel_unit(unit);
  if (found.unit != "s") return {};
  return found.factor;
}

class CsvReader final : public RecordReader {
 public:
  CsvReader(const std::string& path, const ReadOptions& options)
      : RecordReader(path), table_(path) {
    format_ = RecordFormat::csv;
    read_header();
    settle_channels(by_hydrapod_);
    if (header_.sample_rate == 0.0) find_rate(options);
    if (header_.channels.empty()) notes_.fail("there is no column besides the times");
    to_first_sample();
  }

 private:
  struct TextLine {
    std::string text{};
    unsigned number{};
  };

  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    std::int64_t rows = 0;
    while (rows < block.rows() && next_row()) {
      Eigen::Index out = 0;
      for (std::size_t c = 0; c < columns_; ++c)
        if (c != time_column_) block(rows, out++) = row_[c];
      ++rows;
    }
    return rows;
  }

  void to_first_sample() override {
    if (first_row_) table_.go_to(*first_row_);
    parsed_ = 0;
  }

  // what stands above the numbers

  /// Takes lines up to the first one of numbers; returns those that are neither comments nor
  /// numbers, the last few of them.
  std::vector<TextLine> read_preamble(RecordComments& comments) {
    std::vector<TextLine> texts;
    constexpr std::size_t kept = 8;  // lines of text that may be titles
    for (std::string_view line;
         table_.line() < most_header_lines && table_.next_line(line, true);) {
      if (base::is_table_comment(base::trimmed(line))) {
        comments.take(line, table_.line());
      } else if (const auto style = row_style(line)) {
        table_.style = *style;
        columns_ = base::table_cells(line, style->separator).size();
        first_row_ = table_.line_place();
        break;
      } else {
        if (texts.size() == kept) texts.erase(texts.begin());
        texts.push_back({std::string(line.substr(0, 1U << 16U)), table_.line()});
      }
    }
    if (columns_ > most_columns)
      notes_.fail(
          fmt::format("{} columns are more than the {} that are read", columns_, most_columns),
          table_.line());
    return texts;
  }

  void read_header() {
    RecordComments comments;
    const auto texts = read_preamble(comments);
    by_hydrapod_ = comments.by_hydrapod();
    if (by_hydrapod_) {
      header_ = comments.header(notes_);
      const std::size_t described = header_.channels.size();
      if (first_row_ && described > 0 && described + 1 != columns_)
        notes_.fail(
            fmt::format("{} channels are described, but the lines of numbers have a time and {}",
                        described, columns_ - 1),
            table_.line());
      time_column_ = 0;
      if (columns_ == 0) columns_ = described + 1;
      if (described > 0) return;
    }
    if (!first_row_)
      notes_.fail(
          "no line of numbers was found; expected is a table of samples, one line each, the "
          "fields apart by comma, semicolon, tabulator or blanks");
    const auto found = titles(texts);
    if (!time_column_) find_time_column(found);
    for (std::size_t c = 0; c < columns_; ++c)
      if (c != time_column_)
        header_.channels.push_back({.name = found[c].name, .unit = found[c].unit});
  }

  /// Titles (and a row of units below them, if there is one) from the texts above the numbers.
  std::vector<TableTitle> titles(const std::vector<TextLine>& texts) {
    std::vector<std::vector<base::TableCell>> rows;
    for (const TextLine& line : texts) {
      auto cells = base::table_cells(line.text, table_.style.separator);
      if (cells.size() == columns_) {
        rows.push_back(std::move(cells));
      } else {
        rows.clear();
        notes_.add(fmt::format("skipped \"{}\"", base::printable(line.text)), line.number, 0,
                   "text");
      }
    }
    std::vector<TableTitle> found(columns_);
    if (rows.empty()) return found;
    const auto& names = rows.size() > 1 ? rows[rows.size() - 2] : rows.back();
    for (std::size_t c = 0; c < columns_; ++c) {
      found[c] = base::table_title(names[c]);
      if (rows.size() < 2) continue;
      std::string& unit = found[c].unit;
      unit = rows.back()[c].text;
      if (unit.size() > 1 && (unit.front() == '[' || unit.front() == '('))
        unit = unit.substr(1, unit.size() - 2);
    }
    return found;
  }

  void find_time_column(const std::vector<TableTitle>& found) {
    if (columns_ < 2 && !by_hydrapod_) return;
    for (std::size_t c = 0; c < columns_; ++c) {
      const auto factor = found[c].unit.empty() ? std::optional(1.0) : seconds(found[c].unit);
      if (!factor || (!is_time_name(found[c].name) && (c > 0 || found[c].unit.empty()))) continue;
      time_column_ = c;
      time_factor_ = *factor;
      return;
    }
  }

  // the numbers

  /// The next line of numbers in row_.
  bool next_row() {
    std::string_view line;
    if (!table_.next_line(line)) return false;
    row_.assign(columns_, std::numeric_limits<double>::quiet_NaN());
    std::size_t found = 0;
    base::TableCells cells(line, table_.style.separator);
    for (std::string_view cell; cells.next(cell); ++found) {
      if (found >= columns_) continue;
      if (const auto value = base::table_number(cell, table_.style.decimal_comma))
        row_[found] = *value;
      else
        notes_.add(fmt::format("\"{}\" is not a number; the sample is taken as missing",
                               base::printable(cell, 30)),
                   table_.line(), cells.column(), "text");
    }
    if (found != columns_ && !table_.line_was_ended()) {
      notes_.add("the file is cut off within this line, which is left out", table_.line());
      return false;
    }
    if (found != columns_)
      notes_.add(fmt::format("{} fields instead of {}; {}", found, columns_,
                             found < columns_ ? "absent ones are taken as missing samples"
                                              : "those beyond are left out"),
                 table_.line(), 0, found < columns_ ? "short" : "long");
    check_time();
    return true;
  }

  void check_time() {
    const std::uint64_t index = parsed_++;
    const double rate = header_.sample_rate;
    if (!time_column_ || rate == 0.0) return;
    const double time = row_[*time_column_] * time_factor_;
    if (is_time_of_sample(time, header_.start, 1.0 / rate, index)) return;
    notes_.add(fmt::format("the time {} s does not fit the sample rate of {} Hz, which makes it "
                           "{} s; the rate is kept",
                           time, rate, header_.start + static_cast<double>(index) / rate),
               table_.line(), 0, "time");
  }

  void find_rate(const ReadOptions& options) {
    if (!time_column_ && !options.sample_rate)
      notes_.fail(
          "the file states no sample rate: no column of times was found; give the rate in Hz with "
          "--rate");
    if (time_column_) {
      const Notes before = notes_;  // the rows are read again
      to_first_sample();
      std::vector<double> times;
      while (times.size() < rows_for_rate && next_row())
        times.push_back(row_[*time_column_] * time_factor_);
      if (!options.sample_rate) header_.sample_rate = rate_of(times);
      if (!times.empty() && std::isfinite(times.front())) header_.start = times.front();
      notes_ = before;
    }
    if (options.sample_rate) header_.sample_rate = *options.sample_rate;
  }

  double rate_of(const std::vector<double>& times) {
    const double span = times.size() < 2 ? 0.0 : times.back() - times.front();
    if (!(span > 0.0) || !std::isfinite(span))
      notes_.fail(
          "the sample rate cannot be determined from the column of times: it needs at least two "
          "times, rising; give the rate in Hz with --rate");
    const double rate = rounded_rate(static_cast<double>(times.size() - 1) / span, 1e-5);
    for (std::size_t k = 0; k < times.size(); ++k)
      if (!is_time_of_sample(times[k], times.front(), 1.0 / rate, k))
        notes_.fail(
            fmt::format("the times are not evenly spaced: sample {} is at {} s, and {} s would "
                        "be even",
                        k + 1, times[k], times.front() + static_cast<double>(k) / rate));
    return rate;
  }

  base::TableReader table_;
  bool by_hydrapod_{};
  std::size_t columns_{};  ///< the column of times, if any, included
  std::optional<std::size_t> time_column_{};
  double time_factor_{1.0};  ///< its unit in seconds
  std::optional<base::TableReader::Place> first_row_{};
  std::vector<double> row_{};
  std::uint64_t parsed_{};
};

}  // namespace

std::unique_ptr<RecordReader> make_csv_reader(const std::string& path, const ReadOptions& options) {
  return std::make_unique<CsvReader>(path, options);
}

}  // namespace hydrapod::data
