#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "formats.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

/// Samples put aside until the record is complete, so that each channel can then be read on its
/// own: in pieces of `rows` samples, channel after channel within a piece. The file has no name.
class Spool {
 public:
  Spool(const std::string& beside, std::size_t channels) : channels_(channels) {
    const std::string name = beside + ".spool";
    descriptor_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (descriptor_ < 0) throw base::ComputationError("no temporary file could be made: " + name);
    ::unlink(name.c_str());
    rows_ = std::clamp<std::size_t>((4U << 20U) / (sizeof(double) * channels), 1, 8192);
    piece_.resize(static_cast<Eigen::Index>(rows_), static_cast<Eigen::Index>(channels));
  }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool() { ::close(descriptor_); }

  [[nodiscard]] std::uint64_t samples() const { return whole_ * rows_ + filled_; }

  void append(const Eigen::Ref<const Samples>& samples) {
    for (Eigen::Index done = 0; done < samples.rows();) {
      const Eigen::Index take =
          std::min<Eigen::Index>(samples.rows() - done, static_cast<Eigen::Index>(rows_ - filled_));
      piece_.middleRows(static_cast<Eigen::Index>(filled_), take) = samples.middleRows(done, take);
      filled_ += static_cast<std::size_t>(take);
      done += take;
      if (filled_ == rows_) flush();
    }
  }

  /// Calls use(values, count) for the samples of a channel, piece by piece.
  template <typename Use>
  void channel(std::size_t index, Use use) {
    std::vector<double> values(rows_);
    for (std::uint64_t piece = 0; piece < whole_; ++piece) {
      const std::uint64_t at = (piece * channels_ + index) * rows_ * sizeof(double);
      transfer(values.data(), at, [](auto... all) { return ::pread(all...); });
      use(values.data(), rows_);
    }
    if (filled_ > 0) use(piece_.col(static_cast<Eigen::Index>(index)).data(), filled_);
  }

 private:
  void flush() {
    const std::uint64_t at = whole_ * channels_ * rows_ * sizeof(double);
    for (std::size_t c = 0; c < channels_; ++c)
      transfer(piece_.col(static_cast<Eigen::Index>(c)).data(), at + c * rows_ * sizeof(double),
               [](auto... all) { return ::pwrite(all...); });
    ++whole_;
    filled_ = 0;
  }

  /// Moves a column of a piece to or from the file.
  template <typename Move>
  void transfer(double* values, std::uint64_t at, Move move) {
    auto* bytes = reinterpret_cast<char*>(values);
    for (std::size_t done = 0, all = rows_ * sizeof(double); done < all;) {
      const ssize_t moved =
          move(descriptor_, bytes + done, all - done, static_cast<off_t>(at + done));
      if (moved < 0 && errno == EINTR) continue;
      if (moved <= 0) throw base::ComputationError("the temporary file failed; is the disk full?");
      done += static_cast<std::size_t>(moved);
    }
  }

  std::size_t channels_;
  std::size_t rows_{};
  int descriptor_{};
  Eigen::MatrixXd piece_;  ///< column by column
  std::size_t filled_{};
  std::uint64_t whole_{};
};

UffFunction function_of(const RecordHeader& header, std::size_t index, std::uint64_t samples,
                        bool binary) {
  const Channel& channel = header.channels[index];
  UffFunction f;
  f.id = {channel.name, header.title, uff_date(header.date),
          fmt::format("{} of repeat {}", role_text(channel.role), header.repeat), "NONE"};
  f.type = uff_function::time_response;
  f.number = static_cast<long long>(index + 1);
  f.version = std::min(header.repeat, 99999);
  f.response = uff_place(channel);
  f.declared = samples;
  f.first = header.start;
  f.step = 1.0 / header.sample_rate;
  f.abscissa = {.quantity = uff_quantity::time, .label = "Time", .unit = "s"};
  f.ordinate = uff_axis_of(channel.name, channel.unit);
  f.binary = binary;
  return f;
}

class UffWriter final : public RecordWriter {
 public:
  UffWriter(const std::string& path, const RecordHeader& header, bool binary)
      : RecordWriter(header, binary),
        file_(path),
        header_(header),
        binary_(binary),
        spool_(file_.part(), header.channels.size()) {}

  void write(const Eigen::Ref<const Samples>& samples) override {
    constexpr std::uint64_t most = 2'147'483'647;  // I10 as other programs read it
    if (spool_.samples() + static_cast<std::uint64_t>(samples.rows()) > most)
      throw base::ComputationError("a Universal File holds at most 2147483647 samples per channel");
    spool_.append(samples);
  }

 private:
  std::string finish(bool complete) override {
    std::string comments = comment_lines(header_);
    if (binary_) comments += fmt::format("# {}: {}\n", checksum_name, checksum());  // else rounded
    file_.write(uff_beginning(header_.title, header_.date, comments));
    for (std::size_t c = 0; c < header_.channels.size(); ++c) write_channel(c);
    return file_.close(complete);
  }

  void write_channel(std::size_t index) {
    const UffFunction f = function_of(header_, index, spool_.samples(), binary_);
    std::string text = uff_function_head(f);
    UffNumbers numbers(f);
    spool_.channel(index, [&](const double* values, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) numbers.add(values[i], text);
      file_.write(text);
      text.clear();
    });
    numbers.finish(text);
    file_.write(text);
  }

  PartStream file_;
  RecordHeader header_;
  bool binary_;
  Spool spool_;
};

}  // namespace

std::unique_ptr<RecordWriter> make_uff_writer(const std::string& path, const RecordHeader& header,
                                              bool binary) {
  return std::make_unique<UffWriter>(path, header, binary);
}

}  // namespace hydrapod::data
