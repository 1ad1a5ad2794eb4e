#include "names.hpp"

#include <fmt/format.h>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::realtime {

namespace {

template <auto Member, class Packet>
std::uint64_t* whole(Packet& packet) {
  return &(packet.*Member);
}
template <auto Member>
std::uint64_t* counter(Sensors& sensors) {
  return &(sensors.counters.*Member);
}
template <auto Member, class Packet>
double* six(Packet& packet) {
  return (packet.*Member).data();
}
double* supply(Sensors& sensors) { return &sensors.supply_pressure; }
double* accelerometers(Sensors& sensors) { return sensors.accelerometer.data(); }

using C = Command;
using S = Sensors;

constexpr Entry<Command> of_command[] = {
    {"session", 1, false, "1", "", &whole<&C::session, C>},
    {"sequence", 1, false, "1", "", &whole<&C::sequence, C>},
    {"time", 1, false, "1", "", &whole<&C::time, C>},
    {"mode", 1, false, "1", "", &whole<&C::mode, C>},
    {"flags", 1, false, "1", "", &whole<&C::flags, C>},
    {"displacement", 6, true, "m", "rad", nullptr, &six<&C::displacement, C>},
    {"rate", 6, true, "m/s", "rad/s", nullptr, &six<&C::rate, C>},
    {"drive", 6, false, "1", "", nullptr, &six<&C::drive, C>},
    {"wrench", 6, true, "N", "N m", nullptr, &six<&C::wrench, C>},
    {"next_wrench", 6, true, "N", "N m", nullptr, &six<&C::next_wrench, C>},
};

constexpr Entry<Sensors> of_sensors[] = {
    {"session", 1, false, "1", "", &whole<&S::session, S>},
    {"sequence", 1, false, "1", "", &whole<&S::sequence, S>},
    {"time", 1, false, "1", "", &whole<&S::time, S>},
    {"answered", 1, false, "1", "", &whole<&S::answered, S>},
    {"echo", 1, false, "1", "", &whole<&S::echo, S>},
    {"state", 1, false, "1", "", &whole<&S::state, S>},
    {"deadline_misses", 1, false, "1", "", &whole<&S::deadline_misses, S>},
    {"accepted", 1, false, "1", "", &counter<&Counters::accepted>},
    {"superseded", 1, false, "1", "", &counter<&Counters::superseded>},
    {"missed", 1, false, "1", "", &counter<&Counters::missed>},
    {"lost", 1, false, "1", "", &counter<&Counters::lost>},
    {"reordered", 1, false, "1", "", &counter<&Counters::reordered>},
    {"duplicated", 1, false, "1", "", &counter<&Counters::duplicated>},
    {"malformed", 1, false, "1", "", &counter<&Counters::malformed>},
    {"refused", 1, false, "1", "", &counter<&Counters::refused>},
    {"out_of_range", 1, false, "1", "", &counter<&Counters::out_of_range>},
    {"trips", 1, false, "1", "", &counter<&Counters::trips>},
    {"length", 6, false, "m", "", nullptr, &six<&S::length, S>},
    {"cap_pressure", 6, false, "Pa", "", nullptr, &six<&S::cap_pressure, S>},
    {"rod_pressure", 6, false, "Pa", "", nullptr, &six<&S::rod_pressure, S>},
    {"piston_acceleration", 6, false, "m/s^2", "", nullptr, &six<&S::piston_acceleration, S>},
    {"valve", 6, false, "1", "", nullptr, &six<&S::valve, S>},
    {"spool", 6, false, "1", "", nullptr, &six<&S::spool, S>},
    {"torque", 6, false, "N m", "", nullptr, &six<&S::torque, S>},
    {"motor_speed", 6, false, "rad/s", "", nullptr, &six<&S::motor_speed, S>},
    {"nut", 6, false, "m", "", nullptr, &six<&S::nut, S>},
    {"platform", 6, true, "m", "rad", nullptr, &six<&S::platform, S>},
    {"velocity", 6, true, "m/s", "rad/s", nullptr, &six<&S::velocity, S>},
    {"acceleration", 6, true, "m/s^2", "rad/s^2", nullptr, &six<&S::acceleration, S>},
    {"supply_pressure", 1, false, "Pa", "", nullptr, &supply},
    {"accelerometer", most_accelerometers, false, "m/s^2", "", nullptr, &accelerometers},
};

template <class Packet>
Name as_name(const Entry<Packet>& entry, int row) {
  return {row,        entry.name,   entry.count, entry.directions, entry.whole != nullptr,
          entry.unit, entry.angular};
}

}  // namespace

std::span<const Entry<Command>> entries(const Command*) { return of_command; }
std::span<const Entry<Sensors>> entries(const Sensors*) { return of_sensors; }

std::string Name::component(int i) const {
  if (count == 1) return std::string(name);
  if (directions) return fmt::format("{}.{}", name, spatial::direction_name(i));
  return fmt::format("{}.{}", name, i + 1);
}

std::string_view Name::unit_of(int i) const { return directions && i >= 3 ? angular : unit; }

Name name_at(Kind kind, int entry) {
  const auto row = static_cast<std::size_t>(entry);
  return kind == Kind::command ? as_name(of_command[row], entry) : as_name(of_sensors[row], entry);
}

std::optional<Name> find_name(Kind kind, std::string_view name) {
  const auto all = names_of(kind);
  for (std::size_t row = 0; row < all.size(); ++row)
    if (all[row] == name) return name_at(kind, static_cast<int>(row));
  return std::nullopt;
}

std::vector<std::string_view> names_of(Kind kind) {
  std::vector<std::string_view> names;
  if (kind == Kind::command)
    for (const auto& entry : of_command) names.push_back(entry.name);
  else
    for (const auto& entry : of_sensors) names.push_back(entry.name);
  return names;
}

std::string_view type_name(ValueType type) {
  constexpr std::array<std::string_view, 10> names{"u8",  "u16", "u32", "u64", "i8",
                                                   "i16", "i32", "i64", "f32", "f64"};
  return names[static_cast<std::size_t>(type)];
}

std::size_t size_of(ValueType type) {
  constexpr std::array<std::size_t, 10> sizes{1, 2, 4, 8, 1, 2, 4, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

const char* name(State state) {
  constexpr std::array names{"waiting", "following", "holding", "ramping", "parked"};
  return names.at(static_cast<std::size_t>(state));
}

bool PacketLayout::has(Kind kind, std::string_view name) const {
  const auto found = find_name(kind, name);
  for (const Field& field : fields)
    if (found && field.role == Field::Role::value && field.entry == found->entry) return true;
  return false;
}

}  // namespace hydrapod::realtime
