#pragma once
/// The file of a study's rows. Head: magic, fingerprint, width, all rows, first row and number of
/// rows of the shard, eight bytes each. Then chunks of `chunk_rows` rows (the last one is shorter),
/// each followed by the 64-bit XXH3 of its bytes.

#include <cstdint>
#include <string>

namespace hydrapod::study {

inline constexpr std::uint64_t chunk_rows = 64;
inline constexpr std::uint64_t spool_magic = 0x3130'6c6f'6f70'7368;  // "hspool01"

struct SpoolHead {
  std::uint64_t magic{spool_magic};
  std::uint64_t fingerprint{};
  std::uint64_t width{};
  std::uint64_t all{};
  std::uint64_t first{};
  std::uint64_t count{};
};

/// 64-bit XXH3.
std::uint64_t hash_of(const void* bytes, std::size_t size);

/// Bytes of a chunk of `rows` rows with its checksum.
constexpr std::uint64_t chunk_bytes(std::uint64_t rows, std::uint64_t width) {
  return (rows * width + 1) * sizeof(double);
}

}  // namespace hydrapod::study
