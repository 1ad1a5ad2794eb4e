/// The layout of hydrapod, and the text of any.

#include <fmt/format.h>

#include <iterator>

#include "names.hpp"

namespace hydrapod::realtime {

namespace {

constexpr std::uint64_t magic_command = 0x43445948, magic_sensors = 0x53445948;  // "HYDC", "HYDS"
constexpr std::uint64_t version = 1;
/// Packets of both kinds of legs are equally long; torques are no pressures.
constexpr std::uint64_t of_cylinders = 0, of_screws = 1;

class Builder {
 public:
  explicit Builder(Kind kind) : kind_(kind) {}

  void constant(ValueType type, std::uint64_t number) {
    add({.role = Field::Role::constant, .type = type, .number = number});
  }
  void all(std::string_view name, ValueType type = ValueType::f64, int count = 0) {
    const Name found = find_name(kind_, name).value();
    for (int i = 0; i < (count > 0 ? count : found.count); ++i)
      add({.entry = found.entry, .component = i, .type = type});
  }
  void skip(int bytes) {
    for (int i = 0; i < bytes; ++i) add({.role = Field::Role::ignored, .type = ValueType::u8});
  }
  PacketLayout closed() {
    add({.role = Field::Role::crc32, .type = ValueType::u32});
    return layout_;
  }

 private:
  void add(Field field) {
    field.at = layout_.size;
    layout_.size += size_of(field.type);
    layout_.fields.push_back(field);
  }

  Kind kind_;
  PacketLayout layout_{};
};

std::string entry_text(Kind kind, const Field& field, int count) {
  using Role = Field::Role;
  const auto type = type_name(field.type);
  if (field.role == Role::constant)
    return fmt::format("{{ name = \"constant\", type = \"{}\", value = {} }}", type, field.number);
  if (field.role == Role::ignored)
    return fmt::format("{{ name = \"ignored\", type = \"{}\" }}", type);
  if (field.role != Role::value) {
    std::string text = field.role == Role::crc32 ? "crc32" : "crc16";
    text = fmt::format("{{ name = \"{}\", type = \"{}\"", text, type);
    if (field.from > 0) text += fmt::format(", from = {}", field.from);
    if (field.number > 0) text += fmt::format(", extra = {}", field.number - 1);
    return text + " }";
  }
  const Name name = name_at(kind, field.entry);
  const bool whole_name = count == name.count;
  std::string text =
      fmt::format("{{ name = \"{}\", type = \"{}\"",
                  whole_name ? std::string(name.name) : name.component(field.component), type);
  if (field.factor != 1.0) text += fmt::format(", factor = {}", field.factor);
  if (field.offset != 0.0) text += fmt::format(", offset = {}", field.offset);
  return text + " }";
}

/// How many fields from `i` on one line can say: all components in order, alike.
int run_length(Kind kind, const std::vector<Field>& fields, std::size_t i) {
  const Field& first = fields[i];
  if (first.role != Field::Role::value || first.component != 0) return 1;
  const int count = name_at(kind, first.entry).count;
  for (int c = 1; c < count; ++c) {
    const std::size_t at = i + static_cast<std::size_t>(c);
    if (at >= fields.size()) return 1;
    const Field& next = fields[at];
    if (next.role != first.role || next.entry != first.entry || next.component != c ||
        next.type != first.type || next.factor != first.factor || next.offset != first.offset)
      return 1;
  }
  return count;
}

std::string place_text(Kind kind, const Field& field, int count) {
  const std::size_t end = field.at + static_cast<std::size_t>(count) * size_of(field.type);
  std::string text = fmt::format("# {:4} … {:4}", field.at, end - 1);
  if (field.role != Field::Role::value) return text;
  const Name name = name_at(kind, field.entry);
  if (name.whole) return text;
  const auto unit = name.unit_of(field.component);
  if (count > 1 && name.directions)
    return text + fmt::format("  x y z {}, rx ry rz {}", unit, name.angular);
  return text + fmt::format("  {}{}", count > 1 ? fmt::format("1 … {} ", count) : "", unit);
}

std::string packet_text(Kind kind, const PacketLayout& layout) {
  std::string text = kind == Kind::command ? "command = [" : "sensors = [";
  text += fmt::format("  # {} bytes\n", layout.size);
  for (std::size_t i = 0; i < layout.fields.size();) {
    const int count = run_length(kind, layout.fields, i);
    text += fmt::format("  {:<58} {}\n", entry_text(kind, layout.fields[i], count) + ",",
                        place_text(kind, layout.fields[i], count));
    i += static_cast<std::size_t>(count);
  }
  return text + "]\n";
}

}  // namespace

Layout native_layout(int accelerometers, model::LegType legs) {
  const bool drives = legs == model::LegType::screw;
  Builder command(Kind::command);
  command.constant(ValueType::u32, magic_command);
  command.constant(ValueType::u16, version);
  command.all("mode", ValueType::u8);
  command.all("flags", ValueType::u8);
  for (const char* name : {"session", "sequence", "time"}) command.all(name, ValueType::u64);
  for (const char* name : {"displacement", "rate", "drive", "wrench", "next_wrench"})
    command.all(name);
  Builder sensors(Kind::sensors);
  sensors.constant(ValueType::u32, magic_sensors);
  sensors.constant(ValueType::u16, version);
  sensors.all("state", ValueType::u8);
  sensors.constant(ValueType::u8, drives ? of_screws : of_cylinders);
  for (const char* name : {"session", "sequence", "time", "answered", "echo"})
    sensors.all(name, ValueType::u64);
  for (const char* name : {"deadline_misses", "accepted", "superseded", "missed", "lost",
                           "reordered", "duplicated", "malformed", "refused", "out_of_range"})
    sensors.all(name, ValueType::u32);
  sensors.all("trips", ValueType::u32);
  sensors.skip(4);
  for (const char* name :
       {"length", drives ? "torque" : "cap_pressure", drives ? "motor_speed" : "rod_pressure",
        "piston_acceleration", "valve", drives ? "nut" : "spool", "platform", "velocity",
        "acceleration", "supply_pressure"})
    sensors.all(name);
  if (accelerometers > 0) sensors.all("accelerometer", ValueType::f64, accelerometers);
  return {.command = command.closed(), .sensors = sensors.closed()};
}

std::string layout_text(const Layout& layout) {
  return fmt::format(
      "# Packets of `hydrapod serve`, byte by byte. With --key another {} bytes follow: "
      "HMAC-SHA256.\n"
      "byte_order = \"{}\"\n\n{}\n{}",
      mac_size, layout.big_endian ? "big" : "little", packet_text(Kind::command, layout.command),
      packet_text(Kind::sensors, layout.sensors));
}

}  // namespace hydrapod::realtime
