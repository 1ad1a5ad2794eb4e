#pragma once
/// Bytes and numbers of MAT files of version 5.

#include <zlib.h>

#include <array>
#include <cstdint>
#include <vector>

#include "file_window.hpp"
#include "mat5_layout.hpp"

namespace hydrapod::data {

/// Bytes of one data element of a MAT file, inflated on the way where it is compressed.
class Mat5Stream {
 public:
  /// The bytes `begin` … `end` of the file.
  Mat5Stream(const FileWindow& file, std::uint64_t begin, std::uint64_t end, bool compressed);
  Mat5Stream(const Mat5Stream&) = delete;
  Mat5Stream& operator=(const Mat5Stream&) = delete;
  ~Mat5Stream();

  /// Bytes taken so far, after inflation.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  /// False when fewer bytes are left or the compressed data are damaged.
  bool read(void* out, std::size_t bytes);
  bool skip(std::uint64_t bytes);
  /// Most bytes that can still come; of compressed data what deflate can make of what is left.
  [[nodiscard]] std::uint64_t most_left() const;
  /// The compressed data made no sense, and what was inflated just before need not either.
  [[nodiscard]] bool broken() const { return broken_; }

 private:
  bool inflate_into(char* out, std::size_t bytes);

  FileWindow file_;
  std::uint64_t at_, end_;  ///< in the file
  bool compressed_, broken_{};
  std::uint64_t position_{};
  z_stream stream_{};
  std::vector<unsigned char> input_;
};

/// A number of a type of mat5_layout.hpp; `swapped`: the file has the other byte order.
double mat5_item(const char* bytes, std::uint32_t type, bool swapped);

}  // namespace hydrapod::data
