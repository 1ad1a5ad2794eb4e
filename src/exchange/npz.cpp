#include "npz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace hydrapod::exchange {

namespace {

static_assert(std::endian::native == std::endian::little);

template <class Number>
std::string little(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

std::string raw(const double* numbers, std::size_t count) {
  return {reinterpret_cast<const char*>(numbers), count * sizeof(double)};
}

/// Valid UTF-8 as code points.
std::u32string code_points(const std::string& text) {
  std::u32string points;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const int more = byte < 0x80 ? 0 : byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
    char32_t point = more == 0 ? byte : byte & (0x3FU >> static_cast<unsigned>(more));
    for (int k = 1; k <= more && i + static_cast<std::size_t>(k) < text.size(); ++k)
      point =
          point << 6U | (static_cast<unsigned char>(text[i + static_cast<std::size_t>(k)]) & 0x3FU);
    points.push_back(point);
    i += static_cast<std::size_t>(more) + 1;
  }
  return points;
}

/// Code points of equal length, and that length.
std::pair<std::string, std::size_t> padded(const std::vector<std::string>& texts) {
  std::vector<std::u32string> all;
  std::size_t longest = 1;
  for (const auto& text : texts) {
    all.push_back(code_points(text));
    longest = std::max(longest, all.back().size());
  }
  std::string data;
  for (auto& points : all) {
    points.resize(longest, U'\0');
    data.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(char32_t));
  }
  return {data, longest};
}

}  // namespace

void NpzWriter::add_member(const std::string& name, const std::string& kind,
                           const std::string& shape, const std::string& data, bool by_columns) {
  constexpr std::size_t before_header = 10, alignment = 64;
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': {}, }}", kind,
                                   by_columns ? "True" : "False", shape);
  header.append(alignment - 1 - (before_header + header.size()) % alignment, ' ');
  header += '\n';
  const std::string content = std::string("\x93NUMPY\x01\x00", 8) +
                              little(static_cast<std::uint16_t>(header.size())) + header + data;
  zip_.add(name + ".npy", content);
}

void NpzWriter::add(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::MatrixXd dense = matrix;
  add_member(name, "<f8", fmt::format("({}, {})", dense.rows(), dense.cols()),
             raw(dense.data(), static_cast<std::size_t>(dense.size())), true);
}

void NpzWriter::add_list(const std::string& name, const std::vector<double>& numbers) {
  add_member(name, "<f8", fmt::format("({},)", numbers.size()), raw(numbers.data(), numbers.size()),
             false);
}

void NpzWriter::add_number(const std::string& name, double number) {
  add_member(name, "<f8", "()", raw(&number, 1), false);
}

void NpzWriter::add_texts(const std::string& name, const std::vector<std::string>& texts) {
  const auto [data, longest] = padded(texts);
  add_member(name, fmt::format("<U{}", longest), fmt::format("({},)", texts.size()), data, false);
}

void NpzWriter::add_text(const std::string& name, const std::string& text) {
  const auto [data, longest] = padded({text});
  add_member(name, fmt::format("<U{}", longest), "()", data, false);
}

}  // namespace hydrapod::exchange
