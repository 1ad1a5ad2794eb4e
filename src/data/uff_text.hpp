#pragma once
/// Universal Files as text: FORTRAN's fixed columns, and datasets made of them.

#include <optional>
#include <string>
#include <string_view>

#include "uff_dataset.hpp"

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

inline constexpr const char* uff_delimiter = "    -1\n";

/// 80A1, "NONE" for an empty text.
std::string uff_text_line(const std::string& text);

/// From the first delimiter to the last line before the values. Of a binary function the number of
/// bytes is that of `f.declared` values.
std::string uff_function_head(const UffFunction& f);

/// Datasets 151 and 164 (SI) and, unless `comments` is empty, hydrapod's own. `date` as in
/// RecordHeader.
std::string uff_beginning(const std::string& model, const std::string& date,
                          const std::string& comments = "");

/// Values of a function, which stand in lines unless it is binary.
class UffNumbers {
 public:
  explicit UffNumbers(const UffFunction& f) : binary_(f.binary), widths_(uff_widths(f)) {}
  void add(double number, std::string& out);
  /// Ends the last line and the dataset.
  void finish(std::string& out) const;

 private:
  bool binary_;
  std::vector<int> widths_;
  std::size_t column_{};
};

}  // namespace hydrapod::data
