#include "uff_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "hydrapod/base/text.hpp"

namespace hydrapod::data {

namespace {

constexpr std::array<std::string_view, 12> months{"JAN", "FEB", "MAR", "APR", "MAY", "JUN",
                                                  "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"};

std::optional<int> digits(std::string_view text) {
  int value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || value < 0) return {};
  return value;
}

std::optional<double> parsed(std::string_view text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return {};
  if (status == std::errc::result_out_of_range) {
    const bool tiny = text.find("E-") != text.npos || text.find("e-") != text.npos;
    return std::copysign(tiny ? 0.0 : std::numeric_limits<double>::infinity(),
                         text.front() == '-' ? -1.0 : 1.0);
  }
  if (status != std::errc{}) return {};
  return value;
}

}  // namespace

std::string fortran_e(double value, int width, int digits_after_point) {
  if (std::isnan(value)) return fmt::format("{:>{}}", "NaN", width);
  return fmt::format("{:>{}}", fmt::format("{:.{}E}", value, digits_after_point), width);
}

std::string fortran_d(double value) {
  std::string text = fmt::format("{:25.17E}", value);
  std::replace(text.begin(), text.end(), 'E', 'D');
  return text;
}

std::string fortran_a(std::string_view text, std::size_t width) {
  if (text.size() > width) {
    std::size_t end = width;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    text = text.substr(0, end);
  }
  return std::string(text) + std::string(width - text.size(), ' ');
}

std::string_view columns(std::string_view line, std::size_t begin, std::size_t width) {
  if (begin >= line.size()) return {};
  return base::trimmed(line.substr(begin, width));
}

std::optional<double> fortran_number(std::string_view field) {
  field = base::trimmed(field);
  if (field.starts_with('+')) field.remove_prefix(1);
  if (field.empty() || field.size() > 60 || field.starts_with('+')) return {};
  if (const auto plain = parsed(field)) return plain;
  // D for E, or no letter at all before an exponent of three digits
  std::array<char, 64> text{};
  std::size_t size = 0;
  bool exponent = false;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const char c = field[i];
    if (c == 'D' || c == 'd' || c == 'E' || c == 'e') {
      text[size++] = 'E';
      exponent = true;
    } else if ((c == '+' || c == '-') && i > 0 && !exponent) {
      text[size++] = 'E';
      text[size++] = c;
      exponent = true;
    } else {
      text[size++] = c;
    }
  }
  return parsed({text.data(), size});
}

std::optional<long long> fortran_integer(std::string_view field) {
  field = base::trimmed(field);
  if (field.starts_with('+')) field.remove_prefix(1);
  long long value = 0;
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (field.empty() || status != std::errc{} || end != field.data() + field.size()) return {};
  return value;
}

std::string uff_date(std::string_view iso) {
  const bool shaped = iso.size() >= 19 && iso[4] == '-' && iso[7] == '-' && iso[13] == ':';
  const auto month = shaped ? digits(iso.substr(5, 2)) : std::nullopt;
  if (!month || *month < 1 || *month > 12) return std::string(iso);
  return fmt::format("{}-{}-{} {}", iso.substr(8, 2), months[static_cast<std::size_t>(*month - 1)],
                     iso.substr(2, 2), iso.substr(11, 8));
}

std::string iso_date(std::string_view uff) {
  std::string upper(uff);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const bool shaped = uff.size() >= 18 && uff[2] == '-' && uff[6] == '-' && uff[12] == ':';
  const auto month =
      shaped ? std::find(months.begin(), months.end(), upper.substr(3, 3)) : months.end();
  const auto year = shaped ? digits(uff.substr(7, 2)) : std::nullopt;
  if (month == months.end() || !year) return std::string(uff);
  return fmt::format("{}-{:02}-{}T{}", *year < 70 ? 2000 + *year : 1900 + *year,
                     month - months.begin() + 1, uff.substr(0, 2), uff.substr(10, 8));
}

}  // namespace hydrapod::data
