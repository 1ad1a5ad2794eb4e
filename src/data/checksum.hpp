#pragma once
/// A checksum of what a record holds: sample rate, start, repeat, channels and samples. It is one
/// of numbers and names, not of the bytes of a file: equal records have the same one in every
/// format that keeps samples bit for bit.
///
/// 64-bit XXH3 of the header as text, then of the samples as little-endian doubles, row by row,
/// every NaN being the same, then of their number. It finds damage, not forgery.

#include <cstdint>
#include <memory>
#include <string>

#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

class Checksum {
 public:
  explicit Checksum(const RecordHeader& header);
  ~Checksum();
  Checksum(const Checksum&) = delete;
  Checksum& operator=(const Checksum&) = delete;

  void add(const Eigen::Ref<const Samples>& samples);
  /// Of all so far, "xxh3:0123456789abcdef".
  [[nodiscard]] std::string text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// As long as the text of a checksum; stands in files that were not completed.
inline constexpr const char* no_checksum_yet = "xxh3:----------------";

}  // namespace hydrapod::data
