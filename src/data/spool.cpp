#include "spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "file_window.hpp"
#include "record_comments.hpp"

namespace hydrapod::data {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t counts_at = 24, text_at = counts_at + 4 * sizeof(std::uint64_t);

struct Counts {
  std::uint64_t samples{}, channels{}, rows{}, begin{};
};

}  // namespace

Spool::Spool(base::PartFile& part, const RecordHeader& header)
    : part_(part), channels_(header.channels.size()) {
  rows_ = std::clamp<std::size_t>((4U << 20U) / (sizeof(double) * channels_), 1, 8192);
  piece_.resize(static_cast<Eigen::Index>(rows_), static_cast<Eigen::Index>(channels_));
  values_.resize(rows_);
  const std::string text = comment_lines(header);
  begin_ = (text_at + text.size() + 8) / 8 * 8;
  descriptor_ = ::open(part.part().c_str(), O_RDWR | O_TRUNC | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor_ < 0) throw base::ComputationError(failed_write(part_, false));
  std::string head(begin_, '\0');
  head.replace(0, spool_mark.size(), spool_mark);
  const Counts counts{.channels = channels_, .rows = rows_, .begin = begin_};
  std::memcpy(head.data() + counts_at, &counts, sizeof counts);
  head.replace(text_at, text.size(), text);
  put(head.data(), head.size(), 0);
}

Spool::~Spool() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Spool::put(const void* data, std::size_t bytes, std::uint64_t at) {
  for (const char* from = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t done = ::pwrite(descriptor_, from, bytes, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) throw base::ComputationError(failed_write(part_, whole_ * rows_ + put_ > 0));
    from += done;
    at += static_cast<std::uint64_t>(done);
    bytes -= static_cast<std::size_t>(done);
  }
}

void Spool::put_new_rows() {
  for (std::size_t c = 0; c < channels_ && put_ < filled_; ++c)
    put(piece_.col(static_cast<Eigen::Index>(c)).data() + put_, (filled_ - put_) * sizeof(double),
        place(whole_, c) + put_ * sizeof(double));
  put_ = filled_;
  const std::uint64_t count = samples();  // behind what it counts
  put(&count, sizeof count, counts_at);
  if (filled_ < rows_) return;
  ++whole_;
  filled_ = put_ = 0;
}

void Spool::append(const Eigen::Ref<const Samples>& samples) {
  constexpr std::size_t enough = 1U << 18U;  // bytes that may be lost
  for (Eigen::Index done = 0; done < samples.rows();) {
    const Eigen::Index take =
        std::min<Eigen::Index>(samples.rows() - done, static_cast<Eigen::Index>(rows_ - filled_));
    piece_.middleRows(static_cast<Eigen::Index>(filled_), take) = samples.middleRows(done, take);
    filled_ += static_cast<std::size_t>(take);
    done += take;
    if (filled_ == rows_ || (filled_ - put_) * channels_ * sizeof(double) >= enough) put_new_rows();
  }
}

void Spool::load(std::uint64_t piece, std::size_t index) {
  auto* bytes = reinterpret_cast<char*>(values_.data());
  for (std::size_t done = 0, all = rows_ * sizeof(double); done < all;) {
    const ssize_t got = ::pread(descriptor_, bytes + done, all - done,
                                static_cast<off_t>(place(piece, index) + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      throw base::ComputationError(
          fmt::format("{} cannot be read while the file is completed", part_.part()));
    done += static_cast<std::size_t>(got);
  }
}

void Spool::read(std::uint64_t first, Eigen::Ref<Samples> block) {
  for (Eigen::Index row = 0; row < block.rows();) {
    const std::uint64_t at = first + static_cast<std::uint64_t>(row), piece = at / rows_,
                        from = at % rows_;
    const auto take =
        std::min<Eigen::Index>(block.rows() - row, static_cast<Eigen::Index>(rows_ - from));
    for (Eigen::Index c = 0; c < block.cols(); ++c) {
      if (piece < whole_) load(piece, static_cast<std::size_t>(c));
      const double* column = piece < whole_ ? values_.data() : piece_.col(c).data();
      block.col(c).segment(row, take) = Eigen::Map<const Eigen::VectorXd>(column + from, take);
    }
    row += take;
  }
}

namespace {

class SpoolReader final : public RecordReader {
 public:
  explicit SpoolReader(const std::string& path) : RecordReader(path), file_(path) {
    const std::string_view head = file_.at(0, text_at);
    if (head.size() < text_at) notes_.fail("the part is cut off within its header");
    std::memcpy(&counts_, head.data() + counts_at, sizeof counts_);
    read_header();
    constexpr std::uint64_t most = std::uint64_t{1} << 30U;
    if (counts_.channels < 1 || counts_.channels != header_.channels.size() || counts_.rows < 1 ||
        counts_.rows > most)
      notes_.fail("the part is damaged: its header contradicts itself");
    const std::uint64_t piece = counts_.channels * counts_.rows * sizeof(double),
                        held = (file_.size() - counts_.begin) / piece * counts_.rows;
    if (counts_.samples > held + counts_.rows) counts_.samples = held;
    count_ = static_cast<std::int64_t>(counts_.samples);
    unfinished_ = true;
    notes_.add("the part of a record that was not completed: its end is missing");
    format_ = RecordFormat::uff;
    settle_channels(true);
  }

 private:
  void read_header() {
    constexpr std::uint64_t most = std::uint64_t{256} << 20U;
    if (counts_.begin > std::min(file_.size(), most) || counts_.begin < text_at)
      notes_.fail("the part is damaged: its header contradicts itself");
    std::string text(counts_.begin - text_at, '\0');
    std::ifstream stream(notes_.file(), std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(text_at));
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(std::min(text.find('\0'), text.size()));
    RecordComments comments;
    unsigned number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      comments.take(std::string_view(text).substr(begin, end - begin), ++number);
      begin = end + 1;
    }
    if (!comments.by_hydrapod(notes_)) notes_.fail("the part is damaged: it has no header");
    header_ = comments.header(notes_);
  }

  std::int64_t read_values(Eigen::Ref<Samples> block) override {
    std::vector<char> bytes;
    for (Eigen::Index row = 0; row < block.rows();) {
      const std::uint64_t at = static_cast<std::uint64_t>(done_ + row), piece = at / counts_.rows,
                          from = at % counts_.rows;
      const auto take = std::min<Eigen::Index>(block.rows() - row,
                                               static_cast<Eigen::Index>(counts_.rows - from));
      for (Eigen::Index c = 0; c < block.cols(); ++c) {
        const std::uint64_t column = piece * counts_.channels + static_cast<std::uint64_t>(c);
        std::uint64_t offset = counts_.begin + (column * counts_.rows + from) * sizeof(double);
        for (Eigen::Index k = 0; k < take; ++k, offset += sizeof(double)) {
          const std::string_view number = window(c).at(offset, sizeof(double));
          if (number.size() < sizeof(double)) return row;
          std::memcpy(&block(row + k, c), number.data(), sizeof(double));
        }
      }
      row += take;
    }
    return block.rows();
  }

  /// Each channel has its own, as they stand apart.
  FileWindow& window(Eigen::Index channel) {
    constexpr std::size_t bytes = 1U << 13U;
    while (windows_.size() <= static_cast<std::size_t>(channel))
      windows_.emplace_back(file_, bytes);
    return windows_[static_cast<std::size_t>(channel)];
  }

  FileWindow file_;
  Counts counts_;
  std::vector<FileWindow> windows_;
};

}  // namespace

std::unique_ptr<RecordReader> make_spool_reader(const std::string& path) {
  return std::make_unique<SpoolReader>(path);
}

void replace_part(base::PartFile& part, bool holds_samples,
                  const std::function<bool(OutStream&)>& write) {
  const auto fail = [&] { throw base::ComputationError(failed_write(part, holds_samples)); };
  std::string name = part.part() + ".new";
  int made = -1;
  constexpr int most = 100;
  for (int number = 2; made < 0 && number <= most; ++number) {
    made = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (made < 0 && errno != EEXIST) fail();
    if (made < 0) name = fmt::format("{}.new{}", part.part(), number);
  }
  if (made < 0) fail();
  struct Remove {
    std::string name;
    ~Remove() {
      if (!name.empty()) ::unlink(name.c_str());
    }
  } unless_done{name};
  struct stat mode {};
  if (::stat(part.part().c_str(), &mode) == 0) ::fchmod(made, mode.st_mode & 07777);
  ::close(made);
  OutStream file(name);
  if (!write(file) || !file.close() || ::rename(name.c_str(), part.part().c_str()) != 0) fail();
  unless_done.name.clear();
}

}  // namespace hydrapod::data
