#include "time_stamp.hpp"

#include <chrono>
#include <cstdlib>

namespace hydrapod::data {

namespace {

constexpr std::int64_t one_second = 1'000'000'000;  // [ns]
constexpr std::size_t date_letters = 10, clock_letters = 8;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes a text apart from its front.
class StampText {
 public:
  explicit StampText(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  bool take(std::string_view any_of) {
    if (rest_.empty() || any_of.find(rest_.front()) == any_of.npos) return false;
    rest_.remove_prefix(1);
    return true;
  }
  /// Exactly `digits` of them.
  std::optional<int> number(std::size_t digits) {
    if (rest_.size() < digits) return {};
    int value = 0;
    for (std::size_t i = 0; i < digits; ++i) {
      if (!is_digit(rest_[i])) return {};
      value = 10 * value + (rest_[i] - '0');
    }
    rest_.remove_prefix(digits);
    return value;
  }
  /// All digits that follow, as a fraction of a second.
  std::int64_t fraction(int& decimals) {
    std::int64_t value = 0, unit = one_second / 10;
    for (decimals = 0; !rest_.empty() && is_digit(rest_.front()); ++decimals, unit /= 10) {
      value += (rest_.front() - '0') * unit;
      rest_.remove_prefix(1);
    }
    return value;
  }

 private:
  std::string_view rest_;
};

std::optional<std::int64_t> date_seconds(StampText& text) {
  const auto year = text.number(4);
  if (!year || !text.take("-")) return {};
  const auto month = text.number(2);
  if (!month || !text.take("-")) return {};
  const auto day = text.number(2);
  if (!day) return {};
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return {};
  const std::int64_t seconds =
      std::chrono::seconds(std::chrono::sys_days(date).time_since_epoch()).count();
  constexpr std::int64_t most = 9'000'000'000;  // in nanoseconds, of 64 bits
  return std::abs(seconds) <= most ? std::optional(seconds) : std::nullopt;
}

/// Hours and minutes, seconds, fraction; none where that is no time of day.
bool take_clock(StampText& text, TimeStamp& stamp) {
  constexpr int most_hour = 24, most_minute = 59, most_second = 60;  // of a leap second
  const auto hour = text.number(2);
  if (!hour || *hour > most_hour || !text.take(":")) return false;
  const auto minute = text.number(2);
  if (!minute || *minute > most_minute) return false;
  std::int64_t seconds = 3600LL * *hour + 60LL * *minute;
  stamp.decimals = -1;
  stamp.has_clock = true;
  if (text.take(":")) {
    const auto whole = text.number(2);
    if (!whole || *whole > most_second) return false;
    seconds += *whole;
    stamp.decimals = 0;
    if (text.take(".,")) stamp.nanoseconds += text.fraction(stamp.decimals);
  }
  stamp.nanoseconds += seconds * one_second;
  return true;
}

bool take_zone(StampText& text, TimeStamp& stamp) {
  if (text.at_end() || text.take("Z")) return true;
  const bool ahead = text.take("+");
  if (!ahead && !text.take("-")) return false;
  const auto hours = text.number(2);
  if (!hours) return false;
  text.take(":");
  const auto minutes = text.at_end() ? std::optional(0) : text.number(2);
  if (!minutes) return false;
  const std::int64_t offset = (3600LL * *hours + 60LL * *minutes) * one_second;
  stamp.nanoseconds += ahead ? -offset : offset;
  return true;
}

}  // namespace

std::optional<TimeStamp> time_stamp(std::string_view text) {
  TimeStamp stamp;
  StampText rest(text);
  if (text.size() >= date_letters && text[4] == '-') {
    const auto days = date_seconds(rest);
    if (!days) return {};
    stamp.has_date = true;
    stamp.nanoseconds = *days * one_second;
    if (rest.at_end()) return stamp;
    if (!rest.take("T ")) return {};
  }
  if (!take_clock(rest, stamp)) return {};
  if (stamp.has_date && !take_zone(rest, stamp)) return {};
  return rest.at_end() ? std::optional(stamp) : std::nullopt;
}

std::string date_of_stamp(std::string_view text) {
  std::string date(text.substr(0, date_letters + 1 + clock_letters));
  if (date.size() > date_letters) date[date_letters] = 'T';
  const std::size_t zone = text.find_first_of("Z+-", date.size());
  return zone == text.npos ? date : date + std::string(text.substr(zone));
}

}  // namespace hydrapod::data
