#pragma once
/// Units of frequencies, times and phases, as measuring programs write them.

#include <optional>
#include <string>
#include <string_view>

namespace hydrapod::data {

/// A unit without blanks and brackets around, in small letters.
std::string plain_unit(std::string_view written);

/// What one of a unit of frequencies is in Hz. `circular`: they are called omega, so that no unit
/// and 1/s mean rad/s. None where it is no such unit, or 1/s, which may be Hz or rad/s.
std::optional<double> hertz_of(std::string_view unit, bool circular);

/// Why hertz_of() gives none: the end of a sentence about "the unit … of the frequencies".
std::string frequency_problem(std::string_view unit);

/// What one of a unit of sample rates is in Hz: here 1/s is Hz. No unit is Hz.
std::optional<double> rate_of(std::string_view unit);

/// What one of a unit of times is in seconds. No unit is s.
std::optional<double> seconds_of(std::string_view unit);

/// What one of a unit of phases is in radians: "DEG", "deg." and "º" are degrees, "grad" is gon
/// (400 per turn).
std::optional<double> radians_of(std::string_view unit);

}  // namespace hydrapod::data
