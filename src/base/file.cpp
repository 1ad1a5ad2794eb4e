#include "hydrapod/base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "hydrapod/base/error.hpp"

namespace hydrapod::base {

namespace {
namespace fs = std::filesystem;

/// An open file; closing it can fail, so close() is separate from the destructor.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  bool close() {
    const int number = number_;
    number_ = -1;
    return ::close(number) == 0;
  }

 private:
  int number_;
};

[[noreturn]] void refuse(const std::string& path, int cause) {
  const fs::path folder = fs::path(path).parent_path();
  std::string reason = std::strerror(cause);
  std::error_code ignored;
  if (cause == ENOENT && !folder.empty() && !fs::exists(folder, ignored)) {
    reason = fmt::format("there is no folder '{}'", folder.string());
  }
  base::refuse(path, "cannot write the file: " + reason);
}

[[noreturn]] void fail(const std::string& path, int cause) {
  throw ComputationError(
      fmt::format("writing '{}' failed: {}; nothing was changed", path, std::strerror(cause)));
}

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void write_standard_output(std::string_view text) {
  const std::size_t written = std::fwrite(text.data(), 1, text.size(), stdout);
  if (written != text.size() || std::fflush(stdout) != 0) {
    throw ComputationError(
        fmt::format("writing to the standard output failed: {}", std::strerror(errno)));
  }
}

/// Devices, pipes and the like: there is nothing to replace.
void write_directly(const std::string& path, std::string_view text) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) refuse(path, errno);
  if (!write_all(file.number(), text) || !file.close()) {
    throw ComputationError(fmt::format("writing '{}' failed: {}", path, std::strerror(errno)));
  }
}

/// Where the text really goes: the end of a chain of symbolic links, which need not exist.
std::string target_of(const std::string& path) {
  constexpr int most_links = 40;  // as the kernel follows
  std::error_code error;
  fs::path target = path;
  for (int k = 0; k < most_links && fs::is_symlink(target, error); ++k) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) return path;
    target = target.parent_path() / next;  // an absolute `next` stands alone
  }
  return target.string();
}

/// An empty file of a name that did not exist: `stem`, `stem`2, `stem`3, …
struct NewFile {
  std::string name;
  int descriptor;
};
NewFile make_new_file(const std::string& stem, const std::string& target, const std::string& path) {
  constexpr int most = 100;
  for (int number = 1; number <= most; ++number) {
    const std::string name = number == 1 ? stem : stem + std::to_string(number);
    const int descriptor =
        ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) refuse(path, errno);
    struct stat old {};
    if (::stat(target.c_str(), &old) == 0) ::fchmod(descriptor, old.st_mode & 07777);
    return {name, descriptor};
  }
  base::refuse(path, fmt::format("cannot write the file: {} parts of interrupted runs stand beside "
                                 "it, {} and so on; remove them",
                                 most, stem));
}

/// A rename lasts when the folder is on the disk. Not all file systems can be told so.
void sync_folder_of(const std::string& target) {
  const fs::path folder = fs::path(target).parent_path();
  const Descriptor open_folder(
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (open_folder.is_open()) ::fsync(open_folder.number());
}

/// 0 or the cause; EEXIST where a file stands at `to`.
int rename_to_free_name(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno == EEXIST) return EEXIST;
  std::error_code ignored;  // a file system that cannot do it at once
  if (fs::exists(fs::symlink_status(to, ignored))) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

void write_beside_and_rename(const std::string& target, const std::string& path,
                             std::string_view text) {
  const auto [temporary, descriptor] =
      make_new_file(fmt::format("{}.{}.tmp", target, ::getpid()), target, path);
  Descriptor file(descriptor);
  if (write_all(file.number(), text) && ::fsync(file.number()) == 0 && file.close() &&
      ::rename(temporary.c_str(), target.c_str()) == 0)
    return sync_folder_of(target);
  const int cause = errno;
  ::unlink(temporary.c_str());
  fail(path, cause);
}

/// Of expect_no_file: what must stay where nothing was.
struct Expected {
  std::mutex lock{};
  std::map<std::string, std::function<bool(const std::string&)>> absent{};
};
Expected& expected() {
  static Expected all;
  return all;
}

/// Of a file that stands at `target`.
void refuse_what_must_stay(const std::string& target, const std::string& path) {
  std::function<bool(const std::string&)> must_stay;
  {
    const std::scoped_lock locked(expected().lock);
    if (const auto at = expected().absent.find(target); at != expected().absent.end())
      must_stay = at->second;
  }
  if (must_stay && must_stay(target))
    base::refuse(path, "was written by another program meanwhile and was left as it is");
}

/// This program made the file, and may replace it.
void was_made(const std::string& target) {
  const std::scoped_lock locked(expected().lock);
  expected().absent.erase(target);
}
}  // namespace

std::string read_file(const std::string& path, std::size_t largest, std::string_view expected) {
  const bool standard_input = path == "-";
  const std::string name = standard_input ? "<stdin>" : path;
  std::error_code error;
  if (!standard_input && fs::is_directory(path, error))
    refuse(path, fmt::format("is a directory, expected {}", expected));
  std::ifstream file;
  if (!standard_input) {
    errno = 0;
    file.open(path, std::ios::binary);
    if (!file)
      refuse(path, fmt::format("cannot be opened: {}", std::generic_category().message(errno)));
  }
  std::istream& stream = standard_input ? std::cin : file;
  std::string text;
  for (std::size_t room = 1U << 16U; stream && text.size() <= largest; room = text.size()) {
    const std::size_t before = text.size();
    text.resize(std::min(before + room, largest + 1));
    stream.read(text.data() + before, static_cast<std::streamsize>(text.size() - before));
    text.resize(before + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) refuse(name, "cannot be read");
  if (text.size() > largest)
    refuse(name, fmt::format("is larger than {} MiB, expected {} of some kilobytes", largest >> 20,
                             expected));
  return text;
}

void write_file_whole(const std::string& path, std::string_view text) {
  if (path == "-") return write_standard_output(text);
  if (path.empty()) refuse(path, ENOENT);
  const std::string target = target_of(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::is_directory(status)) refuse(path, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) return write_directly(target, text);
  if (fs::exists(status)) {
    refuse_what_must_stay(target, path);
    if (::access(target.c_str(), W_OK) != 0) refuse(path, errno);
  }
  write_beside_and_rename(target, path, text);
  was_made(target);
}

void expect_no_file(const std::string& path, std::function<bool(const std::string&)> must_stay) {
  const std::string target = target_of(path);
  const std::scoped_lock locked(expected().lock);
  expected().absent.insert_or_assign(target, std::move(must_stay));
}

PartFile::PartFile(const std::string& path) : path_(path) {
  if (path.empty()) refuse(path, ENOENT);
  if (path == "-") refuse(path, "cannot write this to the standard output");
  target_ = target_of(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(target_, ignored);
  replaces_ = fs::exists(status);
  if (fs::is_directory(status)) refuse(path, EISDIR);
  if (replaces_ && !fs::is_regular_file(status))
    refuse(path, "cannot write the file: it is a device or pipe");
  if (replaces_) {
    refuse_what_must_stay(target_, path);
    if (::access(target_.c_str(), W_OK) != 0) refuse(path, errno);
  }
  const auto [name, descriptor] = make_new_file(target_ + ".part", target_, path);
  const Descriptor file(descriptor);
  part_ = name;
}

PartFile::~PartFile() {
  if (!committed_ && !kept_) ::unlink(part_.c_str());
}

std::string PartFile::commit(bool complete) {
  const auto fail_and_keep = [&](int cause) {
    keep();
    throw ComputationError(fmt::format("writing '{}' failed: {}; {} holds what was written before",
                                       path_, std::strerror(cause), part_));
  };
  Descriptor file(::open(part_.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open() || ::fsync(file.number()) != 0 || !file.close()) fail_and_keep(errno);
  if (replaces_ && !complete) {
    keep();
    return part_;
  }
  const int cause = !replaces_ ? rename_to_free_name(part_, target_)
                    : ::rename(part_.c_str(), target_.c_str()) == 0 ? 0
                                                                    : errno;
  if (!replaces_ && cause == EEXIST) {
    keep();
    throw ComputationError(fmt::format(
        "'{}' was written by another program meanwhile and was left as it is; {} contains this one",
        path_, part_));
  }
  if (cause != 0) fail_and_keep(cause);
  committed_ = true;
  sync_folder_of(target_);
  was_made(target_);
  return path_;
}

}  // namespace hydrapod::base
