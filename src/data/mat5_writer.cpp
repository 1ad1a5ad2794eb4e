#include <fmt/format.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/version.hpp"
#include "mat5_layout.hpp"
#include "unicode.hpp"

namespace hydrapod::data {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t most_bytes = 0x7FFFFFFF;  // of one variable, as MATLAB reads it

std::string word(std::uint32_t value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

/// Tag, data and what fills up to eight bytes.
std::string element(std::uint32_t type, std::string_view bytes) {
  std::string out = word(type) + word(static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
  out.append((8 - bytes.size() % 8) % 8, '\0');
  return out;
}

std::string array_head(std::uint32_t kind, std::uint32_t rows, std::uint32_t columns,
                       const std::string& name) {
  return element(mat5_type::uint32, word(kind) + word(0)) +
         element(mat5_type::int32, word(rows) + word(columns)) + element(mat5_type::int8, name);
}

std::string text_array(const std::string& name, const std::string& text) {
  const std::u16string units = utf16_from(text);
  const std::string_view bytes(reinterpret_cast<const char*>(units.data()), 2 * units.size());
  const auto count = static_cast<std::uint32_t>(units.size());
  return element(mat5_type::matrix, array_head(mat5_class::character, 1, count, name) +
                                        element(mat5_type::uint16, bytes));
}

std::string text_list(const std::string& name, const std::vector<std::string>& texts) {
  std::string out = array_head(mat5_class::cell, 1, static_cast<std::uint32_t>(texts.size()), name);
  for (const std::string& text : texts) out += text_array("", text);
  return element(mat5_type::matrix, out);
}

std::string numbers(const std::string& name, const std::vector<double>& values) {
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                               sizeof(double) * values.size());
  return element(mat5_type::matrix, array_head(mat5_class::double_float, 1,
                                               static_cast<std::uint32_t>(values.size()), name) +
                                        element(mat5_type::double_float, bytes));
}

std::string file_head() {
  std::string text =
      fmt::format("MATLAB 5.0 MAT-file, Platform: GLNXA64, Created by: hydrapod {}", base::version);
  text.resize(116, ' ');
  return text + std::string(8, '\0') + std::string("\0\1IM", 4);
}

std::string header_variables(const RecordHeader& header) {
  std::vector<std::string> name, unit, direction, role;
  std::vector<double> point;
  for (const Channel& c : header.channels) {
    name.push_back(c.name);
    unit.push_back(c.unit);
    direction.emplace_back(direction_text(c.direction));
    role.emplace_back(role_text(c.role));
    point.push_back(c.point);
  }
  return text_array("format", record_mark) + numbers("format_version", {record_version}) +
         text_array("title", header.title) + numbers("sample_rate_hz", {header.sample_rate}) +
         numbers("start_s", {header.start}) + text_array("date", header.date) +
         numbers("repeat", {static_cast<double>(header.repeat)}) +
         text_array("notes", header.notes) + text_array("machine", header.machine) +
         text_list("channel_name", name) + text_list("channel_unit", unit) +
         text_list("channel_direction", direction) + text_list("channel_role", role) +
         numbers("channel_point", point);
}

/// `samples` comes last and grows; its sizes are brought up to date with every block.
class Mat5Writer final : public RecordWriter {
 public:
  Mat5Writer(const std::string& path, const RecordHeader& header)
      : part_(path), header_(header), file_(std::fopen(part_.part().c_str(), "wb")) {
    if (!file_) fail();
    const std::string before = file_head() + header_variables(header);
    samples_at_ = static_cast<long>(before.size());
    write(before + samples_head());
    if (std::fflush(file_.get()) != 0) fail();
  }

  void append(const Eigen::Ref<const Samples>& samples) override {
    require_columns(samples, header_);
    if (!file_) throw std::invalid_argument("RecordWriter::append: the record is closed");
    const std::uint64_t rows = static_cast<std::uint64_t>(samples.rows());
    if (rows == 0) return;
    if (bytes_for(written_ + rows) + samples_head().size() > most_bytes)
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
        array_head(mat5_class::double_float, static_cast<std::uint32_t>(header_.channels.size()),
                   static_cast<std::uint32_t>(written_), "samples") +
        word(mat5_type::double_float) + word(bytes);
    return word(mat5_type::matrix) + word(static_cast<std::uint32_t>(inner.size()) + bytes) + inner;
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
