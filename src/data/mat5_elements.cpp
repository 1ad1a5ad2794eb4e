#include "mat5_elements.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "hydrapod/base/version.hpp"
#include "mat5_layout.hpp"
#include "unicode.hpp"

namespace hydrapod::data {

static_assert(std::endian::native == std::endian::little);

std::string mat5_word(std::uint32_t value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

std::string mat5_element(std::uint32_t type, std::string_view bytes) {
  std::string out = mat5_word(type) + mat5_word(static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
  out.append((8 - bytes.size() % 8) % 8, '\0');
  return out;
}

std::string mat5_array_head(std::uint32_t kind, const std::vector<int>& size,
                            const std::string& name, bool complex) {
  constexpr std::uint32_t complex_flag = 0x800;
  std::string sizes;
  for (const int n : size) sizes += mat5_word(static_cast<std::uint32_t>(n));
  return mat5_element(mat5_type::uint32,
                      mat5_word(kind | (complex ? complex_flag : 0U)) + mat5_word(0)) +
         mat5_element(mat5_type::int32, sizes) + mat5_element(mat5_type::int8, name);
}

std::string mat5_text(const std::string& name, const std::string& text) {
  const std::u16string units = utf16_from(text);
  const std::string_view bytes(reinterpret_cast<const char*>(units.data()), 2 * units.size());
  return mat5_element(
      mat5_type::matrix,
      mat5_array_head(mat5_class::character, {1, static_cast<int>(units.size())}, name) +
          mat5_element(mat5_type::uint16, bytes));
}

std::string mat5_text_list(const std::string& name, const std::vector<std::string>& texts) {
  std::string out = mat5_array_head(mat5_class::cell, {1, static_cast<int>(texts.size())}, name);
  for (const std::string& text : texts) out += mat5_text("", text);
  return mat5_element(mat5_type::matrix, out);
}

std::string mat5_numbers(const std::string& name, const std::vector<double>& values) {
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                               sizeof(double) * values.size());
  return mat5_element(
      mat5_type::matrix,
      mat5_array_head(mat5_class::double_float, {1, static_cast<int>(values.size())}, name) +
          mat5_element(mat5_type::double_float, bytes));
}

std::string mat5_file_head() {
  std::string text =
      fmt::format("MATLAB 5.0 MAT-file, Platform: GLNXA64, Created by: hydrapod {}", base::version);
  text.resize(116, ' ');
  return text + std::string(8, '\0') + std::string("\0\1IM", 4);
}

}  // namespace hydrapod::data
