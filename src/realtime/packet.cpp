/// Bytes of packets from numbers and back.

#include <openssl/hmac.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "names.hpp"

namespace hydrapod::realtime {

namespace {

void put(std::byte* at, std::uint64_t bits, std::size_t size, bool big_endian) {
  for (std::size_t i = 0; i < size; ++i)
    at[big_endian ? size - 1 - i : i] = static_cast<std::byte>(bits >> (8 * i));
}

std::uint64_t get(const std::byte* at, std::size_t size, bool big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i)
    bits |= std::to_integer<std::uint64_t>(at[big_endian ? size - 1 - i : i]) << (8 * i);
  return bits;
}

bool is_signed(ValueType type) { return type >= ValueType::i8 && type <= ValueType::i64; }

/// The nearest number of the type; of NaN 0.
std::uint64_t bits_of(double value, ValueType type) {
  if (type == ValueType::f64) return std::bit_cast<std::uint64_t>(value);
  if (type == ValueType::f32) return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  if (std::isnan(value)) return 0;
  const int width = static_cast<int>(8 * size_of(type));
  const double rounded = std::nearbyint(value);
  if (is_signed(type)) {
    const double most = std::ldexp(1.0, width - 1);
    if (rounded >= most) return (std::uint64_t{1} << (width - 1)) - 1;
    if (rounded < -most) return std::uint64_t{1} << (width - 1);
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(rounded));
  }
  if (rounded <= 0.0) return 0;
  if (rounded >= std::ldexp(1.0, width)) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(rounded);
}

double value_of(std::uint64_t bits, ValueType type) {
  if (type == ValueType::f64) return std::bit_cast<double>(bits);
  if (type == ValueType::f32)
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  if (!is_signed(type)) return static_cast<double>(bits);
  const int unused = static_cast<int>(64 - 8 * size_of(type));
  return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
}

std::uint64_t crc16(const std::byte* bytes, std::size_t size, std::uint64_t extra) {
  unsigned crc = 0xffff;
  const auto add = [&crc](unsigned byte) {
    unsigned step = (byte ^ crc) & 0xff;
    step ^= (step << 4) & 0xff;
    crc = (crc >> 8) ^ (step << 8) ^ (step << 3) ^ (step >> 4);
    crc &= 0xffff;
  };
  for (std::size_t i = 0; i < size; ++i) add(std::to_integer<unsigned>(bytes[i]));
  if (extra != 0) add(static_cast<unsigned>(extra - 1));
  return crc;
}

/// Of the bytes before the field.
std::uint64_t checksum(const Field& field, const std::byte* packet) {
  const std::byte* begin = packet + field.from;
  const std::size_t size = field.at - field.from;
  if (field.role == Field::Role::crc16) return crc16(begin, size, field.number);
  return crc32_z(0, reinterpret_cast<const Bytef*>(begin), size);
}

template <class Packet>
std::uint64_t bits_of(const Field& field, Packet& packet) {
  const auto& entry = entries(&packet)[static_cast<std::size_t>(field.entry)];
  if (entry.whole == nullptr)
    return bits_of((entry.real(packet)[field.component] - field.offset) / field.factor, field.type);
  const std::uint64_t whole = *entry.whole(packet);
  return field.type >= ValueType::f32 ? bits_of(static_cast<double>(whole), field.type) : whole;
}

template <class Packet>
std::size_t encode_as(const PacketLayout& layout, bool big_endian, const Packet& given,
                      std::byte* out) {
  Packet packet = given;  // the table gives places to write to
  for (const Field& field : layout.fields) {
    std::uint64_t bits = 0;
    switch (field.role) {
      case Field::Role::value:
        bits = bits_of(field, packet);
        break;
      case Field::Role::constant:
        bits = field.number;
        break;
      case Field::Role::ignored:
        break;
      default:
        bits = checksum(field, out);
    }
    put(out + field.at, bits, size_of(field.type), big_endian);
  }
  return layout.size;
}

/// A whole number is finite and not negative where it came as a float.
bool take(const Field& field, std::uint64_t bits, std::uint64_t& whole) {
  if (field.type < ValueType::f32) {
    whole = bits;
    return true;
  }
  const double value = value_of(bits, field.type);
  if (!(value >= 0.0 && value < 0x1p63)) return false;
  whole = static_cast<std::uint64_t>(value);
  return true;
}

template <class Packet>
bool decode_as(const PacketLayout& layout, bool big_endian, std::span<const std::byte> bytes,
               bool finite, Packet& result) {
  if (bytes.size() != layout.size) return false;
  Packet packet = result;
  for (const Field& field : layout.fields) {
    const std::uint64_t bits = get(bytes.data() + field.at, size_of(field.type), big_endian);
    if (field.role == Field::Role::ignored) continue;
    if (field.role == Field::Role::constant) {
      if (bits != field.number) return false;
      continue;
    }
    if (field.role != Field::Role::value) {
      if (bits != checksum(field, bytes.data())) return false;
      continue;
    }
    const auto& entry = entries(&packet)[static_cast<std::size_t>(field.entry)];
    if (entry.whole != nullptr) {
      if (!take(field, bits, *entry.whole(packet))) return false;
      continue;
    }
    const double number = value_of(bits, field.type);
    const double value = field.factor * number + field.offset;
    if (finite && !std::isfinite(value)) return false;
    entry.real(packet)[field.component] = value;
  }
  result = packet;
  return true;
}

}  // namespace

std::size_t encode(const Layout& layout, const Command& command, std::byte* out) {
  return encode_as(layout.command, layout.big_endian, command, out);
}
std::size_t encode(const Layout& layout, const Sensors& sensors, std::byte* out) {
  return encode_as(layout.sensors, layout.big_endian, sensors, out);
}
bool decode(const Layout& layout, std::span<const std::byte> bytes, Command& command) {
  return decode_as(layout.command, layout.big_endian, bytes, true, command);
}
bool decode(const Layout& layout, std::span<const std::byte> bytes, Sensors& sensors) {
  return decode_as(layout.sensors, layout.big_endian, bytes, false, sensors);
}

std::array<std::byte, mac_size> authentication(const Key& key, Kind kind,
                                               std::span<const std::byte> bytes) {
  std::array<std::byte, largest_packet + 1> text;
  if (bytes.size() > largest_packet) throw std::invalid_argument("authentication: too many bytes");
  text[0] = static_cast<std::byte>(kind == Kind::command ? 'C' : 'S');
  std::memcpy(text.data() + 1, bytes.data(), bytes.size());
  std::array<std::byte, mac_size> mac{};
  unsigned size = mac_size;
  if (HMAC(EVP_sha256(), key.bytes.data(), static_cast<int>(key.bytes.size()),
           reinterpret_cast<const unsigned char*>(text.data()), bytes.size() + 1,
           reinterpret_cast<unsigned char*>(mac.data()), &size) == nullptr)
    throw std::runtime_error("HMAC-SHA256 failed");
  return mac;
}

}  // namespace hydrapod::realtime
