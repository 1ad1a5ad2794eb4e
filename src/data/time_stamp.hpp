#pragma once
/// Times of day and of a calendar as ISO 8601 writes them.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hydrapod::data {

/// A point in time, or a part of one.
struct TimeStamp {
  std::int64_t nanoseconds{};  ///< since 1970 (UTC where a zone is given), or since midnight
  int decimals{};              ///< of the seconds, as written; −1: minutes only
  bool has_date{}, has_clock{};
};

/// "2026-11-20T09:00:00.125Z": T or a blank between date and time, a point or a comma before the
/// fraction (at most nine digits count), no zone, Z, +01:00, +0100 or +01; a date alone
/// ("2026-11-20") and a time alone ("09:00:00.125") too. None for any other text.
std::optional<TimeStamp> time_stamp(std::string_view text);

/// "2026-11-20T09:00:00" and the zone: what RecordHeader::date holds.
std::string date_of_stamp(std::string_view text);

}  // namespace hydrapod::data
