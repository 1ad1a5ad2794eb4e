#include "uff_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "axis_units.hpp"
#include "hydrapod/base/text.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

struct Quantity {
  int code;
  bool rotation;  ///< about an axis
  const char* unit;
  int length, force;  ///< exponents
};

/// Units and exponents of the quantities that have a meaning of their own. Where two have a unit in
/// common, the last one is written.
constexpr std::array quantities{Quantity{uff_quantity::stress, false, "Pa", -2, 1},
                                Quantity{uff_quantity::strain, false, "1", 0, 0},
                                Quantity{uff_quantity::displacement, false, "m", 1, 0},
                                Quantity{uff_quantity::displacement, true, "rad", 0, 0},
                                Quantity{uff_quantity::reaction_force, false, "N", 0, 1},
                                Quantity{uff_quantity::reaction_force, true, "N m", 1, 1},
                                Quantity{uff_quantity::velocity, false, "m/s", 1, 0},
                                Quantity{uff_quantity::velocity, true, "rad/s", 0, 0},
                                Quantity{uff_quantity::acceleration, false, "m/s^2", 1, 0},
                                Quantity{uff_quantity::acceleration, true, "rad/s^2", 0, 0},
                                Quantity{uff_quantity::excitation_force, false, "N", 0, 1},
                                Quantity{uff_quantity::excitation_force, true, "N m", 1, 1},
                                Quantity{uff_quantity::pressure, false, "Pa", -2, 1},
                                Quantity{uff_quantity::mass, false, "kg", -1, 1},
                                Quantity{uff_quantity::time, false, "s", 0, 0},
                                Quantity{uff_quantity::frequency, false, "Hz", 0, 0}};

std::string powers(int length, int force) {
  std::string text;
  for (const auto& [unit, power] : {std::pair{"N", force}, std::pair{"m", length}}) {
    if (power == 0) continue;
    if (!text.empty()) text += ' ';
    text += power == 1 ? unit : fmt::format("{}^{}", unit, power);
  }
  return text;
}

/// `known`: what one of the unit is in `unit`.
double abscissa_factor(const UffFunction& f, const std::optional<double>& known, const char* unit,
                       const char* accepted, Notes& notes) {
  const std::string& label = f.abscissa.unit;
  const std::string plain = plain_unit(label);
  if (plain.empty() || plain == "none" || plain == "-") return 1.0;
  if (known) return *known;
  const std::string name = base::printable(label, 30);
  if (channel_unit(label).known || plain.starts_with("rad"))  // 2π is no matter of a note
    notes.fail(fmt::format("dataset {}: the unit of its abscissa is \"{}\"; accepted are {}",
                           f.dataset, name, accepted),
               f.line);
  notes.add(fmt::format("dataset {}: the unit \"{}\" of its abscissa is unknown: taken for {}",
                        f.dataset, name, unit),
            f.line, 0, "abscissa");
  return 1.0;
}

constexpr int first_leg = static_cast<int>(Direction::leg1);

template <typename Number>
double decoded(std::string_view bytes, bool big_endian) {
  static_assert(std::endian::native == std::endian::little);
  std::array<char, sizeof(Number)> order{};
  std::copy_n(bytes.begin(), order.size(), order.begin());
  if (big_endian) std::reverse(order.begin(), order.end());
  return static_cast<double>(std::bit_cast<Number>(order));
}

}  // namespace

Direction uff_direction(const UffPlace& place) {
  for (int leg = 1; leg <= 6 && place.direction == 0; ++leg)
    if (place.entity == fmt::format("LEG {}", leg)) return leg_direction(leg);
  return static_cast<Direction>(place.direction);
}

int uff_point(const UffPlace& place) {
  return std::abs(place.node) <= 999'999'999 ? static_cast<int>(place.node) : 0;
}

std::string uff_entity(const UffPlace& place) {
  return uff_direction(place) >= leg_direction(1) ? "" : given(place.entity);
}

std::vector<std::string> uff_id_lines(const std::array<std::string, 5>& id) {
  std::vector<std::string> lines(id.begin(), id.end());
  while (!lines.empty() && given(lines.back()).empty()) lines.pop_back();
  return lines;
}

void put_id_lines(const std::vector<std::string>& lines, std::array<std::string, 5>& id) {
  if (lines.empty()) return;
  id.fill("NONE");
  std::copy_n(lines.begin(), std::min(lines.size(), id.size()), id.begin());
}

void name_by_place(std::vector<Channel>& channels) {
  std::map<std::string, int> count;
  for (const Channel& channel : channels) ++count[channel.name];
  for (Channel& channel : channels) {
    const bool placed = channel.point != 0 || channel.direction != Direction::none;
    if (!placed || (!channel.name.empty() && count[channel.name] == 1)) continue;
    if (!channel.name.empty()) channel.name += ", ";
    if (!channel.entity.empty()) channel.name += channel.entity + ' ';
    channel.name += fmt::format("node {} {}", channel.point, direction_text(channel.direction));
  }
}

UffPlace uff_place(const Channel& channel) {
  const int code = static_cast<int>(channel.direction);
  if (code < first_leg)
    return {channel.entity.empty() ? "NONE" : channel.entity, channel.point, code};
  return {fmt::format("LEG {}", code - first_leg + 1), channel.point, 0};
}

ChannelUnit uff_unit(const UffAxis& axis, int direction, const std::optional<UffUnits>& units,
                     Notes& notes) {
  const bool labelled = !given(axis.unit).empty();
  const bool named = axis.quantity <= uff_quantity::general && is_force(given(axis.label));
  const bool force_there = named || axis.quantity == uff_quantity::excitation_force ||
                           axis.quantity == uff_quantity::reaction_force;
  if (labelled) {
    const bool pounds = is_pounds(axis.unit) && force_there;
    if (pounds) notes.add(pounds_of_force(axis.unit), 0, 0, "pounds");
    const ChannelUnit by_label = channel_unit(pounds ? "lbf" : axis.unit);
    if (by_label.known) return by_label;
  }
  int length = axis.length_exponent, force = axis.force_exponent;
  std::string unit = powers(length, force);
  for (const Quantity& known : quantities) {  // without one of rotations that of translations holds
    if (known.code != axis.quantity || (known.rotation && std::abs(direction) <= 3)) continue;
    length = known.length;
    force = known.force;
    unit = known.unit;
  }
  const bool scaled = length != 0 || force != 0;
  if (unit.empty() || axis.temperature_exponent != 0 || (scaled && units && !units->usable))
    return {1.0, labelled ? axis.unit : "", !labelled};
  if (!units && scaled)
    notes.add(labelled
                  ? fmt::format("the unit label \"{}\" is unknown, and the file states no units "
                                "(dataset 164): taken as SI",
                                base::printable(given(axis.unit), 30))
                  : "a function has no unit label, and the file states no units (dataset 164): "
                    "taken as SI",
              0, 0, labelled ? "unknown label" : "no units");
  if (!units) return {1.0, unit};
  return {1.0 / (std::pow(units->length, length) * std::pow(units->force, force)), unit};
}

double uff_hertz(const UffFunction& function, Notes& notes) {
  return abscissa_factor(function, hertz_of(function.abscissa.unit, false), "Hz",
                         "Hz, kHz, rad/s and rpm", notes);
}

double uff_seconds(const UffFunction& function, Notes& notes) {
  return abscissa_factor(function, seconds_of(function.abscissa.unit), "s", "s, ms and us", notes);
}

UffAxis uff_axis_of(const std::string& label, const std::string& unit) {
  UffAxis axis{.quantity = uff_quantity::general, .label = label, .unit = unit};
  if (unit.empty()) axis.unit = "NONE";
  for (const Quantity& known : quantities) {
    if (unit != known.unit || known.code == uff_quantity::strain) continue;  // "1" is any number
    axis.quantity = known.code;
    axis.length_exponent = known.length;
    axis.force_exponent = known.force;
  }
  return axis;
}

std::size_t tuple_size(const UffFunction& function) {
  return (function.is_even ? 0U : 1U) + (function.is_complex ? 2U : 1U);
}

std::vector<int> uff_widths(const UffFunction& function) {
  if (!function.is_double) return {13, 13, 13, 13, 13, 13};
  if (function.is_even) return {20, 20, 20, 20};
  if (function.is_complex) return {13, 20, 20};
  return {13, 20, 13, 20};
}

std::vector<double> uff_line_numbers(std::string_view line, const std::vector<int>& widths,
                                     bool free_form, unsigned& bad) {
  std::vector<double> numbers;
  const auto take = [&](std::string_view field) {
    const auto number = fortran_number(field);
    if (!number && bad == 0) bad = static_cast<unsigned>(field.data() - line.data()) + 1;
    numbers.push_back(number.value_or(uff_missing));
  };
  if (free_form) {
    std::string_view rest = base::trimmed(line);
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      take(rest.substr(0, end));
      rest = base::trimmed(rest.substr(end));
    }
    return numbers;
  }
  const std::string_view text = line.substr(0, line.find_last_not_of(" \t") + 1);
  std::size_t at = 0;
  for (const int width : widths) {
    if (at >= text.size()) break;
    take(text.substr(at, static_cast<std::size_t>(width)));
    at += static_cast<std::size_t>(width);
  }
  return numbers;
}

UffValues::UffValues(const FileWindow& file, const UffFunction& function, std::size_t window)
    : function_(function),
      file_(file, window),
      offset_(function.begin),
      line_(function.data_line) {}

bool UffValues::next(double& number, Notes& notes) {
  if (function_.binary) return next_binary(number);
  while (taken_ == numbers_.size())
    if (!fill_from_line(notes)) return false;
  number = numbers_[taken_++];
  return true;
}

bool UffValues::next_binary(double& number) {
  const bool abscissa = !function_.is_even && place_in_tuple_ == 0;
  const bool wide = abscissa ? function_.wide_abscissa : function_.is_double;
  const std::size_t bytes = wide ? 8 : 4;
  if (offset_ + bytes > function_.end) return false;
  const std::string_view raw = file_.at(offset_, bytes);
  if (raw.size() < bytes) return false;
  number =
      wide ? decoded<double>(raw, function_.big_endian) : decoded<float>(raw, function_.big_endian);
  offset_ += bytes;
  place_in_tuple_ = (place_in_tuple_ + 1) % tuple_size(function_);
  return true;
}

bool UffValues::fill_from_line(Notes& notes) {
  if (offset_ >= function_.end) return false;
  const FileWindow::Line line = file_.line_at(offset_);
  unsigned bad = 0;
  numbers_ = uff_line_numbers(line.whole(), uff_widths(function_), function_.free_form, bad);
  taken_ = 0;
  if (bad > 0)
    notes.add(fmt::format("dataset {}: text where a number should be; the sample is taken as "
                          "missing",
                          function_.dataset),
              line_, line_ > 0 ? bad : 0, fmt::format("text in {}", function_.dataset));
  offset_ = line.next;
  if (line_ > 0) ++line_;
  return true;
}

}  // namespace hydrapod::data
