#include "out_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace hydrapod::data {

namespace {
constexpr std::size_t buffer_bytes = 1U << 16U;
}

OutStream::OutStream(const std::string& path)
    : descriptor_(::open(path.c_str(), O_WRONLY | O_TRUNC | O_NOFOLLOW | O_CLOEXEC)) {
  buffer_.reserve(buffer_bytes);
}

OutStream::~OutStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool OutStream::put(std::string_view text) {
  while (!text.empty()) {
    const ssize_t done = ::write(descriptor_, text.data(), text.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    written_ += static_cast<std::uint64_t>(done);
    text.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

bool OutStream::write(std::string_view text) {
  if (buffer_.size() + text.size() <= buffer_bytes) {
    buffer_.insert(buffer_.end(), text.begin(), text.end());
    return descriptor_ >= 0;
  }
  const bool good = put({buffer_.data(), buffer_.size()});
  buffer_.clear();
  if (good && text.size() >= buffer_bytes) return put(text);
  buffer_.assign(text.begin(), text.end());
  return good;
}

bool OutStream::write_at(std::uint64_t offset, std::string_view text) {
  if (!put({buffer_.data(), buffer_.size()})) return false;
  buffer_.clear();
  while (!text.empty()) {
    const ssize_t done =
        ::pwrite(descriptor_, text.data(), text.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    offset += static_cast<std::uint64_t>(done);
    text.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

bool OutStream::flush() {
  const bool good = descriptor_ >= 0 && put({buffer_.data(), buffer_.size()});
  buffer_.clear();
  if (good) whole_ = written_;
  return good;
}

bool OutStream::close() {
  if (!flush()) return false;
  const int descriptor = descriptor_;
  descriptor_ = -1;
  return ::close(descriptor) == 0;
}

void OutStream::cut_off() {
  buffer_.clear();
  if (descriptor_ >= 0 && ::ftruncate(descriptor_, static_cast<off_t>(whole_)) == 0)
    written_ = whole_;
}

PartStream::PartStream(const std::string& path) : part_(path), file_(part_.part()) {}

void PartStream::write(std::string_view text) {
  if (!file_.write(text)) fail();
}

void PartStream::write_at(std::uint64_t offset, std::string_view text) {
  if (!file_.write_at(offset, text)) fail();
}

void PartStream::flush() {
  if (!file_.flush()) fail();
}

std::string PartStream::close(bool complete) {
  if (!file_.close()) fail();
  return part_.commit(complete);
}

void PartStream::fail() {
  file_.cut_off();
  throw base::ComputationError(failed_write(part_, legible_));
}

std::string failed_write(base::PartFile& part, bool holds_samples) {
  std::string text = fmt::format("writing '{}' failed; is the disk full?", part.path());
  if (!holds_samples) return text;
  part.keep();
  return text + fmt::format(" {} holds what was written before", part.part());
}

}  // namespace hydrapod::data
