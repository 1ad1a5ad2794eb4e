#pragma once
/// Files that writers fill from front to back, so that what stands in them can be read whenever the
/// writer ends: killed, on a full disk, or with an error.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/file.hpp"

namespace hydrapod::data {

/// Bytes into an open file, through a buffer that no destructor writes out. False means that the
/// system refused.
class OutStream {
 public:
  /// An existing file, which gets empty.
  explicit OutStream(const std::string& path);
  OutStream(const OutStream&) = delete;
  OutStream& operator=(const OutStream&) = delete;
  ~OutStream();

  [[nodiscard]] bool write(std::string_view text);
  /// Over what stands at `offset`; then on at the end.
  [[nodiscard]] bool write_at(std::uint64_t offset, std::string_view text);
  /// To the system; what has been written until now then is a whole, to which cut_off() goes back.
  [[nodiscard]] bool flush();
  [[nodiscard]] bool close();
  /// What came after the last flush is taken off again.
  void cut_off();

 private:
  bool put(std::string_view text);

  int descriptor_{-1};
  std::vector<char> buffer_;
  std::uint64_t written_{};  ///< by the system
  std::uint64_t whole_{};    ///< at the last flush
};

/// A part and the stream into it. All functions throw base::ComputationError.
class PartStream {
 public:
  explicit PartStream(const std::string& path);

  [[nodiscard]] const std::string& path() const { return part_.path(); }
  [[nodiscard]] const std::string& part() const { return part_.part(); }
  void write(std::string_view text);
  void write_at(std::uint64_t offset, std::string_view text);
  void flush();
  /// The part becomes the file, see base::PartFile::commit.
  std::string close(bool complete);
  /// What has been flushed can be read by itself: it stays when there is a failure.
  void keep_on_failure() { legible_ = true; }

 private:
  [[noreturn]] void fail();

  base::PartFile part_;
  OutStream file_;
  bool legible_{};
};

/// What to say when `part` cannot be written to. With samples in it the part is kept, and the
/// message names it.
std::string failed_write(base::PartFile& part, bool holds_samples);

}  // namespace hydrapod::data
