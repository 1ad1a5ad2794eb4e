#include <algorithm>
#include <cmath>
#include <sstream>

#include "hydrapod/base/text.hpp"
#include "hydrapod/rig/rig.hpp"

namespace hydrapod::rig {

model::Sensor parse_sensor(const std::string& argument, const std::string& text, const char* unit) {
  base::KeyValues words(argument + " " + base::printable(text), text);
  model::Sensor sensor;
  sensor.resolution = words.number("resolution", unit).value_or(0.0);
  sensor.noise = words.number("noise", unit).value_or(0.0);
  sensor.low = words.number("low", unit);
  sensor.high = words.number("high", unit);
  words.finish();
  if (sensor.resolution < 0.0 || sensor.noise < 0.0)
    words.fail("resolution and noise must be 0 or more");
  if (sensor.low && sensor.high && !(*sensor.low < *sensor.high))
    words.fail("low must be less than high");
  return sensor;
}

Accelerometer parse_accelerometer(const std::string& text) {
  const std::string_view whole = base::trimmed(text);
  // a name may have blanks: it ends before a comma, or before the word of the first key
  std::size_t end = std::min(whole.find(','), whole.size());
  if (const std::size_t key = whole.substr(0, end).find('='); key != whole.npos)
    end = std::min(whole.find_last_of(" \t", key) + 1, end);  // npos + 1: no name
  std::string_view rest = base::trimmed(whole.substr(end));
  if (rest.starts_with(',')) rest.remove_prefix(1);
  base::KeyValues words("--accelerometer " + base::printable(text), rest);
  Accelerometer one;
  one.name = base::trimmed(whole.substr(0, end));
  if (one.name.empty()) words.fail("an accelerometer has a name");
  std::istringstream place(words.text("at").value_or("0 0 0"));
  std::string left;
  if (!(place >> one.p_P.x() >> one.p_P.y() >> one.p_P.z()) || place >> left ||
      !one.p_P.allFinite())
    words.fail("at must be three lengths in m, for instance at=0.3 0 0.1");
  const std::string along = words.text("along").value_or("z");
  const auto direction = data::direction_from_text(along);
  const int code = direction ? static_cast<int>(*direction) : 0;
  if (code == 0 || std::abs(code) > 3) words.fail("along must be x, y, z, -x, -y or -z");
  one.direction = *direction;
  one.e_P = (code > 0 ? 1.0 : -1.0) * Vector3::Unit(std::abs(code) - 1);
  one.noise_density = words.number("noise", "1").value_or(one.noise_density);
  one.bandwidth = words.number("bandwidth", "Hz").value_or(one.bandwidth);
  one.sensor.resolution = words.number("resolution", "m/s^2").value_or(one.sensor.resolution);
  if (const auto range = words.number("range", "m/s^2")) {
    one.sensor.low = -std::abs(*range);
    one.sensor.high = std::abs(*range);
  }
  one.point = words.whole("point", 0, 1'000'000).value_or(0);
  words.finish();
  if (one.noise_density < 0.0 || one.bandwidth < 0.0 || one.sensor.resolution < 0.0)
    words.fail("noise, bandwidth and resolution must be 0 or more");
  return one;
}

}  // namespace hydrapod::rig
