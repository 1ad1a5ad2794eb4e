#include "uff_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/text.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

long long uff_integer(std::string_view line, std::size_t begin, std::size_t width,
                      const char* what) {
  const std::string_view field = columns(line, begin, width);
  if (field.empty()) return 0;
  const auto value = fortran_integer(field);
  if (!value)
    throw Unusable{
        fmt::format("{} is \"{}\", not a whole number", what, base::printable(field, 20))};
  return *value;
}

int uff_small(std::string_view line, std::size_t begin, std::size_t width, const char* what,
              long long least, long long most) {
  const long long value = uff_integer(line, begin, width, what);
  if (value < least || value > most)
    throw Unusable{fmt::format("{} is {}; known are {} to {}", what, value, least, most)};
  return static_cast<int>(value);
}

double uff_real(std::string_view line, std::size_t begin, std::size_t width, const char* what) {
  const std::string_view field = columns(line, begin, width);
  if (field.empty()) return 0.0;
  const auto value = fortran_number(field);
  if (!value || !std::isfinite(*value))
    throw Unusable{
        fmt::format("{} is \"{}\", not a finite number", what, base::printable(field, 20))};
  return *value;
}

std::string uff_field(std::string_view line, std::size_t begin, std::size_t width) {
  return clean_text(columns(line, begin, width));
}

UffPlace uff_place_at(std::string_view line, std::size_t begin, const char* what) {
  UffPlace place;
  place.entity = uff_field(line, begin + 1, 10);
  place.node = uff_integer(line, begin + 11, 10, what);
  place.direction = uff_small(line, begin + 21, 4, what, -6, 6);
  return place;
}

UffAxis uff_axis(std::string_view line) {
  UffAxis axis;
  axis.quantity = static_cast<int>(
      std::clamp(uff_integer(line, 0, 10, "the specific data type"), -1LL, 1000LL));
  constexpr long long most = 20;
  axis.length_exponent = uff_small(line, 10, 5, "the length units exponent", -most, most);
  axis.force_exponent = uff_small(line, 15, 5, "the force units exponent", -most, most);
  axis.temperature_exponent = uff_small(line, 20, 5, "the temperature units exponent", -most, most);
  axis.label = uff_field(line, 26, 20);
  axis.unit = uff_field(line, 47, 20);
  return axis;
}

}  // namespace hydrapod::data
