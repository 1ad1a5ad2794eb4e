#include "axis_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "channel_units.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::data {

namespace {

struct Spelling {
  std::string_view written;  ///< in small letters
  double factor;
};

constexpr std::array frequency_spellings{Spelling{"hz", 1.0},
                                         Spelling{"hertz", 1.0},
                                         Spelling{"cycles/s", 1.0},
                                         Spelling{"khz", 1e3},
                                         Spelling{"rpm", 1.0 / 60.0},
                                         Spelling{"1/min", 1.0 / 60.0},
                                         Spelling{"rad/s", 1.0 / base::two_pi},
                                         Spelling{"rad/sec", 1.0 / base::two_pi},
                                         Spelling{"rads/s", 1.0 / base::two_pi},
                                         Spelling{"rads/sec", 1.0 / base::two_pi},
                                         Spelling{"radians/s", 1.0 / base::two_pi},
                                         Spelling{"radians/sec", 1.0 / base::two_pi}};
constexpr std::array rate_spellings{Spelling{"samples/s", 1.0},
                                    Spelling{"samples/sec", 1.0},
                                    Spelling{"samples/second", 1.0},
                                    Spelling{"samples per second", 1.0},
                                    Spelling{"sps", 1.0},
                                    Spelling{"1/second", 1.0},
                                    Spelling{"sa/s", 1.0},
                                    Spelling{"s/s", 1.0}};
constexpr std::array time_spellings{
    Spelling{"s", 1.0},   Spelling{"sec", 1.0},   Spelling{"second", 1.0}, Spelling{"seconds", 1.0},
    Spelling{"ms", 1e-3}, Spelling{"msec", 1e-3}, Spelling{"us", 1e-6},    Spelling{"usec", 1e-6}};

std::optional<double> spelt(const auto& list, const std::string& plain) {
  const auto at = std::ranges::find(list, plain, &Spelling::written);
  if (at == list.end()) return {};
  return at->factor;
}

bool is_one_over_seconds(std::string_view unit) {
  constexpr std::array<std::string_view, 5> written{"1/s", "s^-1", "s-1", "s**-1", "1/sec"};
  return std::ranges::find(written, plain_unit(unit)) != written.end();
}

}  // namespace

std::string plain_unit(std::string_view written) {
  written = base::trimmed(written);
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}})
    if (written.size() > 1 && written.front() == open && written.back() == close)
      written = base::trimmed(written.substr(1, written.size() - 2));
  return base::lower_case(std::string(written));
}

std::optional<double> hertz_of(std::string_view unit, bool circular) {
  const std::string plain = plain_unit(unit);
  if (plain.empty()) return circular ? 1.0 / base::two_pi : 1.0;
  if (is_one_over_seconds(unit)) {
    if (!circular) return {};
    return 1.0 / base::two_pi;
  }
  if (const auto known = spelt(frequency_spellings, plain)) return known;
  const ChannelUnit found = channel_unit(unit);
  if (!found.known) return {};
  if (found.unit == "rad/s") return found.factor / base::two_pi;
  if (found.unit == "Hz" || (found.unit == "1/s" && plain.ends_with("hz"))) return found.factor;
  return {};
}

std::string frequency_problem(std::string_view unit) {
  if (is_one_over_seconds(unit))
    return "may mean Hz or rad/s; state one of these, or call the frequencies omega where they are "
           "in rad/s";
  return "is unknown; accepted are Hz, kHz and rad/s";
}

std::optional<double> rate_of(std::string_view unit) {
  const std::string plain = plain_unit(unit);
  if (is_one_over_seconds(unit)) return 1.0;
  if (const auto known = spelt(rate_spellings, plain)) return known;
  if (plain.starts_with("rad")) return {};
  return hertz_of(unit, false);
}

std::optional<double> seconds_of(std::string_view unit) {
  const std::string plain = plain_unit(unit);
  if (plain.empty()) return 1.0;
  if (const auto known = spelt(time_spellings, plain)) return known;
  const ChannelUnit found = channel_unit(unit);
  if (!found.known || found.unit != "s") return {};
  return found.factor;
}

std::optional<double> radians_of(std::string_view unit) {
  const std::string written(base::trimmed(unit));
  if (written == "Grad") return channel_unit(written).factor;  // degrees in German
  std::string plain = plain_unit(unit);
  if (plain.ends_with('.')) plain.pop_back();
  if (plain == "º") plain = "°";
  if (plain == "grad" && written != "grad") return {};  // "GRAD" may be either
  const ChannelUnit found = channel_unit(plain);
  if (!found.known || found.unit != "rad") return {};
  return found.factor;
}

}  // namespace hydrapod::data
