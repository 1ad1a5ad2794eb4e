#pragma once
/// The numbers of a record's header as HDF5 and MAT files of hydrapod hold them. Private to the
/// readers.

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "formats.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// Version, sample rate, start and repeat. `number(name, otherwise)` reads one, and fails where it
/// is missing and nothing else will do.
template <class Number>
void read_header_numbers(const Number& number, const Notes& notes, RecordHeader& header) {
  const double version = number("format_version", std::nullopt);
  if (version != record_version)
    notes.fail(fmt::format("format_version is {}; this program reads version {}", version,
                           record_version));
  header.sample_rate = number("sample_rate_hz", std::nullopt);
  if (!(header.sample_rate > 0.0))
    notes.fail(fmt::format("sample_rate_hz is {} and must be positive", header.sample_rate));
  header.start = number("start_s", 0.0);
  const double repeat = number("repeat", 1.0);
  if (!(repeat >= 1.0) || repeat > 1e9 || repeat != std::floor(repeat))
    notes.fail(fmt::format("repeat is {} and must be a whole number, 1 or more", repeat));
  header.repeat = static_cast<int>(repeat);
}

}  // namespace hydrapod::data
