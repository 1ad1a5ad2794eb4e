#include "line_reader.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "hydrapod/base/error.hpp"

namespace hydrapod::data {

LineReader::LineReader(const std::string& path)
    : path_(path), file_(std::fopen(path.c_str(), "rb")), buffer_(1U << 16U) {
  if (!file_)
    throw base::InputError(
        {{.file = path, .message = fmt::format("cannot read the file: {}", std::strerror(errno))}});
}

/// More bytes behind what is left; false at the end of the file.
bool LineReader::refill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) {
    if (buffer_.size() >= longest)
      throw base::InputError(
          {{.file = path_,
            .line = number_ + 1,
            .message = fmt::format("the line is longer than {} MiB", longest >> 20U)}});
    buffer_.resize(2 * buffer_.size());
  }
  const std::size_t got = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  end_ += got;
  at_end_ = got == 0;
  return got > 0;
}

bool LineReader::next(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const std::string_view rest(buffer_.data() + begin_, end_ - begin_);
    std::size_t at = rest.find_first_of("\n\r", searched);
    // a CR at the very end may be the first half of CR LF
    const bool undecided = at != rest.npos && rest[at] == '\r' && at + 1 == rest.size() && !at_end_;
    if (at == rest.npos || undecided) {
      searched = undecided ? at : rest.size();
      if (refill()) continue;
      if (rest.empty()) return false;
      ended_ = at != rest.npos;
      if (!ended_) at = rest.size();
    } else {
      ended_ = true;
    }
    const bool pair = at + 1 < rest.size() && rest[at] == '\r' && rest[at + 1] == '\n';
    line = std::string_view(buffer_.data() + begin_, at);
    begin_ += std::min(at + (pair ? 2U : 1U), rest.size());
    ++number_;
    return true;
  }
}

}  // namespace hydrapod::data
