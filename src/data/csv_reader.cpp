#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "channel_units.hpp"
#include "csv_header.hpp"
#include "csv_text.hpp"
#include "formats.hpp"
#include "hydrapod/base/printable.hpp"

namespace hydrapod::data {

namespace {

constexpr std::size_t rows_for_rate = 1000;  ///< looked at to find the sample rate

class CsvReader final : public RecordReader {
 public:
  CsvReader(const std::string& path, const ReadOptions& options)
      : notes_(path), lines_(path), header_(read_csv_header(lines_, notes_)) {
    RecordHeader& record = header_.record;
    make_names_unique(record.channels);
    factors_ = to_si(record.channels, notes_, header_.by_hydrapod);
    if (record.sample_rate == 0.0) find_rate(options);
    if (record.channels.empty()) notes_.fail("there is no column besides the times");
  }

  [[nodiscard]] RecordFormat format() const override { return RecordFormat::csv; }
  [[nodiscard]] const RecordHeader& header() const override { return header_.record; }
  [[nodiscard]] std::optional<std::int64_t> sample_count() const override { return {}; }
  [[nodiscard]] const std::vector<base::Diagnostic>& notes() const override { return notes_.all(); }

  std::int64_t read(Eigen::Ref<Samples> block) override {
    std::int64_t rows = 0;
    while (rows < block.rows() && next_row()) {
      Eigen::Index out = 0;
      for (std::size_t c = 0; c < header_.columns; ++c)
        if (c != header_.time_column) {
          block(rows, out) = row_[c] * factors_[static_cast<std::size_t>(out)];
          ++out;
        }
      ++rows;
    }
    return rows;
  }

 private:
  /// The next line of numbers in row_, from those looked at already or from the file.
  bool next_row() {
    if (!ahead_.empty()) {
      row_ = std::move(ahead_.front());
      ahead_.pop_front();
      return true;
    }
    return parse_next();
  }

  bool next_line(std::string_view& line, unsigned& number, bool& ended) {
    if (header_.first_row_number > 0) {
      first_row_ = std::move(header_.first_row);
      line = first_row_;
      number = header_.first_row_number;
      ended = header_.first_row_ended;
      header_.first_row_number = 0;
      return true;
    }
    if (!lines_.next(line)) return false;
    number = lines_.number();
    ended = lines_.line_was_ended();
    return true;
  }

  bool parse_next() {
    std::string_view line;
    unsigned number = 0;
    bool ended = true;
    while (next_line(line, number, ended)) {
      const std::string_view text = trimmed_view(line);
      if (text.empty() || text.starts_with('#') || text.starts_with('%')) continue;
      if (!parse(line, number, ended)) return false;
      check_time(number);
      return true;
    }
    return false;
  }

  /// False when the file ends within this line, which is then given up.
  bool parse(std::string_view line, unsigned number, bool ended) {
    row_.assign(header_.columns, std::numeric_limits<double>::quiet_NaN());
    std::size_t fields = 0;
    const char* begin = line.data();
    while (const auto field = next_field(line)) {
      if (fields < header_.columns) {
        const auto value = field_number(*field, header_.decimal_comma);
        const auto column = static_cast<unsigned>(field->data() - begin) + 1;
        if (value)
          row_[fields] = *value;
        else
          notes_.add(fmt::format("\"{}\" is not a number; the sample is taken as missing",
                                 base::printable(*field, 30)),
                     number, column, "text");
      }
      ++fields;
    }
    if (fields == header_.columns) return true;
    if (!ended) {
      notes_.add("the file is cut off within this line, which is left out", number);
      return false;
    }
    notes_.add(fmt::format("{} fields instead of {}; {}", fields, header_.columns,
                           fields < header_.columns ? "those that lack are taken as missing samples"
                                                    : "those beyond are left out"),
               number, 0, fields < header_.columns ? "short" : "long");
    return true;
  }

  /// Takes a field off the front of `line`; none when nothing is left.
  std::optional<std::string_view> next_field(std::string_view& line) const {
    if (line.data() == nullptr) return {};
    const char separator = header_.separator;
    if (separator == ' ') {
      line = trimmed_view(line);
      if (line.empty()) return {};
    }
    const std::size_t end = separator == ' ' ? line.find_first_of(" \t") : line.find(separator);
    const std::string_view field = line.substr(0, end);
    line = end == line.npos ? std::string_view() : line.substr(end + 1);
    return field;
  }

  /// Times must follow the sample rate within a tenth of a step.
  void check_time(unsigned number) {
    const std::int64_t index = parsed_++;
    const double rate = header_.record.sample_rate;
    if (!header_.time_column || rate == 0.0) return;
    const double time = row_[*header_.time_column] * header_.time_factor;
    const double planned = header_.record.start + static_cast<double>(index) / rate;
    const double slack = 0.1 / rate + 1e-5 * std::abs(planned);  // times may have six digits only
    if (!(std::abs(time - planned) <= slack))
      notes_.add(fmt::format("the time {} s does not fit the sample rate of {} Hz, which makes it "
                             "{} s; the rate is kept",
                             time, rate, planned),
                 number, 0, "time");
  }

  void find_rate(const ReadOptions& options) {
    RecordHeader& record = header_.record;
    if (options.sample_rate) record.sample_rate = *options.sample_rate;
    if (!header_.time_column) {
      if (!options.sample_rate)
        notes_.fail(
            "the file tells no sample rate: no column of times was found; give the rate in "
            "Hz with --rate");
      return;
    }
    const double given = record.sample_rate;
    record.sample_rate = 0.0;
    std::vector<double> times;
    while (times.size() < rows_for_rate && parse_next()) {
      times.push_back(row_[*header_.time_column] * header_.time_factor);
      ahead_.push_back(row_);
    }
    if (given > 0.0) {
      record.sample_rate = given;
    } else {
      record.sample_rate = rate_of(times);
    }
    if (!times.empty() && std::isfinite(times.front())) record.start = times.front();
  }

  double rate_of(const std::vector<double>& times) {
    const double span = times.size() < 2 ? 0.0 : times.back() - times.front();
    if (!(span > 0.0) || !std::isfinite(span))
      notes_.fail(
          "the sample rate cannot be told from the column of times: it needs at least two "
          "times, rising; give the rate in Hz with --rate");
    const double steps = static_cast<double>(times.size() - 1);
    double rate = steps / span;
    // printed times are rounded: a whole number nearby is what was meant
    if (std::abs(rate - std::round(rate)) < 1e-5 * rate && std::round(rate) > 0.0)
      rate = std::round(rate);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double planned = times.front() + static_cast<double>(k) / rate;
      if (std::abs(times[k] - planned) <= 0.1 / rate + 1e-5 * std::abs(planned)) continue;
      notes_.fail(
          fmt::format("the times are not evenly spaced: sample {} is at {} s, and {} s would "
                      "be even",
                      k + 1, times[k], planned));
    }
    return rate;
  }

  Notes notes_;
  LineReader lines_;
  CsvHeader header_;
  std::vector<double> factors_;
  std::string first_row_;
  std::vector<double> row_;
  std::deque<std::vector<double>> ahead_;
  std::int64_t parsed_{};
};

}  // namespace

std::unique_ptr<RecordReader> make_csv_reader(const std::string& path, const ReadOptions& options) {
  return std::make_unique<CsvReader>(path, options);
}

}  // namespace hydrapod::data
