#include "hydrapod/base/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "hydrapod/base/text.hpp"
#include "unit_database.hpp"

namespace hydrapod::base {

namespace {

constexpr std::size_t longest_quantity = 200;

struct NamedDimension {
  const char* unit;
  const char* name;
};
constexpr std::array named_dimensions{NamedDimension{"1", "a pure number"},
                                      NamedDimension{"rad", "an angle"},
                                      NamedDimension{"m", "a length"},
                                      NamedDimension{"m^2", "an area"},
                                      NamedDimension{"m^3", "a volume"},
                                      NamedDimension{"kg", "a mass"},
                                      NamedDimension{"s", "a time"},
                                      NamedDimension{"1/s", "a frequency"},
                                      NamedDimension{"rad/s", "an angular speed"},
                                      NamedDimension{"m/s", "a speed"},
                                      NamedDimension{"m/s^2", "an acceleration"},
                                      NamedDimension{"N", "a force"},
                                      NamedDimension{"N m", "a torque"},
                                      NamedDimension{"Pa", "a pressure"},
                                      NamedDimension{"N/m", "a stiffness"},
                                      NamedDimension{"N s/m", "a viscous damping"},
                                      NamedDimension{"kg m^2", "a moment of inertia"},
                                      NamedDimension{"W", "a power"},
                                      NamedDimension{"kg/m^3", "a density"},
                                      NamedDimension{"m^3/s", "a volume flow"},
                                      NamedDimension{"Pa s", "a dynamic viscosity"},
                                      NamedDimension{"m^2/s", "a kinematic viscosity"},
                                      NamedDimension{"K", "a temperature"},
                                      NamedDimension{"A", "a current"},
                                      NamedDimension{"V", "a voltage"}};

/// Spellings that people mean when they write "mpa", "Nm" or "kgm^2".
constexpr std::array<const char*, 36> common_units{
    "m",     "mm",    "cm",    "um",     "kg",     "g",      "t",    "N",    "kN",
    "MN",    "Pa",    "kPa",   "MPa",    "GPa",    "bar",    "N/m",  "kN/m", "MN/m",
    "N/mm",  "kN/mm", "N s/m", "kN s/m", "N s/mm", "kg m^2", "N m",  "kN m", "m/s",
    "m/s^2", "mm/s",  "deg",   "rad",    "deg/s",  "m^3",    "cm^3", "mm^3", "Hz"};

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// Non-breaking and narrow spaces, as typeset text has them between number and unit, made plain.
std::string with_plain_spaces(std::string_view text) {
  constexpr std::array<std::string_view, 3> spaces{"\xC2\xA0", "\xE2\x80\x89", "\xE2\x80\xAF"};
  std::string plain;
  while (!text.empty()) {
    const auto space = std::find_if(spaces.begin(), spaces.end(),
                                    [&](std::string_view s) { return text.starts_with(s); });
    const bool found = space != spaces.end();
    plain += found ? ' ' : text[0];
    text.remove_prefix(found ? space->size() : 1);
  }
  return plain;
}

/// Bytes that the character at the start of `text` takes if a unit may have it, else 0.
std::size_t unit_character(std::string_view text) {
  constexpr std::string_view ascii = " %/*.^+-()";
  constexpr std::array<std::string_view, 6> others{"°", "µ", "μ", "·", "²", "³"};
  if (is_letter(text[0]) || is_digit(text[0]) || ascii.find(text[0]) != ascii.npos) return 1;
  for (const auto other : others) {
    if (text.starts_with(other)) return other.size();
  }
  return 0;
}

/// A digit in a unit must be an exponent ("m^2", "s-1"): UDUNITS-2 would take "m 5" for five metres
/// and "2020-01-01" for a time. A leading "1/" is the usual way to write a reciprocal.
bool digits_are_exponents(std::string_view unit) {
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (!is_digit(unit[i]) || (i > 0 && is_digit(unit[i - 1]))) continue;
    std::size_t before = i;
    if (before > 0 && (unit[before - 1] == '-' || unit[before - 1] == '+')) --before;
    const char c = before > 0 ? unit[before - 1] : '\0';
    const bool power = c == '^' || (c == '*' && before > 1 && unit[before - 2] == '*');
    const bool one_over = i == 0 && unit[0] == '1' && trimmed(unit.substr(1)).starts_with('/');
    if (!power && !is_letter(c) && c != ')' && !one_over) return false;
  }
  return true;
}

bool well_formed(std::string_view unit) {
  for (std::size_t i = 0; i < unit.size();) {
    const std::size_t length = unit_character(unit.substr(i));
    if (length == 0) return false;
    i += length;
  }
  return digits_are_exponents(unit);
}

Unit expected_unit(std::string_view unit) {
  auto found = find_unit(std::string{unit});
  if (!found || found->kind != UnitKind::scale) {
    throw std::invalid_argument(fmt::format("\"{}\" is not a unit", printable(unit)));
  }
  return *found;
}

std::string powers_of(const Dimension& dimension) {
  std::string powers;
  for (const auto& [symbol, power] : dimension) {
    if (!powers.empty()) powers += ' ';
    powers += power == 1 ? symbol : fmt::format("{}^{}", symbol, power);
  }
  return powers;
}

std::string name_of(const Dimension& dimension) {
  for (const auto& named : named_dimensions) {
    if (expected_unit(named.unit).dimension == dimension) return named.name;
  }
  return "a quantity in " + powers_of(dimension);
}

/// "a length such as "m"", "a pure number such as "0.02" or "2 %"".
std::string expectation(std::string_view unit, std::string_view number = "") {
  if (unit == "1") return "a pure number such as \"0.02\" or \"2 %\"";
  const std::string space = number.empty() ? "" : " ";
  return fmt::format("{} such as \"{}{}{}\"", dimension_name(unit), number, space, unit);
}

/// `unit` without blanks and signs of multiplication, in small letters.
std::string normalized(std::string_view unit) {
  std::string letters;
  for (const char c : unit) {
    if (c == ' ' || c == '.' || c == '*') continue;
    letters += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  return letters;
}

std::string suggestion(std::string_view unit, const Dimension& dimension) {
  for (const char* common : common_units) {
    if (normalized(common) != normalized(unit) || common == unit) continue;
    if (expected_unit(common).dimension == dimension) {
      return fmt::format("; did you mean \"{}\"?", common);
    }
  }
  return "";
}

struct NumberResult {
  double value{};
  std::string_view rest{};
  std::string problem{};
};

NumberResult read_number(std::string_view text, std::string_view expected) {
  NumberResult number;
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  const auto [end, status] =
      std::from_chars(digits.data(), digits.data() + digits.size(), number.value);
  const auto quoted = printable(text);
  if (status == std::errc::result_out_of_range) {
    number.problem = fmt::format("\"{}\" is out of the range of numbers", quoted);
    return number;
  }
  if (status != std::errc{} || (digits.size() != text.size() && digits.starts_with('-'))) {
    number.problem = fmt::format("\"{}\" does not start with a number, expected {}", quoted,
                                 expectation(expected, "0.5"));
    return number;
  }
  number.rest = digits.substr(static_cast<std::size_t>(end - digits.data()));
  if (!std::isfinite(number.value)) {
    number.problem = fmt::format("\"{}\" is not a finite number", quoted);
  } else if (number.rest.size() > 1 && number.rest[0] == ',' && is_digit(number.rest[1])) {
    number.problem = fmt::format("\"{}\" has a decimal comma, expected a decimal point", quoted);
  }
  return number;
}

/// Why `text`, whose unit reads `unit`, is not a quantity of the expected dimension; empty if it
/// is.
std::string unit_problem(std::string_view text, std::string_view unit,
                         const std::optional<Unit>& found, std::string_view expected,
                         const Dimension& dimension) {
  const auto quoted = printable(text);
  if (unit.empty() && !dimension.empty()) {
    return fmt::format("\"{}\" has no unit, expected {}", quoted, expectation(expected, "0.5"));
  }
  if (!found) {
    return fmt::format("\"{}\" has the unknown unit \"{}\", expected {}{}", quoted, printable(unit),
                       expectation(expected), suggestion(unit, dimension));
  }
  if (found->kind != UnitKind::scale) {
    constexpr std::array<const char*, 4> kinds{"", "a zero of its own", "a logarithmic scale",
                                               "a date as its zero"};
    return fmt::format("\"{}\" has the unit \"{}\", which has {}, expected {}", quoted,
                       printable(unit), kinds[static_cast<std::size_t>(found->kind)],
                       expectation(expected));
  }
  if (found->dimension != dimension) {
    return fmt::format("\"{}\" has the unit \"{}\" ({}), expected {}{}", quoted, printable(unit),
                       name_of(found->dimension), expectation(expected),
                       suggestion(unit, dimension));
  }
  return "";
}

QuantityResult failed(std::string problem) {
  QuantityResult result;
  result.problem = std::move(problem);
  return result;
}

}  // namespace

QuantityResult read_quantity(std::string_view text, std::string_view unit) {
  const std::string plain = with_plain_spaces(text.substr(0, longest_quantity + 1));
  const std::string_view whole = trimmed(plain);
  if (whole.empty()) {
    return failed(fmt::format("is an empty string, expected {}", expectation(unit, "0.5")));
  }
  const NumberResult number = read_number(whole, unit);
  if (!number.problem.empty()) return failed(number.problem);
  const std::string_view written = trimmed(number.rest);
  if (written.empty() && unit == "1") return {number.value, ""};

  const Unit expected = expected_unit(unit);
  std::optional<Unit> found;
  if (text.size() <= longest_quantity && !written.empty() && well_formed(written)) {
    found = find_unit(std::string{written});
  }
  auto problem = unit_problem(whole, written, found, unit, expected.dimension);
  if (!problem.empty()) return failed(std::move(problem));

  const double value = number.value * (found->factor / expected.factor);
  const bool lost = value == 0.0 && number.value != 0.0;
  if (!std::isfinite(value) || lost) {
    return failed(fmt::format("\"{}\" is out of the range of numbers", printable(whole)));
  }
  return {value, ""};
}

QuantityResult read_plain_or_quantity(std::string_view text, std::string_view unit) {
  const std::string_view whole = trimmed(text);
  const bool ends_in_number =
      !whole.empty() && std::string_view("0123456789.").find(whole.back()) != whole.npos;
  if (ends_in_number)
    if (const auto plain = read_quantity(whole, "1"); plain.ok()) return plain;
  return read_quantity(text, unit);
}

double quantity(std::string_view text, std::string_view unit) {
  const QuantityResult result = read_quantity(text, unit);
  if (!result.ok()) throw std::invalid_argument(result.problem);
  return result.value;
}

std::optional<SiUnit> si_unit(std::string_view unit) {
  if (unit.size() > longest_quantity) return {};
  const std::string plain = with_plain_spaces(unit);
  const std::string written{trimmed(plain)};
  if (written == "1") return SiUnit{1.0, "1"};
  if (written.empty() || !well_formed(written)) return {};
  const auto found = find_unit(written);
  if (!found || found->kind != UnitKind::scale) return {};
  if (found->factor == 1.0) return SiUnit{1.0, written};
  for (const auto& named : named_dimensions) {
    if (expected_unit(named.unit).dimension == found->dimension)
      return SiUnit{found->factor, std::string(named.unit)};
  }
  return SiUnit{found->factor, powers_of(found->dimension)};
}

std::string dimension_name(std::string_view unit) {
  for (const auto& named : named_dimensions) {
    if (named.unit == unit) return named.name;
  }
  return name_of(expected_unit(unit).dimension);
}

}  // namespace hydrapod::base
