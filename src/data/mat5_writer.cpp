#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "formats.hpp"
#include "hydrapod/base/version.hpp"
#include "mat5_layout.hpp"
#include "out_stream.hpp"
#include "unicode.hpp"

namespace hydrapod::data {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t longest_name = 63;
constexpr std::uint64_t mat5_most_bytes = 0x7FFFFFFF;  ///< of one variable, as MATLAB reads

/// Four bytes, little-endian.
std::string mat5_word(std::uint32_t value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

/// Tag, data and what fills up to eight bytes.
std::string mat5_element(std::uint32_t type, std::string_view bytes) {
  std::string out = mat5_word(type) + mat5_word(static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
  out.append((8 - bytes.size() % 8) % 8, '\0');
  return out;
}

/// Flags, sizes and name of an array of class `kind`.
std::string mat5_array_head(std::uint32_t kind, const std::vector<int>& size,
                            const std::string& name, bool complex = false) {
  constexpr std::uint32_t complex_flag = 0x800;
  std::string sizes;
  for (const int n : size) sizes += mat5_word(static_cast<std::uint32_t>(n));
  return mat5_element(mat5_type::uint32,
                      mat5_word(kind | (complex ? complex_flag : 0U)) + mat5_word(0)) +
         mat5_element(mat5_type::int32, sizes) + mat5_element(mat5_type::int8, name);
}

/// ASCII in words of 16 bits, as MATLAB writes it. Readers take words for characters of their own
/// (SciPy of UTF-8), so that other texts are in UTF-8.
std::string mat5_text(const std::string& name, const std::string& text) {
  const std::u16string units = utf16_from(text);
  const bool ascii = units.size() == text.size();
  const std::string_view words(reinterpret_cast<const char*>(units.data()), 2 * units.size());
  const auto is_second = [](char16_t unit) { return unit >= 0xDC00 && unit < 0xE000; };
  const auto characters = std::ssize(units) - std::ranges::count_if(units, is_second);
  return mat5_element(
      mat5_type::matrix,
      mat5_array_head(mat5_class::character, {1, static_cast<int>(characters)}, name) +
          (ascii ? mat5_element(mat5_type::uint16, words) : mat5_element(mat5_type::utf8, text)));
}

std::string mat5_text_list(const std::string& name, const std::vector<std::string>& texts) {
  std::string out = mat5_array_head(mat5_class::cell, {1, static_cast<int>(texts.size())}, name);
  for (const std::string& text : texts) out += mat5_text("", text);
  return mat5_element(mat5_type::matrix, out);
}

/// The 128 bytes at the beginning.
std::string mat5_file_head() {
  std::string text =
      fmt::format("MATLAB 5.0 MAT-file, Platform: GLNXA64, Created by: hydrapod {}", base::version);
  text.resize(116, ' ');
  return text + std::string(8, '\0') + std::string("\0\1IM", 4);
}

void require_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto allowed = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || name.size() > longest_name || !letter(name[0]) ||
      !std::ranges::all_of(name, allowed))
    throw std::invalid_argument(
        fmt::format("'{}' is no name of a MAT variable: letters, digits and _, at most {}", name,
                    longest_name));
}

std::string mat5_doubles(const std::vector<double>& values) {
  return mat5_element(mat5_type::double_float, {reinterpret_cast<const char*>(values.data()),
                                                sizeof(double) * values.size()});
}

std::string mat5_array(const MatVariable& v) {
  const double count =
      std::accumulate(v.size.begin(), v.size.end(), 1.0, [](double n, int s) { return n * s; });
  if (v.size.size() < 2 || count != static_cast<double>(v.real.size()) ||
      (!v.imaginary.empty() && v.imaginary.size() != v.real.size()))
    throw std::invalid_argument(
        fmt::format("MAT variable {}: {} numbers do not fit its size", v.name, v.real.size()));
  const std::uint64_t bytes = sizeof(double) * (v.real.size() + v.imaginary.size());
  if (bytes > mat5_most_bytes)
    throw base::ComputationError(
        fmt::format("{} is larger than the 2 GiB that a variable of a MAT file can hold", v.name));
  std::string inner =
      mat5_array_head(mat5_class::double_float, v.size, v.name, !v.imaginary.empty()) +
      mat5_doubles(v.real);
  if (!v.imaginary.empty()) inner += mat5_doubles(v.imaginary);
  return mat5_element(mat5_type::matrix, inner);
}

template <class Matrix>
MatVariable pages_of(const std::string& name, std::span<const Matrix> pages) {
  MatVariable v{.name = name};
  const int rows = pages.empty() ? 0 : static_cast<int>(pages[0].rows()),
            columns = pages.empty() ? 0 : static_cast<int>(pages[0].cols());
  v.size = {rows, columns, static_cast<int>(pages.size())};
  for (const auto& page : pages)
    for (Eigen::Index j = 0; j < page.cols(); ++j)
      for (Eigen::Index i = 0; i < page.rows(); ++i) {
        v.real.push_back(std::real(page(i, j)));
        if constexpr (Eigen::NumTraits<typename Matrix::Scalar>::IsComplex)
          v.imaginary.push_back(std::imag(page(i, j)));
      }
  return v;
}

/// Variables one after the other.
struct Mat5Header {
  std::string out{};

  bool numbers(const std::string& name, const std::vector<double>& values) {
    out += mat5_array({.name = name, .size = {1, static_cast<int>(values.size())}, .real = values});
    return true;
  }
  bool attribute(const char* name, const std::string& value) { return text(name, value); }
  bool attribute(const char* name, double value) { return numbers(name, {value}); }
  bool text(const char* name, const std::string& text) {
    out += mat5_text(name, text);
    return true;
  }
  bool channels(const std::string& name, const std::vector<std::string>& texts) {
    out += mat5_text_list("channel_" + name, texts);
    return true;
  }
  bool channels(const std::string& name, const std::vector<int>& values) {
    return numbers("channel_" + name, {values.begin(), values.end()});
  }
};

/// `samples` comes last and grows; its sizes are brought up to date with every block.
class Mat5Writer final : public RecordWriter {
 public:
  Mat5Writer(const std::string& path, const RecordHeader& header)
      : RecordWriter(header), file_(path), header_(header) {
    Mat5Header fields{mat5_file_head()};
    put_header(header, fields);
    checksum_at_ =
        static_cast<std::uint64_t>(fields.out.find(mat5_text(checksum_name, no_checksum_yet)));
    samples_at_ = static_cast<std::uint64_t>(fields.out.size());
    file_.write(fields.out + samples_head());
    file_.flush();
  }

  void write(const Eigen::Ref<const Samples>& samples) override {
    const std::uint64_t rows = static_cast<std::uint64_t>(samples.rows());
    if (rows == 0) return;
    if (bytes_for(written_ + rows) + samples_head().size() > mat5_most_bytes)
      throw base::ComputationError(
          fmt::format("'{}' would be larger than the 2 GiB that a MAT file of version 5 can hold; "
                      "write it as mat73 or hdf5",
                      file_.path()));
    const Samples dense = samples;
    file_.write({reinterpret_cast<const char*>(dense.data()), bytes_for(rows)});
    written_ += rows;
    file_.flush();  // the sizes come behind what they count
    file_.write_at(samples_at_, samples_head());
    file_.keep_on_failure();
  }

 private:
  std::string finish(bool complete) override {
    file_.write_at(checksum_at_, mat5_text(checksum_name, checksum()));
    return file_.close(complete);
  }

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

  PartStream file_;
  RecordHeader header_;
  std::uint64_t checksum_at_{}, samples_at_{};
  std::uint64_t written_{};
};

}  // namespace

MatVariable mat_number(const std::string& name, double value) {
  return {.name = name, .size = {1, 1}, .real = {value}, .is_number = true};
}

MatVariable mat_array(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  const Eigen::MatrixXd page = values;
  auto v = pages_of<Eigen::MatrixXd>(name, {&page, 1});
  v.size.pop_back();  // one page
  return v;
}

MatVariable mat_complex(const std::string& name, const Eigen::Ref<const Eigen::MatrixXcd>& values) {
  const Eigen::MatrixXcd page = values;
  auto v = pages_of<Eigen::MatrixXcd>(name, {&page, 1});
  v.size.pop_back();  // one page
  return v;
}

MatVariable mat_pages(const std::string& name, std::span<const Eigen::MatrixXcd> pages) {
  return pages_of(name, pages);
}

MatVariable mat_pages(const std::string& name, std::span<const Eigen::MatrixXd> pages) {
  return pages_of(name, pages);
}

MatVariable mat_text(const std::string& name, const std::string& text) {
  return {.name = name, .texts = {text}, .is_text = true};
}

MatVariable mat_list(const std::string& name, const std::vector<std::string>& texts) {
  return {.name = name, .texts = texts, .is_list = true};
}

void write_mat_variables(const std::string& path, const std::vector<MatVariable>& variables) {
  std::string text = mat5_file_head();
  for (const auto& v : variables) {
    require_name(v.name);
    if (v.is_text)
      text += mat5_text(v.name, v.texts.empty() ? "" : v.texts[0]);
    else if (v.is_list)
      text += mat5_text_list(v.name, v.texts);
    else
      text += mat5_array(v);
  }
  base::write_file_whole(path, text);
}

std::unique_ptr<RecordWriter> make_mat5_writer(const std::string& path,
                                               const RecordHeader& header) {
  return std::make_unique<Mat5Writer>(path, header);
}

}  // namespace hydrapod::data
