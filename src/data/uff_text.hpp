#pragma once
/// Fields of Universal Files: FORTRAN's fixed columns.

#include <optional>
#include <string>
#include <string_view>

namespace hydrapod::data {

/// `width` characters: E13.5 has 5 digits after the point, E20.12 twelve. NaN is written "NaN".
std::string fortran_e(double value, int width, int digits);
/// As D25.17.
std::string fortran_d(double value);
/// Cut or padded to `width` bytes, never within a character.
std::string fortran_a(std::string_view text, std::size_t width);

/// Columns `begin` … `begin + width` of `line`, as far as it has them, without blanks around.
std::string_view columns(std::string_view line, std::size_t begin, std::size_t width);

/// A number as FORTRAN writes it: "1.5E+00", "1.5D+00", "1.5-307", "1.5". None: it is text or
/// empty.
std::optional<double> fortran_number(std::string_view field);
std::optional<long long> fortran_integer(std::string_view field);

/// "2026-11-20T09:00:00" as "20-NOV-26 09:00:00" (9A1,1X,8A1) and back; other texts stay as they
/// are.
std::string uff_date(std::string_view iso);
std::string iso_date(std::string_view uff);

}  // namespace hydrapod::data
