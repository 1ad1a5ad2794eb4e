#include "hydrapod/realtime_arguments.hpp"

#include "hydrapod/command.hpp"

namespace hydrapod::cli {

realtime::Layout layout_of(const std::string& file) {
  return file.empty() ? realtime::Layout{} : realtime::read_layout(file);
}

realtime::Key key_of(const std::string& file) {
  return file.empty() ? realtime::Key{} : realtime::read_key(file);
}

std::string hardware_note(const realtime::HardwareResult& result) {
  return fmt::format(
      "sensors: {} packets, {} lost, {} late, {} malformed, {} refused; commands sent again: {}",
      result.received, result.lost, result.late, result.malformed, result.refused, result.resent);
}

}  // namespace hydrapod::cli
