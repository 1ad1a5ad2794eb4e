#include "hydrapod/simulation/closed_loop.hpp"

#include <algorithm>
#include <cmath>

namespace hydrapod::simulation {

namespace {
constexpr std::uint64_t sensor_stream = 0x73656e73;  // apart from those of the commands
}

double shown(const model::Sensor& sensor, double value, double noise) {
  double found = value + sensor.noise * noise;
  if (sensor.low) found = std::max(found, *sensor.low);
  if (sensor.high) found = std::min(found, *sensor.high);
  return sensor.resolution > 0.0 ? sensor.resolution * std::nearbyint(found / sensor.resolution)
                                 : found;
}

SensorBank::SensorBank(const model::Sensors& sensors, std::uint64_t seed)
    : sensors_(sensors), random_(seed, sensor_stream) {}

control::Measurement SensorBank::read(const control::Measurement& truth) {
  const auto all = [&](const model::Sensor& sensor, const spatial::Vector6& values) {
    spatial::Vector6 found;
    for (int i = 0; i < 6; ++i)
      found[i] = shown(sensor, values[i], sensor.noise > 0.0 ? random_() : 0.0);
    return found;
  };
  control::Measurement measured;
  measured.length = all(sensors_.length, truth.length);
  measured.cap_pressure = all(sensors_.pressure, truth.cap_pressure);
  measured.rod_pressure = all(sensors_.pressure, truth.rod_pressure);
  measured.acceleration = all(sensors_.acceleration, truth.acceleration);
  return measured;
}

}  // namespace hydrapod::simulation
