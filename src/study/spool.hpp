#pragma once
/// The file of a study's rows. Head: magic, fingerprint, width, all rows, first row and number of
/// rows of the shard, eight bytes each. Then chunks of `chunk_rows` rows (the last one is shorter),
/// each followed by the 64-bit XXH3 of its bytes.
///
/// A rank of a team writes the chunks that it was given, in their order: the same head with another
/// magic and all rows, then records of equal size, each the number of the chunk, `chunk_rows` rows
/// (zeros behind the last row of the study) and the checksum of both.

#include <cstdint>
#include <string>

namespace hydrapod::study {

inline constexpr std::uint64_t chunk_rows = 64;
inline constexpr std::uint64_t spool_magic = 0x3130'6c6f'6f70'7368;  // "hspool01"

inline constexpr std::uint64_t rank_magic = 0x3130'6b6e'6172'7368;  // "hsrank01"

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

/// All of `bytes` to a file descriptor; false, with errno, where that fails.
bool write_all(int file, const void* bytes, std::size_t size);

/// A file of rows, open for its one writer: locked until it is closed. No link is followed.
class RowsFile {
 public:
  /// `magic`: of a file that the writer may take. Its rows are cut off, unless they are gone on
  /// with. Throws base::InputError where another run writes the file, where it is a link or none of
  /// rows, and where there are rows that may not be replaced.
  RowsFile(const std::string& path, std::uint64_t magic, bool resume, bool replace);
  RowsFile(const RowsFile&) = delete;
  RowsFile& operator=(const RowsFile&) = delete;
  ~RowsFile();
  [[nodiscard]] int number() const { return number_; }

 private:
  void open(const std::string& path);
  int number_{-1};
};

/// Bytes of a chunk of `rows` rows with its checksum.
constexpr std::uint64_t chunk_bytes(std::uint64_t rows, std::uint64_t width) {
  return (rows * width + 1) * sizeof(double);
}

/// Bytes of a chunk of a rank's file, with its number and its checksum.
constexpr std::uint64_t record_bytes(std::uint64_t width) {
  return chunk_bytes(chunk_rows, width) + sizeof(std::uint64_t);
}

}  // namespace hydrapod::study
