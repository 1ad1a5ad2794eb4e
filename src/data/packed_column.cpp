#include "packed_column.hpp"

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>

namespace hydrapod::data {

namespace {

constexpr int level = 1;  ///< higher ones take twice the time for some per cent less
constexpr std::size_t bytes_of_number = sizeof(double);

/// Are the bytes all but random? Their entropy, in bits of eight.
bool is_noise(std::span<const unsigned char> bytes) {
  constexpr double noise = 7.8;
  std::array<std::array<unsigned, 256>, 2> counts{};
  for (std::size_t k = 0; k < bytes.size(); ++k) ++counts[k % 2][bytes[k]];
  double entropy = 0.0;
  for (std::size_t value = 0; value < 256; ++value) {
    const unsigned count = counts[0][value] + counts[1][value];
    if (count == 0) continue;
    const double share = static_cast<double>(count) / static_cast<double>(bytes.size());
    entropy -= share * std::log2(share);
  }
  return entropy > noise;
}

/// HDF5's shuffle: byte k of all numbers, one after the other.
std::vector<unsigned char> shuffled(std::span<const double> numbers) {
  const std::size_t count = numbers.size();
  std::vector<unsigned char> planes(count * bytes_of_number);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<unsigned char, bytes_of_number> bytes;
    std::memcpy(bytes.data(), &numbers[i], bytes_of_number);
    for (std::size_t k = 0; k < bytes_of_number; ++k) planes[k * count + i] = bytes[k];
  }
  return planes;
}

/// A zlib stream that is closed in any case.
struct Deflater {
  z_stream stream{};
  bool good;
  Deflater() : good(deflateInit(&stream, level) == Z_OK) {}
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream); }
};

}  // namespace

std::vector<unsigned char> packed_column(std::span<const double> numbers) {
  auto planes = shuffled(numbers);
  Deflater deflater;
  if (!deflater.good) return {};
  auto& stream = deflater.stream;
  constexpr std::size_t room_for_ends = 64;  // of the blocks at which the level changes
  std::vector<unsigned char> packed(deflateBound(&stream, planes.size()) +
                                    room_for_ends * bytes_of_number);
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  for (std::size_t k = 0; k < bytes_of_number; ++k) {
    const auto plane = std::span(planes).subspan(k * numbers.size(), numbers.size());
    const int wanted = is_noise(plane) ? Z_NO_COMPRESSION : level;
    if (deflateParams(&stream, wanted, Z_DEFAULT_STRATEGY) != Z_OK) return {};
    stream.next_in = plane.data();
    stream.avail_in = static_cast<uInt>(plane.size());
    if (deflate(&stream, Z_NO_FLUSH) != Z_OK) return {};
  }
  if (deflate(&stream, Z_FINISH) != Z_STREAM_END) return {};
  packed.resize(stream.total_out);
  return packed;
}

}  // namespace hydrapod::data
