#pragma once
/// Quantities as people write them, read into SI.
///
/// A quantity is a number and a unit ("700 MPa", "0.17 m", "12 deg", "2 %", "20 cm^3",
/// "500 N s/m", "kg·m²"), understood by UDUNITS-2. Angles are a dimension of their own here, so
/// that "rad/s" cannot be taken for "Hz", nor "2 %" for an angle. Only plain scales are accepted:
/// units with an offset (degC), logarithms (dB) and times since a date are refused.
///
/// The unit database is read at the first quantity that has a unit (about 3 ms), not before. All
/// functions may be called from several threads and in any locale: a number always has a point.
///
/// Mathematical constants that the standard library does not have.

#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace hydrapod::base {

inline constexpr double two_pi = 2.0 * std::numbers::pi;

/// A quantity, or why it could not be read.
struct QuantityResult {
  double value{std::numeric_limits<double>::quiet_NaN()};  ///< SI and radians; finite when read
  std::string problem{};                                   ///< empty when the quantity was read
  [[nodiscard]] bool ok() const { return problem.empty(); }
};

/// Reads `text` as a quantity of the dimension of `unit`, a coherent SI unit such as "Pa" or "N
/// s/m"; "1" stands for pure numbers, "rad" for angles. Where the dimension is not "1", the text
/// must have a unit. Throws std::invalid_argument when `unit` itself is not a unit,
/// std::runtime_error when the unit database is missing.
QuantityResult read_quantity(std::string_view text, std::string_view unit);

/// The same, and a number without unit is one in SI.
QuantityResult read_plain_or_quantity(std::string_view text, std::string_view unit);

/// read_quantity for callers that know the text to be good. Throws std::invalid_argument with the
/// problem.
double quantity(std::string_view text, std::string_view unit);

/// What is measured in `unit`, with its article: "a length" for "m"; "a quantity in …" if no word
/// is known. Throws as read_quantity does.
std::string dimension_name(std::string_view unit);

/// What one of a unit is in SI.
struct SiUnit {
  double factor{1.0};  ///< value in SI = factor × value in the unit
  std::string unit{};  ///< the coherent SI unit: as it was written where that is one, else its
                       ///< usual name ("mm" gives "m", "bar" gives "Pa", "%" gives "1")
};

/// `unit` ("mm/s", "bar", "1") against SI and radians. None where it is not known or has an offset,
/// a logarithm or a date, so that no factor leads to SI. Throws std::runtime_error when the unit
/// database is missing.
std::optional<SiUnit> si_unit(std::string_view unit);

}  // namespace hydrapod::base
