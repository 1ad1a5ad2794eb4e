#include "hydrapod/data/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::data {

namespace {

struct NamedDirection {
  Direction direction;
  std::string_view text;
};
using enum Direction;
constexpr std::array named_directions{
    NamedDirection{none, ""},        NamedDirection{x, "x"},
    NamedDirection{y, "y"},          NamedDirection{z, "z"},
    NamedDirection{rx, "rx"},        NamedDirection{ry, "ry"},
    NamedDirection{rz, "rz"},        NamedDirection{minus_x, "-x"},
    NamedDirection{minus_y, "-y"},   NamedDirection{minus_z, "-z"},
    NamedDirection{minus_rx, "-rx"}, NamedDirection{minus_ry, "-ry"},
    NamedDirection{minus_rz, "-rz"}, NamedDirection{leg1, "leg 1"},
    NamedDirection{leg2, "leg 2"},   NamedDirection{leg3, "leg 3"},
    NamedDirection{leg4, "leg 4"},   NamedDirection{leg5, "leg 5"},
    NamedDirection{leg6, "leg 6"}};

constexpr std::array<std::string_view, 4> role_names{"excitation", "drive", "response", "other"};

constexpr int most_point = 999'999'999;

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("record: " + what);
}

void require_line(const std::string& what, const std::string& text) {
  if (base::first_invalid_utf8(text) != std::string::npos) refuse(what + " is not UTF-8");
  if (std::any_of(text.begin(), text.end(), is_control))
    refuse(
        fmt::format("{} \"{}\" has line ends or control characters", what, base::printable(text)));
}

void require_text(const std::string& what, const std::string& text) {
  if (base::first_invalid_utf8(text) != std::string::npos) refuse(what + " are not UTF-8");
  const auto bad = [](char c) { return is_control(c) && c != '\n' && c != '\r' && c != '\t'; };
  if (std::any_of(text.begin(), text.end(), bad)) refuse(what + " have control characters");
}

void require_unit(const Channel& channel) {
  require_line("the unit of channel " + channel.name, channel.unit);
  const auto si = base::si_unit(channel.unit);
  if (si && si->factor != 1.0)
    refuse(fmt::format("the unit \"{}\" of channel {} is not SI; samples must be in {}",
                       channel.unit, channel.name, si->unit));
}

}  // namespace

std::string_view direction_text(Direction direction) {
  for (const auto& named : named_directions)
    if (named.direction == direction) return named.text;
  throw std::invalid_argument(
      fmt::format("direction_text: {} is no direction", static_cast<int>(direction)));
}

std::optional<Direction> direction_from_text(std::string_view text) {
  for (const auto& named : named_directions)
    if (named.text == text) return named.direction;
  return {};
}

Direction leg_direction(int number) {
  if (number < 1 || number > 6)
    throw std::invalid_argument(fmt::format("leg_direction: there is no leg {}", number));
  return static_cast<Direction>(static_cast<int>(leg1) + number - 1);
}

std::string_view role_text(Role role) { return role_names.at(static_cast<std::size_t>(role)); }

std::optional<Role> role_from_text(std::string_view text) {
  const auto at = std::find(role_names.begin(), role_names.end(), text);
  if (at == role_names.end()) return {};
  return static_cast<Role>(at - role_names.begin());
}

void validate(const RecordHeader& header) {
  if (header.channels.empty()) refuse("has no channel");
  if (!(header.sample_rate > 0.0) || !std::isfinite(header.sample_rate))
    refuse(fmt::format("the sample rate is {} Hz and must be positive", header.sample_rate));
  if (!std::isfinite(header.start)) refuse("the start is not a finite time");
  if (header.repeat < 1) refuse(fmt::format("repeat {} is below 1", header.repeat));
  require_line("the title", header.title);
  require_line("the date", header.date);
  require_text("the notes", header.notes);
  require_text("the machine file's lines", header.experiment.machine);
  experiment_json(header.experiment);
  geometry_json(header.geometry);
  for (const Channel& channel : header.channels) {
    require_line("the part a channel belongs to", channel.entity);
    for (const std::string& line : channel.id_lines)
      require_line("what is said of a channel", line);
  }
  std::set<std::string_view> names;
  for (const Channel& channel : header.channels) {
    if (channel.name.empty()) refuse("a channel has no name");
    require_line("the name of a channel", channel.name);
    if (base::trimmed(channel.name) != channel.name)  // readers take blanks off
      refuse(fmt::format("the name of channel \"{}\" begins or ends with a blank", channel.name));
    if (!names.insert(channel.name).second)
      refuse(fmt::format("two channels are called \"{}\"", channel.name));
    require_unit(channel);
    if (channel.point < -most_point || channel.point > most_point)
      refuse(fmt::format("point {} of channel {} has more than nine digits", channel.point,
                         channel.name));
    direction_text(channel.direction);
  }
}

std::optional<std::size_t> find_channel(const RecordHeader& header, std::string_view name) {
  for (std::size_t c = 0; c < header.channels.size(); ++c)
    if (header.channels[c].name == name) return c;
  return {};
}

std::optional<std::size_t> find_channel(const RecordHeader& header, Role role,
                                        Direction direction) {
  std::optional<std::size_t> found;
  for (std::size_t c = 0; c < header.channels.size(); ++c) {
    if (header.channels[c].role != role || header.channels[c].direction != direction) continue;
    if (found) return {};
    found = c;
  }
  return found;
}

}  // namespace hydrapod::data
