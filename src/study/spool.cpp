#include "spool.hpp"

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <fstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

constexpr const char* what_it_is =
    "a file that `hydrapod` writes with --shard or keeps for --resume";

SpoolHead read_head(std::ifstream& file, const std::string& path) {
  SpoolHead head;
  if (!file.read(reinterpret_cast<char*>(&head), sizeof head) || head.magic != spool_magic)
    base::refuse(path, fmt::format("is no file of a study's rows; expected {}", what_it_is));
  return head;
}

}  // namespace

std::uint64_t hash_of(const void* bytes, std::size_t size) { return XXH3_64bits(bytes, size); }

Spool::Spool(std::vector<std::string> paths) : paths_(std::move(paths)) {
  SpoolHead first;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    std::ifstream file(paths_[k], std::ios::binary);
    if (!file) base::refuse(paths_[k], fmt::format("cannot be read; expected {}", what_it_is));
    const auto head = read_head(file, paths_[k]);
    if (k == 0) first = head;
    if (head.fingerprint != first.fingerprint || head.width != first.width || head.all != first.all)
      base::refuse(paths_[k], fmt::format("is of another study than {}", paths_[0]));
    if (k > 0 && head.first != rows_)
      base::refuse(paths_[k],
                   "does not continue the part before it; a part is missing or not "
                   "complete (run it again with --resume)");
    width_ = head.width;
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

void Spool::each_chunk(
    const std::function<void(std::uint64_t, std::span<const double>)>& take) const {
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
