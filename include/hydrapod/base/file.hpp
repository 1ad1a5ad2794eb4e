#pragma once
/// Files written whole or not at all.

#include <string>
#include <string_view>

namespace hydrapod::base {

/// Writes `text` to `path` so that a reader finds either what was there before or all of the new
/// text: into a temporary file beside it, to the disk, then renamed. A symbolic link is followed
/// and stays one; an existing file keeps its permissions; a device or pipe is written directly. `-`
/// is the standard output.
///
/// Throws InputError when the place cannot be written to (no such folder, no permission) and
/// ComputationError when writing failed on the way (disk full); what was there before is then
/// untouched.
void write_file_whole(const std::string& path, std::string_view text);

}  // namespace hydrapod::base
