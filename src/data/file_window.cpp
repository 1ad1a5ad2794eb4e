#include "file_window.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hydrapod/base/error.hpp"

namespace hydrapod::data {

namespace {
constexpr std::size_t longest_line = 4096;
}

FileWindow::FileWindow(const std::string& path, std::size_t bytes)
    : window_(std::max(bytes, 2 * longest_line)) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr)
    base::refuse(path, fmt::format("cannot read the file: {}", std::strerror(errno)));
  file_ = {file, std::fclose};
  size_ = std::filesystem::file_size(path);
}

FileWindow::FileWindow(const FileWindow& other, std::size_t bytes)
    : file_(other.file_), size_(other.size_), window_(std::max(bytes, 2 * longest_line)) {}

std::string_view FileWindow::at(std::uint64_t offset, std::size_t wanted) {
  if (offset >= size_) return {};
  wanted = std::min<std::uint64_t>({wanted, window_.size(), size_ - offset});
  if (offset < begin_ || offset + wanted > begin_ + filled_) {
    begin_ = offset;
    filled_ = 0;
    while (filled_ < window_.size()) {
      const ssize_t got = ::pread(::fileno(file_.get()), window_.data() + filled_,
                                  window_.size() - filled_, static_cast<off_t>(begin_ + filled_));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      filled_ += static_cast<std::size_t>(got);
    }
  }
  const std::size_t from = static_cast<std::size_t>(offset - begin_);
  return {window_.data() + from, filled_ > from ? filled_ - from : 0};
}

FileWindow::Line FileWindow::line_at(std::uint64_t offset) {
  const std::string_view bytes = at(offset, longest_line).substr(0, longest_line);
  const std::size_t end = bytes.find_first_of("\n\r");
  if (end == bytes.npos) {
    const std::uint64_t next = offset + bytes.size();
    return {bytes, next, next < size_};
  }
  const bool pair = bytes[end] == '\r' && end + 1 < bytes.size() && bytes[end + 1] == '\n';
  return {bytes.substr(0, end), offset + end + (pair ? 2 : 1), true};
}

}  // namespace hydrapod::data
