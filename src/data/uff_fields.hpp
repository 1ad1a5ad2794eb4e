#pragma once
/// Fields of the lines of a Universal File that is being scanned.

#include <string>
#include <string_view>

#include "uff_dataset.hpp"

namespace hydrapod::data {

/// A dataset that cannot be used; the scan goes on behind it.
struct Unusable {
  std::string why;
};

// Columns begin at 0; all throw Unusable, naming the field as `what`. An empty field is 0.
long long uff_integer(std::string_view line, std::size_t begin, std::size_t width,
                      const char* what);
/// One from `least` to `most`.
int uff_small(std::string_view line, std::size_t begin, std::size_t width, const char* what,
              long long least, long long most);
/// A finite number.
double uff_real(std::string_view line, std::size_t begin, std::size_t width, const char* what);
/// Text without blanks around, as UTF-8.
std::string uff_field(std::string_view line, std::size_t begin, std::size_t width);
UffPlace uff_place_at(std::string_view line, std::size_t begin, const char* what);
UffAxis uff_axis(std::string_view line);

}  // namespace hydrapod::data
