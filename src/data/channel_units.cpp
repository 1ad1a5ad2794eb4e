#include "channel_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::data {

namespace {

struct Alias {
  std::string_view written;
  std::string_view meant;
};
constexpr std::array aliases{
    Alias{"-", "1"}, Alias{"Nm", "N m"}, Alias{"kNm", "kN m"}, Alias{"sec", "s"},
    Alias{"msec", "ms"}, Alias{"grad", "grade"}, Alias{"gon", "grade"}, Alias{"Grad", "deg"},
    Alias{"°", "deg"}, Alias{"deg/sec", "deg/s"}, Alias{"m/sec", "m/s"},
    Alias{"l/min", "litre/minute"}, Alias{"m/sec^2", "m/s^2"}, Alias{"mm/sec", "mm/s"},
    Alias{"kp", "kgf"},
    // nobody measures in powers of milliseconds
    Alias{"ms-1", "m/s"}, Alias{"ms^-1", "m/s"}, Alias{"ms⁻¹", "m/s"}, Alias{"ms-2", "m/s^2"},
    Alias{"ms^-2", "m/s^2"}, Alias{"ms⁻²", "m/s^2"}, Alias{"mms-1", "mm/s"},
    Alias{"mms-2", "mm/s^2"}};

/// Of the acceleration of gravity, not grammes: what is recorded in mg is an acceleration.
struct Gravities {
  std::string_view written;
  double count;
};
constexpr std::array gravities{Gravities{"g", 1.0},   Gravities{"gn", 1.0},  Gravities{"g_n", 1.0},
                               Gravities{"G", 1.0},   Gravities{"mg", 1e-3}, Gravities{"mG", 1e-3},
                               Gravities{"µg", 1e-6}, Gravities{"μg", 1e-6}, Gravities{"ug", 1e-6}};
constexpr double standard_gravity = 9.80665;  // [m/s²]

constexpr std::array moments{Alias{"ft", "lb"}, Alias{"ft", "lbs"}, Alias{"ft", "lbf"},
                             Alias{"in", "lb"}, Alias{"in", "lbs"}, Alias{"in", "lbf"}};

/// The time [s] that a unit of jerk, "g/s", "mg/ms" or "g s^-1", has below this one of gravity. No
/// channel of a machine is a flow of grammes.
std::optional<double> seconds_below(std::string_view unit, std::string_view gravity) {
  if (!unit.starts_with(gravity)) return {};
  std::string_view rest = base::trimmed(unit.substr(gravity.size()));
  if (!rest.starts_with('/')) {
    constexpr std::array<std::string_view, 4> powers{"s-1", "s^-1", "s**-1", "s⁻¹"};
    for (const std::string_view times : {"*", ".", "·"})
      if (rest.starts_with(times)) rest = base::trimmed(rest.substr(times.size()));
    const bool apart = unit.size() > gravity.size() + rest.size();
    if (!apart || std::ranges::find(powers, rest) == powers.end()) return {};
    return 1.0;
  }
  const ChannelUnit below = channel_unit(rest.substr(1));
  return below.known && below.unit == "s" ? std::optional(below.factor) : std::nullopt;
}

/// "ft-lb", "lb in", "in.lbf": pounds are forces there.
std::string with_moments(const std::string& unit) {
  for (const auto& [length, force] : moments)
    for (const auto between : {"-", " ", ".", "*", "·", ""})
      if (unit == fmt::format("{}{}{}", length, between, force) ||
          unit == fmt::format("{}{}{}", force, between, length))
        return fmt::format("{} lbf", length);
  return unit;
}

/// A unit, and what stood behind it.
struct Marked {
  std::string unit{}, mark{};
};

/// "bar(g)", "kPa abs", "psia": what a pressure is counted from is no factor.
std::optional<Marked> with_mark_of_pressure(const std::string& written) {
  constexpr std::array<std::string_view, 9> pressures{"mbar", "bar", "psi", "ksi", "hPa",
                                                      "kPa",  "MPa", "Pa",  "inHg"};
  constexpr std::array<std::string_view, 8> marks{"g",   "a",     "d",    "abs",
                                                  "rel", "gauge", "diff", "absolute"};
  for (const auto pressure : pressures) {
    if (!base::lower_case(written).starts_with(base::lower_case(std::string(pressure)))) continue;
    const std::string rest = written.substr(pressure.size());
    std::string mark = base::lower_case(rest);
    std::erase_if(
        mark, [](char c) { return std::string_view(" ()_.").find(c) != std::string_view::npos; });
    if (std::ranges::find(marks, mark) == marks.end()) continue;
    const bool joined = rest[0] != ' ' && rest[0] != '(' && rest[0] != '_';
    if (joined && (pressure == "Pa" || pressure == "hPa" || mark.size() > 1)) continue;
    return Marked{std::string(pressure), std::string(base::trimmed(rest))};
  }
  return {};
}

/// "m/s2 pk", "g (rms)": samples are what they are.
std::optional<Marked> with_mark_of_value(const std::string& written) {
  constexpr std::array<std::string_view, 21> marks{
      "pk",   "pk-pk",     "pkpk",      "pk pk",        "p-p",  "pp",  "pk/pk",
      "peak", "peak-peak", "peak peak", "peak to peak", "0-pk", "0-p", "zero-peak",
      "rms",  "eff",       "avg",       "mean",         "max",  "ac",  "dc"};
  for (std::size_t at = 1; at < written.size(); ++at) {
    if (written[at] != ' ' && written[at] != '(' && written[at] != '_') continue;
    std::string mark = base::lower_case(written.substr(at + 1));
    if (const auto open = mark.find_first_not_of(" (_"); open != std::string::npos)
      mark = mark.substr(open);
    if (mark.ends_with(')')) mark.pop_back();
    if (std::ranges::find(marks, base::trimmed(mark)) == marks.end()) continue;
    return Marked{std::string(base::trimmed(written.substr(0, at))),
                  std::string(base::trimmed(written.substr(at)))};
  }
  return {};
}

/// Short symbols that UDUNITS-2 knows and nobody records in: pecks, ares, stilbs, barns, hours as
/// a factor. Written behind a unit they are a mark that is not known.
bool has_odd_symbol(std::string_view unit) {
  constexpr std::array<std::string_view, 24> odd{"pk", "a",  "b",  "u",  "sb", "p",  "z",   "y",
                                                 "gr", "dr", "bu", "ph", "nt", "ci", "sv",  "r",
                                                 "at", "c",  "cd", "e",  "f",  "gp", "bev", "tsp"};
  std::size_t words = 0;
  bool is_odd = false;
  for (std::size_t at = 0; at < unit.size();) {
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    if (!is_letter(unit[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < unit.size() && is_letter(unit[end])) ++end;
    is_odd = is_odd || std::ranges::find(odd, unit.substr(at, end - at)) != odd.end();
    // as a factor behind a unit: not over something, and not to a power
    const bool behind = words > 0 && unit[at - 1] == ' ';
    is_odd = is_odd || (behind && unit.substr(at) == "min");
    ++words;
    at = end;
  }
  return is_odd;
}

}  // namespace

bool is_pounds(std::string_view written) {
  written = base::trimmed(written);
  return written == "lb" || written == "lbs";
}

std::string pounds_of_force(std::string_view written) {
  return fmt::format("\"{}\" is taken for lbf, pounds of force",
                     base::printable(base::trimmed(written)));
}

bool is_force(const std::string& name) {
  const std::string low = base::lower_case(name);
  for (const std::string_view word : {"force", "load", "kraft", "hammer", "impact", "thrust"})
    if (low.find(word) != low.npos) return true;
  if (low.empty() || low[0] != 'f') return false;
  return low.find_first_not_of("0123456789xyz _-+", 1) == low.npos;
}

ChannelUnit channel_unit(std::string_view written) {
  std::string unit(base::trimmed(clean_text(written)));
  if (unit.empty()) return {};
  auto marked = with_mark_of_pressure(unit);
  if (!marked) marked = with_mark_of_value(unit);
  if (marked && !marked->unit.empty()) {
    ChannelUnit found = channel_unit(marked->unit);
    if (found.known && found.left_aside.empty()) {
      found.left_aside = marked->mark;
      return found;
    }
  }
  for (const auto& [name, count] : gravities) {
    if (unit == name) return {count * standard_gravity, "m/s^2"};
    if (const auto seconds = seconds_below(unit, name))
      return {count * standard_gravity / *seconds, "m/s^3"};
  }
  for (std::size_t at; (at = unit.find("**")) != std::string::npos;) unit.replace(at, 2, "^");
  for (const Alias& alias : aliases)
    if (unit == alias.written) unit = alias.meant;
  unit = with_moments(unit);
  if (has_odd_symbol(unit)) return {1.0, "", false};  // a record refuses what is not SI
  if (const auto si = base::si_unit(unit)) return {si->factor, si->unit};
  return {1.0, unit, false};
}

double use_unit(Channel& channel, const ChannelUnit& unit, const std::string& written,
                Notes& notes) {
  const std::string name = base::printable(channel.name);
  if (!unit.known)
    notes.add(
        fmt::format("channel \"{}\": the unit \"{}\" is not known or has an offset; its "
                    "samples are left as they are",
                    name, base::printable(written.empty() ? unit.unit : clean_text(written), 30)));
  else if (unit.factor != 1.0)
    notes.add(fmt::format(
        "channel \"{}\": {}converted to \"{}\", times {}", name,
        written.empty() ? "" : fmt::format("\"{}\" ", base::printable(clean_text(written), 30)),
        unit.unit, unit.factor));
  if (!unit.left_aside.empty())
    notes.add(fmt::format("channel \"{}\": \"{}\" behind its unit is left aside", name,
                          base::printable(unit.left_aside, 30)));
  channel.unit = unit.unit;
  return unit.factor;
}

std::vector<double> to_si(std::vector<Channel>& channels, Notes& notes, bool by_hydrapod) {
  std::vector<double> factors;
  for (Channel& channel : channels) {
    const bool pounds = !by_hydrapod && is_pounds(channel.unit) &&
                        (is_force(channel.name) || channel.role == Role::excitation);
    if (pounds)
      notes.add(fmt::format("channel \"{}\": {}", base::printable(channel.name),
                            pounds_of_force(channel.unit)));
    ChannelUnit unit = channel_unit(pounds ? "lbf" : channel.unit);
    unit.known = unit.known || by_hydrapod;
    factors.push_back(use_unit(channel, unit, channel.unit, notes));
  }
  return factors;
}

void make_names_unique(std::vector<Channel>& channels) {
  std::map<std::string, int> names;  // with the number that the next one of that name gets
  for (std::size_t c = 0; c < channels.size(); ++c) {
    std::string name(base::trimmed(clean_text(channels[c].name)));
    if (name.empty()) name = fmt::format("channel {}", c + 1);
    std::string unique = name;
    while (!names.emplace(unique, 2).second) unique = fmt::format("{} ({})", name, names[name]++);
    channels[c].name = unique;
  }
}

std::string clean_text(std::string_view text, bool several_lines) {
  const bool utf8 = base::first_invalid_utf8(text) == std::string_view::npos;
  std::string clean;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool kept = several_lines && (c == '\n' || c == '\r' || c == '\t');
    if ((byte < 0x20 && !kept) || byte == 0x7F) {
      clean += ' ';
    } else if (utf8 || byte < 0x80) {
      clean += c;
    } else {
      clean += static_cast<char>(0xC0 | (byte >> 6));
      clean += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return clean;
}

}  // namespace hydrapod::data
