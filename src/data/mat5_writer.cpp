#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "header_fields.hpp"
#include "mat5_elements.hpp"
#include "mat5_layout.hpp"

namespace hydrapod::data {

namespace {

/// Variables one after the other.
struct Mat5Header {
  std::string out{};

  bool attribute(const char* name, const std::string& value) { return text(name, value); }
  bool attribute(const char* name, double value) {
    out += mat5_numbers(name, {value});
    return true;
  }
  bool text(const char* name, const std::string& text) {
    out += mat5_text(name, text);
    return true;
  }
  bool channels(const std::string& name, const std::vector<std::string>& texts) {
    out += mat5_text_list("channel_" + name, texts);
    return true;
  }
  bool channels(const std::string& name, const std::vector<int>& values) {
    out += mat5_numbers("channel_" + name, {values.begin(), values.end()});
    return true;
  }
};

/// `samples` comes last and grows; its sizes are brought up to date with every block.
class Mat5Writer final : public RecordWriter {
 public:
  Mat5Writer(const std::string& path, const RecordHeader& header)
      : part_(path), header_(header), file_(std::fopen(part_.part().c_str(), "wb")) {
    if (!file_) fail();
    Mat5Header fields{mat5_file_head()};
    put_header(header, fields);
    const std::string& before = fields.out;
    samples_at_ = static_cast<long>(before.size());
    write(before + samples_head());
    if (std::fflush(file_.get()) != 0) fail();
  }

  void append(const Eigen::Ref<const Samples>& samples) override {
    require_columns(samples, header_);
    if (!file_) throw std::invalid_argument("RecordWriter::append: the record is closed");
    const std::uint64_t rows = static_cast<std::uint64_t>(samples.rows());
    if (rows == 0) return;
    if (bytes_for(written_ + rows) + samples_head().size() > mat5_most_bytes)
      throw base::ComputationError(
          fmt::format("'{}' would be larger than the 2 GiB that a MAT file of version 5 can hold; "
                      "write it as mat73 or hdf5",
                      part_.path()));
    const Samples dense = samples;
    write({reinterpret_cast<const char*>(dense.data()), bytes_for(rows)});
    written_ += rows;
    if (std::fseek(file_.get(), samples_at_, SEEK_SET) != 0) fail();
    write(samples_head());
    if (std::fseek(file_.get(), 0, SEEK_END) != 0 || std::fflush(file_.get()) != 0) fail();
  }

  void close() override {
    if (!file_ || std::fclose(file_.release()) != 0) fail();
    part_.commit();
  }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  [[nodiscard]] std::uint64_t bytes_for(std::uint64_t samples) const {
    return samples * header_.channels.size() * sizeof(double);
  }

  /// channels × samples, so that samples stand one after the other.
  [[nodiscard]] std::string samples_head() const {
    const auto bytes = static_cast<std::uint32_t>(bytes_for(written_));
    const std::string inner =
        mat5_array_head(mat5_class::double_float,
                        {static_cast<int>(header_.channels.size()), static_cast<int>(written_)},
                        "samples") +
        mat5_word(mat5_type::double_float) + mat5_word(bytes);
    return mat5_word(mat5_type::matrix) +
           mat5_word(static_cast<std::uint32_t>(inner.size()) + bytes) + inner;
  }

  void write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail();
  }
  [[noreturn]] void fail() const {
    throw base::ComputationError(
        fmt::format("writing '{}' failed; is the disk full?", part_.path()));
  }

  base::PartFile part_;
  RecordHeader header_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  long samples_at_{};
  std::uint64_t written_{};
};

}  // namespace

std::unique_ptr<RecordWriter> make_mat5_writer(const std::string& path,
                                               const RecordHeader& header) {
  return std::make_unique<Mat5Writer>(path, header);
}

}  // namespace hydrapod::data
