#include "uff_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/version.hpp"

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

std::string place_columns(const UffPlace& place) {
  return fmt::format(" {}{:10}{:4}", fortran_a(place.entity, 10), place.node, place.direction);
}

std::string dataset_number_line(const UffFunction& f) {
  if (!f.binary) return "    58\n";
  const std::uint64_t value = (f.is_double ? 8U : 4U) * tuple_size(f);
  constexpr int little_endian = 1, ieee = 2;
  return fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n", little_endian, ieee,
                     uff_header_lines, f.declared * value, 0, 0, 0, 0);
}

int ordinate_type(const UffFunction& f) {
  return f.is_complex ? (f.is_double ? 6 : 5) : (f.is_double ? 4 : 2);
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

std::string uff_text_line(const std::string& text) {
  // a name may have a line end, which would move all lines behind it
  return fortran_a(text.empty() ? "NONE" : base::printable(text, std::string::npos), 80) + '\n';
}

std::string uff_function_head(const UffFunction& f) {
  std::string out = uff_delimiter + dataset_number_line(f);
  for (const std::string& id : f.id) out += uff_text_line(id);
  out += fmt::format("{:5}{:10}{:5}{:10}{}{}\n", f.type, f.number, f.version, f.load_case,
                     place_columns(f.response), place_columns(f.reference));
  out += fmt::format("{:10}{:10}{:10}{}{}{}\n", ordinate_type(f), f.declared, f.is_even ? 1 : 0,
                     fortran_e(f.first, 13, 5), fortran_e(f.step, 13, 5), fortran_e(f.z, 13, 5));
  for (const UffAxis& axis : {f.abscissa, f.ordinate, f.denominator, f.z_axis})
    out += fmt::format("{:10}{:5}{:5}{:5} {} {}\n", axis.quantity, axis.length_exponent,
                       axis.force_exponent, axis.temperature_exponent, fortran_a(axis.label, 20),
                       fortran_a(axis.unit, 20));
  return out;
}

std::string uff_beginning(const std::string& model, const std::string& date,
                          const std::string& comments) {
  const std::string program = fmt::format("hydrapod {}", base::version);
  const std::string when = uff_date(date);
  const bool dated = when.size() == 18;
  const std::string stamp = fortran_a(dated ? when.substr(0, 9) : "NONE", 10) +
                            fortran_a(dated ? when.substr(10) : "NONE", 10);
  std::string out = fmt::format("{}   151\n{}{}{}", uff_delimiter, uff_text_line(model),
                                uff_text_line(""), uff_text_line(program));
  out += fmt::format("{}{:10}{:10}{:10}\n{}\n{}", stamp, 0, 0, 0, stamp, uff_text_line(program));
  out += fmt::format("{}{:5}{:5}{:5}{:5}{:5}\n{}", stamp, 0, 0, 0, 0, 0, uff_delimiter);
  const UffUnits si;
  out += fmt::format("{}   164\n{:10}{}{:10}\n{}{}{}\n{}\n{}", uff_delimiter, si.code,
                     fortran_a(si.description, 20), 2, fortran_d(si.length), fortran_d(si.force),
                     fortran_d(si.temperature), fortran_d(si.temperature_offset), uff_delimiter);
  if (!comments.empty())
    out += fmt::format("{}{:6}\n{}{}", uff_delimiter, uff_own_dataset, comments, uff_delimiter);
  return out;
}

void UffNumbers::add(double number, std::string& out) {
  if (binary_) {
    out.append(reinterpret_cast<const char*>(&number), sizeof number);
    return;
  }
  const int width = widths_[column_];
  out += fortran_e(number, width, width == 13 ? 5 : 12);
  column_ = (column_ + 1) % widths_.size();
  if (column_ == 0) out += '\n';
}

void UffNumbers::finish(std::string& out) const {
  if (column_ > 0) out += '\n';
  out += uff_delimiter;
}

}  // namespace hydrapod::data
