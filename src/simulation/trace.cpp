#include "hydrapod/simulation/closed_loop.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::simulation {

namespace {

using data::Channel;
using data::Role;

using spatial::direction_names;

data::Direction axis(int direction) {
  return static_cast<data::Direction>(static_cast<int>(data::Direction::x) + direction);
}

/// Acceleration of P's origin, and ω̇.
Vector6 origin_acceleration(const PlantOutput& plant) {
  const Vector3 arm = plant.X_BP.p_BP - plant.p_BC;
  const Vector3 omega = plant.twist.tail<3>();
  Vector6 found = plant.acceleration;
  found.head<3>() += plant.acceleration.tail<3>().cross(arm) + omega.cross(omega.cross(arm));
  return found;
}

bool has_seals(const ClosedLoop& loop) {
  return dynamics::flexible_per_leg(loop.plant().kind()) > 0;
}
bool is_controlled(const ClosedLoop& loop) {
  return loop.options().actuators == Actuators::controlled;
}
bool has_oil(const ClosedLoop& loop) { return loop.plant().layout().pressures >= 0; }
bool has_drives(const ClosedLoop& loop) { return loop.plant().layout().nuts >= 0; }
bool has_supply(const ClosedLoop& loop) { return loop.plant().layout().supply >= 0; }

}  // namespace

TraceRecorder::TraceRecorder(const ClosedLoop& loop, double until, std::size_t most)
    : operating_(loop.operating()), drives_(has_drives(loop)) {
  const double samples = until / loop.output_interval();
  stride_ = std::max(1L, static_cast<long>(std::ceil(samples / static_cast<double>(most))));
}

void TraceRecorder::operator()(const LoopSample& sample) {
  if (seen_++ % stride_ != 0) return;
  trace_.time.push_back(sample.time);
  trace_.command.push_back(sample.excitation.command.value);
  trace_.motion.push_back(displacement_between(operating_, sample.plant.X_BP));
  Vector6 piston, cap, rod, nut, speed, torque;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = sample.plant.legs[static_cast<size_t>(i)];
    piston[i] = leg.piston;
    cap[i] = leg.cap_pressure;
    rod[i] = leg.rod_pressure;
    nut[i] = leg.nut;
    speed[i] = leg.motor_speed;
    torque[i] = leg.torque;
  }
  trace_.piston.push_back(piston);
  trace_.drive.push_back(sample.applied);
  if (drives_) {
    trace_.nut.push_back(nut);
    trace_.motor_speed.push_back(speed);
    trace_.torque.push_back(torque);
    return;
  }
  trace_.cap_pressure.push_back(cap);
  trace_.rod_pressure.push_back(rod);
}

std::vector<Channel> record_channels(const ClosedLoop& loop) {
  std::vector<Channel> channels;
  const auto six = [&](const char* name, const char* linear, const char* angular, Role role) {
    for (int i = 0; i < 6; ++i)
      channels.push_back({fmt::format("{}{}", name, direction_names[static_cast<size_t>(i)]),
                          i < 3 ? linear : angular, axis(i), role});
  };
  if (is_controlled(loop)) six("command.", "m", "rad", Role::excitation);
  if (loop.options().records_wrench) six("wrench.", "N", "N m", Role::excitation);
  six("platform.", "m", "rad", Role::response);
  six("platform.a", "m/s^2", "rad/s^2", Role::response);
  for (int number = 1; number <= model::leg_count; ++number) {
    const auto add = [&](const char* name, const char* unit, Role role) {
      channels.push_back(
          {fmt::format("leg{}.{}", number, name), unit, data::leg_direction(number), role});
    };
    add("length", "m", Role::response);
    add("measured_length", "m", Role::response);
    if (has_oil(loop)) {
      add("drive", "1", Role::drive);
      add("spool", "1", Role::response);
      add("p_cap", "Pa", Role::response);
      add("p_rod", "Pa", Role::response);
    }
    if (has_drives(loop)) {
      add("drive", "1", Role::drive);
      add("nut", "m", Role::response);
      add("motor_speed", "rad/s", Role::response);
      add("torque", "N m", Role::response);
    }
    constexpr std::array forces{"oil_force", "strut_force", "screw_force"};
    add(forces.at(static_cast<std::size_t>(model::leg_type(loop.plant().machine()))), "N",
        Role::response);
    if (has_seals(loop)) {
      add("sleeve_offset_t", "m", Role::response);
      add("sleeve_offset_2", "m", Role::response);
    }
  }
  if (has_supply(loop))
    channels.push_back({"supply.pressure", "Pa", data::Direction::none, Role::other});
  const auto& base = loop.plant().base();
  for (int k = 0; k < base.count; ++k) {
    const int direction = base.directions[static_cast<size_t>(k)];
    channels.push_back({fmt::format("base.{}", direction_names[static_cast<size_t>(direction)]),
                        direction < 3 ? "m" : "rad", axis(direction), Role::other});
  }
  return channels;
}

void record_row(const ClosedLoop& loop, const LoopSample& sample, double* row) {
  const auto put = [&](const Vector6& values) { row = std::copy_n(values.data(), 6, row); };
  if (is_controlled(loop)) put(sample.excitation.command.value);
  if (loop.options().records_wrench) put(sample.excitation.wrench);
  put(displacement_between(loop.operating(), sample.plant.X_BP));
  put(origin_acceleration(sample.plant));
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = sample.plant.legs[static_cast<size_t>(i)];
    *row++ = leg.length;
    *row++ = sample.measured.length[i];
    if (has_oil(loop))
      for (const double value : {sample.applied[i], leg.spool, leg.cap_pressure, leg.rod_pressure})
        *row++ = value;
    if (has_drives(loop))
      for (const double value : {sample.applied[i], leg.nut, leg.motor_speed, leg.torque})
        *row++ = value;
    *row++ = leg.oil_force;
    if (!has_seals(loop)) continue;
    *row++ = leg.sleeve_offset[0];
    *row++ = leg.sleeve_offset[1];
  }
  if (has_supply(loop)) *row++ = sample.plant.supply_pressure;
  const auto& base = loop.plant().base();
  for (int k = 0; k < base.count; ++k)
    *row++ = sample.plant.base.motion[base.directions[static_cast<size_t>(k)]];
}

}  // namespace hydrapod::simulation
