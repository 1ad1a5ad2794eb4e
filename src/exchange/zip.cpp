#include "zip.hpp"

#include <zlib.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace hydrapod::exchange {

namespace {

static_assert(std::endian::native == std::endian::little);

template <class Number>
std::string field(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

/// A deflate stream without a header of its own.
std::string deflated(const std::string& content) {
  z_stream stream{};
  constexpr int without_header = -15, memory = 8;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, without_header, memory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib cannot begin to compress");
  std::string result(deflateBound(&stream, content.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int status = deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib cannot compress a member");
  return result;
}

}  // namespace

void ZipWriter::add(const std::string& name, const std::string& content, Method method) {
  const std::string data = method == Method::deflated ? deflated(content) : content;
  constexpr auto most = std::numeric_limits<std::uint32_t>::max();
  if (content.size() > most || members_.size() + data.size() > most)
    throw std::length_error("a ZIP file of this kind holds 4 GiB");
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
  constexpr std::uint16_t version = 20, first_day = (1U << 5U) | 1U;
  constexpr std::uint16_t deflate_method = 8;
  const auto common = [&] {  // version … lengths of name and of what follows it
    return field(version) + field(std::uint16_t{}) +
           field(method == Method::deflated ? deflate_method : std::uint16_t{}) +
           field(std::uint16_t{}) + field(first_day) + field(crc) +
           field(static_cast<std::uint32_t>(data.size())) +
           field(static_cast<std::uint32_t>(content.size())) +
           field(static_cast<std::uint16_t>(name.size())) + field(std::uint16_t{});
  };
  const auto place = static_cast<std::uint32_t>(members_.size());
  members_ += field(std::uint32_t{0x04034b50}) + common() + name + data;
  directory_ += field(std::uint32_t{0x02014b50}) + field(version) + common() +
                std::string(10, '\0') + field(place) + name;
  ++count_;
}

std::string ZipWriter::bytes() const {
  const auto count = static_cast<std::uint16_t>(count_);
  return members_ + directory_ + field(std::uint32_t{0x06054b50}) + std::string(4, '\0') +
         field(count) + field(count) + field(static_cast<std::uint32_t>(directory_.size())) +
         field(static_cast<std::uint32_t>(members_.size())) + std::string(2, '\0');
}

}  // namespace hydrapod::exchange
