#pragma once
/// RPC III files made by hand, key by key and byte by byte, as docs/rpc-iii.md describes them; the
/// writer of the program has no part in them.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace hydrapod::test {

/// A key in 32 bytes and its value in 96, both filled with zeros.
inline std::string rpc_record(const std::string& key, const std::string& value) {
  std::string record(128, '\0');
  record.replace(0, key.size(), key);
  record.replace(32, value.size(), value);
  return record;
}

using RpcKeys = std::vector<std::pair<std::string, std::string>>;

/// The header of these keys, in blocks of 512 bytes; the first three are put before them.
inline std::string rpc_header(const std::string& format, const RpcKeys& keys) {
  const std::size_t count = keys.size() + 3, blocks = (count + 3) / 4;
  std::string header = rpc_record("FORMAT", format) +
                       rpc_record("NUM_HEADER_BLOCKS", std::to_string(blocks)) +
                       rpc_record("NUM_PARAMS", std::to_string(count));
  for (const auto& [key, value] : keys) header += rpc_record(key, value);
  header.resize(512 * blocks, '\0');
  return header;
}

template <class Number>
std::string rpc_number(Number value, bool big_endian = false) {
  std::string bytes(sizeof(Number), '\0');
  std::memcpy(bytes.data(), &value, sizeof(Number));
  return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

/// Two channels of integers, 4 Hz, frames of two points and groups of four: 6 samples, the last
/// group filled with zeros. Channel 1 counts 1, 2, … 6, channel 2 is −10, −20, … −60.
inline RpcKeys rpc_shorts_keys() {
  return {{"FILE_TYPE", "TIME_HISTORY"},
          {"TIME_TYPE", "RESPONSE"},
          {"DELTA_T", "2.500000E-01"},
          {"PTS_PER_FRAME", "2"},
          {"PTS_PER_GROUP", "4"},
          {"CHANNELS", "2"},
          {"FRAMES", "4"},
          {"REPEATS", "1"},
          {"INT_FULL_SCALE", "32752"},
          {"DATE", "05-OCT-95 14:19:14"},
          {"OPERATION", "by hand"},
          {"DESC.CHAN_1", "\"left front\""},
          {"UNITS.CHAN_1", "mm"},
          {"SCALE.CHAN_1", "5.000000E-01"},
          {"LOWER_LIMIT.CHAN_1", "-1.0"},
          {"UPPER_LIMIT.CHAN_1", "1.0"},
          {"MAP.CHAN_1", "1"},
          {"DESC.CHAN_2", "load"},
          {"UNITS.CHAN_2", "kN"},
          {"SCALE.CHAN_2", "1.250000E-01"},
          {"LOWER_LIMIT.CHAN_2", "-1.0"},
          {"UPPER_LIMIT.CHAN_2", "1.0"},
          {"MAP.CHAN_2", "2"}};
}

/// First group: points 1 … 4 of channel 1, then of channel 2; second group alike.
inline std::string rpc_shorts_data(bool big_endian = false) {
  std::string data;
  for (const int value : {1, 2, 3, 4, -10, -20, -30, -40, 5, 6, 0, 0, -50, -60, 0, 0})
    data += rpc_number(static_cast<std::int16_t>(value), big_endian);
  return data;
}

inline std::string rpc_with(RpcKeys keys, const std::string& key, const std::string& value) {
  for (auto& [name, text] : keys)
    if (name == key) text = value;
  return rpc_header("BINARY_IEEE_LITTLE_END", keys) + rpc_shorts_data();
}

}  // namespace hydrapod::test
