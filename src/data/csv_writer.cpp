#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "formats.hpp"
#include "hydrapod/base/file.hpp"
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
      : part_(path), header_(header), file_(std::fopen(part_.part().c_str(), "wb")) {
    if (file_ == nullptr) fail();
    write(header_text(header_));
  }
  ~CsvWriter() override {
    if (file_ != nullptr) std::fclose(file_);
  }

  void append(const Eigen::Ref<const Samples>& samples) override {
    require_columns(samples, header_);
    if (file_ == nullptr) throw std::invalid_argument("RecordWriter::append: the record is closed");
    for (Eigen::Index row = 0; row < samples.rows(); ++row) {
      text_.clear();
      auto out = std::back_inserter(text_);
      fmt::format_to(out, "{}",
                     header_.start + static_cast<double>(written_) / header_.sample_rate);
      for (Eigen::Index column = 0; column < samples.cols(); ++column)
        add_number(samples(row, column));
      text_ += '\n';
      write(text_);
      ++written_;
    }
    if (std::fflush(file_) != 0) fail();
  }

  void close() override {
    const bool good = std::fclose(file_) == 0;
    file_ = nullptr;
    if (!good) fail();
    part_.commit();
  }

 private:
  [[noreturn]] void fail() { throw base::ComputationError(failed_write(part_, written_ > 0)); }
  void write(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
  }
  /// The shortest text that reads back as the same number; every NaN is "nan".
  void add_number(double value) {
    if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    fmt::format_to(std::back_inserter(text_), ",{}", value);
  }

  base::PartFile part_;
  RecordHeader header_;
  std::FILE* file_;
  std::string text_;
  std::int64_t written_{};
};

}  // namespace

std::unique_ptr<RecordWriter> make_csv_writer(const std::string& path, const RecordHeader& header) {
  return std::make_unique<CsvWriter>(path, header);
}

}  // namespace hydrapod::data
