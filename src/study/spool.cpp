#include "spool.hpp"

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

constexpr const char* what_it_is =
    "a file that `hydrapod` writes with --shard or keeps for --resume";

SpoolHead read_head(std::ifstream& file, const std::string& path) {
  SpoolHead head;
  if (!file.read(reinterpret_cast<char*>(&head), sizeof head) ||
      (head.magic != spool_magic && head.magic != rank_magic))
    base::refuse(path, fmt::format("is no file of a study's rows; expected {}", what_it_is));
  return head;
}

/// Whether the name still is that of the open file: a run that ends removes its file.
bool is_still(int file, const std::string& path) {
  struct stat of_file {
  }, of_name{};
  return ::fstat(file, &of_file) == 0 && ::lstat(path.c_str(), &of_name) == 0 &&
         of_file.st_dev == of_name.st_dev && of_file.st_ino == of_name.st_ino;
}

}  // namespace

RowsFile::RowsFile(const std::string& path, std::uint64_t magic, bool resume, bool replace) {
  open(path);
  SpoolHead head{.magic = 0};
  const auto got = ::pread(number_, &head, sizeof head, 0);
  const auto known = static_cast<std::size_t>(std::clamp<ssize_t>(got, 0, sizeof magic));
  if (got < 0 || std::memcmp(&head, &magic, known) != 0)
    base::refuse(path,
                 "is no file of a study's rows and was left as it is; choose another name "
                 "for the results");
  if (resume) return;
  if (!replace && ::lseek(number_, 0, SEEK_END) > static_cast<off_t>(sizeof head))
    base::refuse(path,
                 "holds rows of an interrupted study or of a part; --resume goes on with "
                 "them, --force begins anew");
  if (::ftruncate(number_, 0) != 0 || ::lseek(number_, 0, SEEK_SET) != 0)
    base::refuse(path, fmt::format("cannot be written: {}", std::strerror(errno)));
}

RowsFile::~RowsFile() {
  if (number_ >= 0) ::close(number_);
}

void RowsFile::open(const std::string& path) {
  do {
    if (number_ >= 0) ::close(number_);
    number_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    const int cause = errno;
    struct stat kind {};
    const bool is_file = number_ >= 0 && ::fstat(number_, &kind) == 0 && S_ISREG(kind.st_mode);
    if (cause == ELOOP && number_ < 0)
      base::refuse(path, "is a link and was left as it is; choose another name for the results");
    if (!is_file)
      base::refuse(path, fmt::format("cannot be written: {}",
                                     number_ < 0 ? std::strerror(cause) : "it is no file"));
    // file systems that have no locks: then there is none
    if (::flock(number_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      base::refuse(path,
                   "another run is writing it; wait for its end, or choose another name for "
                   "the results");
  } while (!is_still(number_, path));
}

std::uint64_t hash_of(const void* bytes, std::size_t size) { return XXH3_64bits(bytes, size); }

bool write_all(int file, const void* bytes, std::size_t size) {
  const auto* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const auto written = ::write(file, from, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    from += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

Spool::Spool(std::vector<std::string> paths) : paths_(std::move(paths)) {
  SpoolHead first;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    std::ifstream file(paths_[k], std::ios::binary);
    if (!file) base::refuse(paths_[k], fmt::format("cannot be read; expected {}", what_it_is));
    const auto head = read_head(file, paths_[k]);
    if (k == 0) first = head;
    if (head.magic == rank_magic) {
      index_ranks();
      return;
    }
    if (head.fingerprint != first.fingerprint || head.width != first.width || head.all != first.all)
      base::refuse(paths_[k], fmt::format("is of another study than {}", paths_[0]));
    if (k > 0 && head.first != rows_)
      base::refuse(paths_[k],
                   "does not continue the part before it; a part is missing or not "
                   "complete (run it again with --resume)");
    width_ = head.width;
    fingerprint_ = head.fingerprint;
    file.seekg(0, std::ios::end);
    const auto size = static_cast<std::uint64_t>(file.tellg()) - sizeof head;
    const std::uint64_t whole = size / chunk_bytes(chunk_rows, width_);
    std::uint64_t rows = std::min(whole * chunk_rows, head.count);
    const std::uint64_t rest = size % chunk_bytes(chunk_rows, width_);
    if (rows + chunk_rows > head.count && rest >= chunk_bytes(head.count - rows, width_))
      rows = head.count;
    counts_.push_back(rows);
    rows_ += rows;
  }
}

void Spool::index_ranks() {
  constexpr Place none{UINT32_MAX, UINT32_MAX};
  SpoolHead first;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    std::ifstream file(paths_[k], std::ios::binary);
    if (!file) base::refuse(paths_[k], fmt::format("cannot be read; expected {}", what_it_is));
    const auto head = read_head(file, paths_[k]);
    if (k == 0) {
      first = head;
      width_ = head.width;
      fingerprint_ = head.fingerprint;
      places_.assign((head.all + chunk_rows - 1) / chunk_rows, none);
    }
    if (head.magic != rank_magic || head.fingerprint != first.fingerprint ||
        head.width != first.width || head.all != first.all)
      base::refuse(paths_[k], fmt::format("is of another study than {}", paths_[0]));
    file.seekg(0, std::ios::end);
    const std::uint64_t records =
        (static_cast<std::uint64_t>(file.tellg()) - sizeof head) / record_bytes(width_);
    for (std::uint64_t record = 0; record < records; ++record) {
      std::uint64_t chunk = 0;
      file.seekg(static_cast<std::streamoff>(sizeof head + record * record_bytes(width_)));
      if (!file.read(reinterpret_cast<char*>(&chunk), sizeof chunk) || chunk >= places_.size())
        base::refuse(paths_[k], "is damaged; delete it, the study goes on with --resume");
      places_[chunk] = {static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(record)};
    }
  }
  const auto missing =
      std::ranges::find_if(places_, [](const Place& place) { return place.file == UINT32_MAX; });
  places_.erase(missing, places_.end());
  rows_ = std::min<std::uint64_t>(first.all, places_.size() * chunk_rows);
}

void Spool::each_ranked_chunk(
    const std::function<void(std::uint64_t, std::span<const double>)>& take) const {
  std::vector<std::uint64_t> record(record_bytes(width_) / sizeof(std::uint64_t));
  std::vector<double> rows(chunk_rows * width_);
  std::ifstream file;
  std::uint32_t open = UINT32_MAX;
  for (std::uint64_t chunk = 0; chunk < places_.size(); ++chunk) {
    const auto [which, number] = places_[chunk];
    if (which != open) file = std::ifstream(paths_[which], std::ios::binary);
    open = which;
    file.seekg(static_cast<std::streamoff>(sizeof(SpoolHead) + number * record_bytes(width_)));
    if (!file.read(reinterpret_cast<char*>(record.data()),
                   static_cast<std::streamsize>(record_bytes(width_))))
      throw base::ComputationError(fmt::format("{} cannot be read", paths_[which]));
    if (record.front() != chunk ||
        record.back() != hash_of(record.data(), (record.size() - 1) * sizeof(std::uint64_t)))
      throw base::ComputationError(
          fmt::format("{} is damaged; delete it, the study goes on with --resume", paths_[which]));
    std::memcpy(rows.data(), record.data() + 1, rows.size() * sizeof(double));
    const std::uint64_t count = std::min(chunk_rows, rows_ - chunk * chunk_rows);
    take(chunk * chunk_rows, std::span(rows).first(count * width_));
  }
}

void Spool::each_chunk(
    const std::function<void(std::uint64_t, std::span<const double>)>& take) const {
  if (!places_.empty()) return each_ranked_chunk(take);
  std::uint64_t at = 0;
  std::vector<double> chunk((chunk_rows * width_) + 1);
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    std::ifstream file(paths_[k], std::ios::binary);
    read_head(file, paths_[k]);
    for (std::uint64_t done = 0; done < counts_[k];) {
      const std::uint64_t rows = std::min(chunk_rows, counts_[k] - done);
      const std::size_t numbers = rows * width_;
      if (!file.read(reinterpret_cast<char*>(chunk.data()),
                     static_cast<std::streamsize>(chunk_bytes(rows, width_))))
        throw base::ComputationError(fmt::format("{} cannot be read", paths_[k]));
      std::uint64_t sum = 0;
      std::copy_n(reinterpret_cast<const char*>(chunk.data() + numbers), sizeof sum,
                  reinterpret_cast<char*>(&sum));
      if (sum != hash_of(chunk.data(), numbers * sizeof(double)))
        throw base::ComputationError(
            fmt::format("{} is damaged at row {}; delete it and begin anew", paths_[k], at));
      take(at, std::span(chunk).first(numbers));
      at += rows;
      done += rows;
    }
  }
}

std::vector<double> Spool::row(std::uint64_t index) const {
  if (!places_.empty() && index < rows_) {
    const auto [which, number] = places_[index / chunk_rows];
    std::ifstream file(paths_[which], std::ios::binary);
    file.seekg(static_cast<std::streamoff>(sizeof(SpoolHead) + number * record_bytes(width_) +
                                           sizeof(std::uint64_t) +
                                           (index % chunk_rows) * width_ * sizeof(double)));
    std::vector<double> values(width_);
    if (file.read(reinterpret_cast<char*>(values.data()),
                  static_cast<std::streamsize>(width_ * sizeof(double))))
      return values;
    throw base::ComputationError(fmt::format("{} cannot be read", paths_[which]));
  }
  std::uint64_t before = 0;
  for (std::size_t k = 0; k < paths_.size(); before += counts_[k++]) {
    if (index - before >= counts_[k]) continue;
    const std::uint64_t local = index - before;
    std::ifstream file(paths_[k], std::ios::binary);
    file.seekg(static_cast<std::streamoff>(sizeof(SpoolHead) +
                                           (local / chunk_rows) * chunk_bytes(chunk_rows, width_) +
                                           (local % chunk_rows) * width_ * sizeof(double)));
    std::vector<double> values(width_);
    if (file.read(reinterpret_cast<char*>(values.data()),
                  static_cast<std::streamsize>(width_ * sizeof(double))))
      return values;
    throw base::ComputationError(fmt::format("{} cannot be read", paths_[k]));
  }
  throw std::invalid_argument(fmt::format("Spool::row: {} of {} rows", index, rows_));
}

}  // namespace hydrapod::study
