#include "hydrapod/realtime_arguments.hpp"

#include "hydrapod/base/text.hpp"
#include "hydrapod/command.hpp"

namespace hydrapod::cli {

realtime::Layout layout_of(const std::string& file) {
  return file.empty() ? realtime::Layout{} : realtime::read_layout(file);
}

realtime::Key key_of(const std::string& file) {
  return file.empty() ? realtime::Key{} : realtime::read_key(file);
}

realtime::Limits parse_limits(const std::string& text) {
  realtime::Limits limits;
  base::KeyValues values("--limit " + base::printable(text), text);
  const auto read = [&](const char* key, const char* unit, double& limit) {
    limit = values.number(key, unit).value_or(limit);
    if (!(limit > 0.0)) values.fail(std::string(key) + " must be more than 0");
  };
  read("length", "m", limits.length);
  read("velocity", "m/s", limits.velocity);
  read("acceleration", "m/s^2", limits.acceleration);
  read("error", "m", limits.error);
  values.finish();
  return limits;
}

std::string hardware_note(const realtime::HardwareResult& result) {
  return fmt::format(
      "sensors: {} packets, {} lost, {} late, {} malformed, {} refused; commands sent again: {}",
      result.received, result.lost, result.late, result.malformed, result.refused, result.resent);
}

}  // namespace hydrapod::cli
