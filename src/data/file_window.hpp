#pragma once
/// A file at any place in it, in bounded memory: bytes, or lines between binary data.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::data {

/// A window on a file of any size, in a fixed amount of memory.
class FileWindow {
 public:
  /// Throws base::InputError when the file cannot be opened.
  explicit FileWindow(const std::string& path, std::size_t bytes = 1U << 18U);
  /// Another window on the same file.
  FileWindow(const FileWindow& other, std::size_t bytes);

  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// The bytes from `offset` on: at least `wanted` (no more than the window holds) unless the file
  /// ends before. Holds until the next call.
  std::string_view at(std::uint64_t offset, std::size_t wanted);

  /// The line that begins at `offset`, without its end, and where the next one begins. Lines are
  /// cut after 4096 bytes; what follows is taken as a line of its own.
  struct Line {
    std::string_view text{};
    std::uint64_t next{};
    bool ended{};  ///< false where the file ends within it
    /// Without its last word where the file ends within it: more of that word may be missing.
    [[nodiscard]] std::string_view whole() const {
      return ended ? text : text.substr(0, text.find_last_of(" \t") + 1);
    }
  };
  Line line_at(std::uint64_t offset);

 private:
  std::shared_ptr<std::FILE> file_;
  std::uint64_t size_{};
  std::vector<char> window_;
  std::uint64_t begin_{};  ///< place of window_[0] in the file
  std::size_t filled_{};
};

}  // namespace hydrapod::data
