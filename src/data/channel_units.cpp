#include "channel_units.hpp"

#include <fmt/format.h>

#include <array>
#include <map>

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
    Alias{"msec", "ms"}, Alias{"grad", "deg"}, Alias{"Grad", "deg"}, Alias{"°", "deg"},
    Alias{"deg/sec", "deg/s"}, Alias{"m/sec", "m/s"}, Alias{"l/min", "litre/minute"},
    Alias{"m/sec^2", "m/s^2"}, Alias{"mm/sec", "mm/s"}, Alias{"kp", "kgf"},
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

}  // namespace

ChannelUnit channel_unit(std::string_view written) {
  std::string unit(base::trimmed(clean_text(written)));
  if (unit.empty()) return {};
  for (const auto& [name, count] : gravities)
    if (unit == name) return {count * standard_gravity, "m/s^2"};
  for (std::size_t at; (at = unit.find("**")) != std::string::npos;) unit.replace(at, 2, "^");
  for (const Alias& alias : aliases)
    if (unit == alias.written) unit = alias.meant;
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
                    name, base::printable(written.empty() ? unit.unit : written, 30)));
  else if (unit.factor != 1.0)
    notes.add(
        fmt::format("channel \"{}\": {}converted to \"{}\", times {}", name,
                    written.empty() ? "" : fmt::format("\"{}\" ", base::printable(written, 30)),
                    unit.unit, unit.factor));
  channel.unit = unit.unit;
  return unit.factor;
}

std::vector<double> to_si(std::vector<Channel>& channels, Notes& notes, bool by_hydrapod) {
  std::vector<double> factors;
  for (Channel& channel : channels) {
    ChannelUnit unit = channel_unit(channel.unit);
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
