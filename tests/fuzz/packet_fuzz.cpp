/// Packets and the descriptions of their layout. The first byte chooses: a description, or a packet
/// of hydrapod's layout, to which the right checksum is added half of the time.

#include <zlib.h>

#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "fuzz.hpp"
#include "hydrapod/realtime/realtime.hpp"

namespace {

using namespace hydrapod;

void read_packet(std::span<const std::byte> bytes, bool summed) {
  static const realtime::Layout layout = realtime::native_layout(9);
  std::vector<std::byte> packet(bytes.begin(), bytes.end());
  if (summed) {
    const auto sum = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(packet.data()), packet.size()));
    for (int i = 0; i < 4; ++i) packet.push_back(static_cast<std::byte>(sum >> (8 * i)));
  }
  realtime::Command command;
  if (realtime::decode(layout, packet, command)) {
    std::array<std::byte, realtime::largest_packet> again;
    const std::size_t size = realtime::encode(layout, command, again.data());
    if (size != packet.size() || std::memcmp(again.data(), packet.data(), size) != 0) std::abort();
  }
  realtime::Sensors sensors;
  realtime::decode(layout, packet, sensors);
}

void read_description(const std::string& text) {
  const auto layout = realtime::parse_layout(text, "fuzz.toml");
  const std::string written = realtime::layout_text(layout);
  if (realtime::layout_text(realtime::parse_layout(written, "again.toml")) != written) std::abort();
  std::array<std::byte, realtime::largest_packet> bytes{};
  realtime::Command command;
  command.displacement.setConstant(1.5);
  const std::size_t size = realtime::encode(layout, command, bytes.data());
  realtime::decode(layout, {bytes.data(), size}, command);
  const std::size_t other = realtime::encode(layout, realtime::Sensors{}, bytes.data());
  realtime::Sensors sensors;
  realtime::decode(layout, {bytes.data(), other}, sensors);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  if (data[0] % 4 < 2)
    read_packet(bytes, data[0] % 2 == 1);
  else
    fuzz::accepted([&] { read_description(fuzz::text_of(data + 1, size - 1)); });
  return 0;
}
