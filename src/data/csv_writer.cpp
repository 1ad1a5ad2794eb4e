#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "out_stream.hpp"
#include "record_comments.hpp"

namespace hydrapod::data {

namespace {

std::string header_text(const RecordHeader& header) {
  std::string titles = "time [s]";
  for (const Channel& c : header.channels)
    titles +=
        ',' + base::quoted_cell(c.unit.empty() ? c.name : fmt::format("{} [{}]", c.name, c.unit));
  return comment_lines(header) + titles + '\n';
}

class CsvWriter final : public RecordWriter {
 public:
  CsvWriter(const std::string& path, const RecordHeader& header)
      : RecordWriter(header), file_(path), header_(header) {
    file_.write(header_text(header_));
  }

  void write(const Eigen::Ref<const Samples>& samples) override {
    for (Eigen::Index row = 0; row < samples.rows(); ++row) {
      text_.clear();
      auto out = std::back_inserter(text_);
      fmt::format_to(out, "{}",
                     header_.start + static_cast<double>(written_) / header_.sample_rate);
      for (Eigen::Index column = 0; column < samples.cols(); ++column)
        add_number(samples(row, column));
      text_ += '\n';
      file_.write(text_);
      ++written_;
    }
    file_.flush();
    if (written_ > 0) file_.keep_on_failure();
  }

 private:
  std::string finish(bool complete) override {
    file_.write(fmt::format("# {}: {}\n", checksum_name, checksum()));
    return file_.close(complete);
  }

  /// The shortest text that reads back as the same number; every NaN is "nan".
  void add_number(double value) {
    if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    fmt::format_to(std::back_inserter(text_), ",{}", value);
  }

  PartStream file_;
  RecordHeader header_;
  std::string text_;
  std::int64_t written_{};
};

}  // namespace

std::unique_ptr<RecordWriter> make_csv_writer(const std::string& path, const RecordHeader& header) {
  return std::make_unique<CsvWriter>(path, header);
}

}  // namespace hydrapod::data
