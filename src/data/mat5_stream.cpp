#include "mat5_stream.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

namespace hydrapod::data {

namespace {

constexpr std::size_t window_bytes = 1U << 15U;
constexpr std::uint64_t most_expansion = 1032;  // of deflate

template <typename Number>
double number_from(const char* bytes, bool swapped) {
  std::array<char, sizeof(Number)> order{};
  std::memcpy(order.data(), bytes, order.size());
  if (swapped) std::reverse(order.begin(), order.end());
  return static_cast<double>(std::bit_cast<Number>(order));
}

}  // namespace

double mat5_item(const char* bytes, std::uint32_t type, bool swapped) {
  switch (type) {
    case mat5_type::int8:
      return number_from<std::int8_t>(bytes, false);
    case mat5_type::int16:
      return number_from<std::int16_t>(bytes, swapped);
    case mat5_type::uint16:
    case mat5_type::utf16:
      return number_from<std::uint16_t>(bytes, swapped);
    case mat5_type::int32:
      return number_from<std::int32_t>(bytes, swapped);
    case mat5_type::uint32:
    case mat5_type::utf32:
      return number_from<std::uint32_t>(bytes, swapped);
    case mat5_type::single_float:
      return number_from<float>(bytes, swapped);
    case mat5_type::double_float:
      return number_from<double>(bytes, swapped);
    case mat5_type::int64:
      return number_from<std::int64_t>(bytes, swapped);
    case mat5_type::uint64:
      return number_from<std::uint64_t>(bytes, swapped);
    default:
      return number_from<std::uint8_t>(bytes, false);
  }
}

Mat5Stream::Mat5Stream(const FileWindow& file, std::uint64_t begin, std::uint64_t end,
                       bool compressed)
    : file_(file, window_bytes),
      at_(begin),
      end_(std::min(end, file.size())),
      compressed_(compressed) {
  if (compressed_ && inflateInit(&stream_) != Z_OK)
    throw std::runtime_error("zlib could not be set up");
}

Mat5Stream::~Mat5Stream() {
  if (compressed_) inflateEnd(&stream_);
}

bool Mat5Stream::read(void* out, std::size_t bytes) {
  auto* to = static_cast<char*>(out);
  if (compressed_) {
    if (!inflate_into(to, bytes)) return false;
    position_ += bytes;
    return true;
  }
  if (bytes > end_ - std::min(at_, end_)) return false;
  for (std::size_t done = 0; done < bytes;) {
    const std::string_view got = file_.at(at_, std::min(bytes - done, window_bytes));
    const std::size_t taken = std::min(got.size(), bytes - done);
    if (taken == 0) return false;
    std::memcpy(to + done, got.data(), taken);
    done += taken;
    at_ += taken;
  }
  position_ += bytes;
  return true;
}

bool Mat5Stream::skip(std::uint64_t bytes) {
  if (!compressed_) {
    if (bytes > end_ - std::min(at_, end_)) return false;
    at_ += bytes;
    position_ += bytes;
    return true;
  }
  std::array<char, 16384> nowhere{};
  while (bytes > 0) {
    const std::size_t step = std::min<std::uint64_t>(bytes, nowhere.size());
    if (!read(nowhere.data(), step)) return false;
    bytes -= step;
  }
  return true;
}

std::uint64_t Mat5Stream::most_left() const {
  const std::uint64_t left = end_ - std::min(at_, end_);
  return compressed_ ? (left + stream_.avail_in + 1) * most_expansion + window_bytes : left;
}

bool Mat5Stream::inflate_into(char* out, std::size_t bytes) {
  stream_.next_out = reinterpret_cast<Bytef*>(out);
  stream_.avail_out = static_cast<uInt>(bytes);
  while (stream_.avail_out > 0) {
    if (stream_.avail_in == 0) {
      if (at_ >= end_) return false;
      const std::string_view got = file_.at(at_, 1);
      const std::size_t taken = std::min<std::uint64_t>(got.size(), end_ - at_);
      if (taken == 0) return false;
      input_.assign(got.begin(), got.begin() + static_cast<std::ptrdiff_t>(taken));
      stream_.next_in = input_.data();
      stream_.avail_in = static_cast<uInt>(taken);
      at_ += taken;
    }
    const int status = inflate(&stream_, Z_NO_FLUSH);
    if (status == Z_STREAM_END) return stream_.avail_out == 0;
    broken_ = status != Z_OK;
    if (broken_) return false;
  }
  return true;
}

}  // namespace hydrapod::data
