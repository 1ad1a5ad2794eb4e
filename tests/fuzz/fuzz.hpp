#pragma once
/// What all targets share: what every refusal promises, and bytes as a file.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::fuzz {

/// One line of UTF-8 that says something.
inline void require_presentable(const base::Diagnostic& diagnostic) {
  const std::string text = diagnostic.text();
  const bool one_line = text.find('\n') == std::string::npos;
  const bool utf8 = base::first_invalid_utf8(text) == std::string::npos;
  if (!one_line || !utf8 || diagnostic.message.empty()) std::abort();
}

/// Runs `use`; an InputError is the right answer to what cannot be read. Whether there was none.
template <class Use>
bool accepted(const Use& use) {
  try {
    use();
    return true;
  } catch (const base::InputError& error) {
    if (error.diagnostics().empty()) std::abort();
    for (const auto& diagnostic : error.diagnostics()) require_presentable(diagnostic);
    return false;
  }
}

/// A folder that is gone with this process. ./test puts it into memory (TMPDIR) and removes it
/// after a crash. Files without a folder (memfd) are of no use: HDF5 opens none.
class Folder {
 public:
  Folder() {
    std::string name = std::filesystem::temp_directory_path() / "hydrapod-fuzz-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A file with these bytes; the next call replaces them.
inline const std::string& file_of(const std::string& bytes) {
  static const Folder folder;
  static const std::string path = folder.file("input");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size() ||
      std::fclose(file) != 0)
    std::abort();
  return path;
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace hydrapod::fuzz
