#include <fmt/format.h>

#include <array>
#include <cmath>

#include "uff_dataset.hpp"

namespace hydrapod::data {

namespace {

struct Quantity {
  int code;
  int length, force, temperature;  ///< exponents
  const char* unit;
  const char* rotation_unit;  ///< about an axis
  int rotation_length;
};

/// Units and exponents of the quantities that have a meaning of their own.
constexpr std::array quantities{
    Quantity{uff_quantity::stress, -2, 1, 0, "Pa", "Pa", -2},
    Quantity{uff_quantity::strain, 0, 0, 0, "1", "1", 0},
    Quantity{uff_quantity::displacement, 1, 0, 0, "m", "rad", 0},
    Quantity{uff_quantity::reaction_force, 0, 1, 0, "N", "N m", 1},
    Quantity{uff_quantity::velocity, 1, 0, 0, "m/s", "rad/s", 0},
    Quantity{uff_quantity::acceleration, 1, 0, 0, "m/s^2", "rad/s^2", 0},
    Quantity{uff_quantity::excitation_force, 0, 1, 0, "N", "N m", 1},
    Quantity{uff_quantity::pressure, -2, 1, 0, "Pa", "Pa", -2},
    Quantity{uff_quantity::mass, -1, 1, 0, "kg", "kg", -1},
    Quantity{uff_quantity::time, 0, 0, 0, "s", "s", 0},
    Quantity{uff_quantity::frequency, 0, 0, 0, "Hz", "Hz", 0}};

std::string powers(int length, int force) {
  if (length == 0 && force == 0) return "";
  std::string text;
  const auto add = [&](const char* unit, int power) {
    if (power == 0) return;
    if (!text.empty()) text += ' ';
    text += power == 1 ? unit : fmt::format("{}^{}", unit, power);
  };
  add("N", force);
  add("m", length);
  return text;
}

constexpr int first_leg = static_cast<int>(Direction::leg1);

}  // namespace

Direction uff_direction(const UffPlace& place) {
  for (int leg = 1; leg <= 6 && place.direction == 0; ++leg)
    if (place.entity == fmt::format("LEG {}", leg)) return leg_direction(leg);
  return static_cast<Direction>(place.direction);
}

UffPlace uff_place(const Channel& channel) {
  const int code = static_cast<int>(channel.direction);
  if (code < first_leg) return {"NONE", channel.point, code};
  return {fmt::format("LEG {}", code - first_leg + 1), channel.point, 0};
}

ChannelUnit uff_unit(const UffAxis& axis, int direction, const std::optional<UffUnits>& units) {
  const bool labelled = !axis.unit.empty() && axis.unit != "NONE";
  if (labelled) {
    const ChannelUnit by_label = channel_unit(axis.unit);
    if (by_label.known) return by_label;
  }
  int length = axis.length_exponent, force = axis.force_exponent;
  std::string unit = powers(length, force);
  for (const Quantity& known : quantities) {
    if (known.code != axis.quantity) continue;
    const bool rotation = std::abs(direction) > 3;
    length = rotation ? known.rotation_length : known.length;
    force = known.force;
    unit = rotation ? known.rotation_unit : known.unit;
  }
  if (unit.empty()) return {1.0, labelled ? axis.unit : "", !labelled};
  if (!units) return {1.0, unit};
  return {1.0 / (std::pow(units->length, length) * std::pow(units->force, force)), unit};
}

}  // namespace hydrapod::data
