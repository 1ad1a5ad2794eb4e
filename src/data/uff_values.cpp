#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <limits>

#include "hydrapod/base/text.hpp"
#include "uff_dataset.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

template <typename Number, typename Bits>
double decoded(std::string_view bytes, bool big_endian) {
  std::array<char, sizeof(Number)> order{};
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = bytes[big_endian ? order.size() - 1 - i : i];
  Bits bits{};  // little-endian, as every machine that this runs on
  static_assert(std::endian::native == std::endian::little);
  std::memcpy(&bits, order.data(), order.size());
  return static_cast<double>(std::bit_cast<Number>(bits));
}

}  // namespace

std::size_t tuple_size(const UffFunction& function) {
  return (function.is_even ? 0U : 1U) + (function.is_complex ? 2U : 1U);
}

std::vector<int> uff_widths(const UffFunction& function) {
  if (!function.is_double) return {13, 13, 13, 13, 13, 13};
  if (function.is_even) return {20, 20, 20, 20};
  if (function.is_complex) return {13, 20, 20};
  return {13, 20, 13, 20};
}

std::vector<double> uff_line_numbers(std::string_view line, const std::vector<int>& widths,
                                     bool free_form, unsigned& bad) {
  std::vector<double> numbers;
  const auto take = [&](std::string_view field) {
    const auto number = fortran_number(field);
    if (!number && bad == 0) bad = static_cast<unsigned>(field.data() - line.data()) + 1;
    numbers.push_back(number.value_or(missing));
  };
  if (free_form) {
    std::string_view rest = base::trimmed(line);
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      take(rest.substr(0, end));
      rest = base::trimmed(rest.substr(end));
    }
    return numbers;
  }
  const std::string_view text = line.substr(0, line.find_last_not_of(" \t") + 1);
  std::size_t at = 0;
  for (const int width : widths) {
    if (at >= text.size()) break;
    take(text.substr(at, static_cast<std::size_t>(width)));
    at += static_cast<std::size_t>(width);
  }
  return numbers;
}

UffValues::UffValues(const FileWindow& file, const UffFunction& function, std::size_t window)
    : function_(function),
      file_(file, window),
      offset_(function.begin),
      line_(function.data_line) {}

bool UffValues::next(double& number, Notes& notes) {
  if (function_.binary) return next_binary(number);
  while (taken_ == numbers_.size())
    if (!fill_from_line(notes)) return false;
  number = numbers_[taken_++];
  return true;
}

bool UffValues::next_binary(double& number) {
  const bool abscissa = !function_.is_even && place_in_tuple_ == 0;
  const bool wide = abscissa ? function_.wide_abscissa : function_.is_double;
  const std::size_t bytes = wide ? 8 : 4;
  if (offset_ + bytes > function_.end) return false;
  const std::string_view raw = file_.at(offset_, bytes);
  if (raw.size() < bytes) return false;
  number = wide ? decoded<double, std::uint64_t>(raw, function_.big_endian)
                : decoded<float, std::uint32_t>(raw, function_.big_endian);
  offset_ += bytes;
  place_in_tuple_ = (place_in_tuple_ + 1) % tuple_size(function_);
  return true;
}

bool UffValues::fill_from_line(Notes& notes) {
  if (offset_ >= function_.end) return false;
  const FileWindow::Line line = file_.line_at(offset_);
  unsigned bad = 0;
  numbers_ = uff_line_numbers(line.text, uff_widths(function_), function_.free_form, bad);
  taken_ = 0;
  if (bad > 0)
    notes.add(fmt::format("dataset {}: text where a number should be; the sample is taken as "
                          "missing",
                          function_.dataset),
              line_, line_ > 0 ? bad : 0, fmt::format("text in {}", function_.dataset));
  offset_ = line.next;
  if (line_ > 0) ++line_;
  return true;
}

}  // namespace hydrapod::data
