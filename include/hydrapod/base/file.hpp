#pragma once
/// Files read with a limit, and written whole or not at all.

#include <cstddef>
#include <string>
#include <string_view>

namespace hydrapod::base {

/// The text of `path` (`-`: standard input), no more than `largest` bytes. Throws InputError when
/// it cannot be read or is larger; `expected` then says what would be ("a machine file").
std::string read_file(const std::string& path, std::size_t largest, std::string_view expected);

/// Writes `text` to `path` so that a reader finds either what was there before or all of the new
/// text: into a temporary file beside it, to the disk, then renamed. A symbolic link is followed
/// and stays one; an existing file keeps its permissions; a device or pipe is written directly. `-`
/// is the standard output.
///
/// Throws InputError when the place cannot be written to (no such folder, no permission) and
/// ComputationError when writing failed on the way (disk full); what was there before is then
/// untouched.
void write_file_whole(const std::string& path, std::string_view text);

/// A file that grows over a long time and takes its place only when it is complete: written as
/// `PATH.part`, which replaces PATH at commit(). Until then what was at PATH stays; after a crash
/// or a kill the part is what is left. A PartFile that goes without commit() removes its part.
class PartFile {
 public:
  /// Makes the empty part. A symbolic link is followed. Throws InputError when there cannot be a
  /// file at `path` (no such folder, no permission, a device or folder stands there).
  explicit PartFile(const std::string& path);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  [[nodiscard]] const std::string& path() const { return path_; }  ///< as it was given
  [[nodiscard]] const std::string& part() const { return part_; }  ///< what to write into

  /// The part, which must be closed by now, becomes the file: to the disk, then renamed. Throws
  /// ComputationError.
  void commit();

  /// The part stays as it is, for what can be read of it.
  void keep() { kept_ = true; }

 private:
  std::string path_;
  std::string target_;
  std::string part_;
  bool committed_{};
  bool kept_{};
};

}  // namespace hydrapod::base
