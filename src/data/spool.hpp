#pragma once
/// Records on their way into formats that stand channel by channel, or need the largest sample
/// first: nothing of the final file can be written before the record is complete.
///
/// The samples wait in the part, in a layout of its own that hydrapod reads: what a run that was
/// killed has left is a record. Layout: a line "hydrapod spool 1", zeros up to byte 24, the numbers
/// of samples, of channels, of samples per piece, and of bytes before the first piece (8 bytes
/// each, little-endian), the header of the record as lines of text, zeros, then pieces, each
/// channel after channel.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "formats.hpp"
#include "out_stream.hpp"

namespace hydrapod::data {

inline constexpr std::string_view spool_mark = "hydrapod spool 1\n";

class Spool {
 public:
  /// Into `part`, which stays where there is a failure and samples are in it. Throws
  /// base::ComputationError, as all functions do.
  Spool(base::PartFile& part, const RecordHeader& header);
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();

  [[nodiscard]] std::uint64_t samples() const { return whole_ * rows_ + filled_; }

  void append(const Eigen::Ref<const Samples>& samples);

  /// Calls use(values, count) for the samples of a channel, piece by piece.
  template <typename Use>
  void channel(std::size_t index, Use use) {
    for (std::uint64_t piece = 0; piece < whole_; ++piece) {
      load(piece, index);
      use(values_.data(), rows_);
    }
    if (filled_ > 0) use(piece_.col(static_cast<Eigen::Index>(index)).data(), filled_);
  }

  /// Samples from `first` on.
  void read(std::uint64_t first, Eigen::Ref<Samples> block);

 private:
  void put(const void* data, std::size_t bytes, std::uint64_t at);
  /// Column `index` of a piece into values_.
  void load(std::uint64_t piece, std::size_t index);
  /// What has come since the last time goes to the file.
  void put_new_rows();
  [[nodiscard]] std::uint64_t place(std::uint64_t piece, std::size_t channel) const {
    return begin_ + (piece * channels_ + channel) * rows_ * sizeof(double);
  }

  base::PartFile& part_;
  std::size_t channels_;
  std::size_t rows_{};  ///< samples of a piece
  std::uint64_t begin_{};
  int descriptor_{-1};
  Eigen::MatrixXd piece_;  ///< column by column
  std::size_t filled_{};   ///< rows of it
  std::size_t put_{};      ///< rows of it that are in the file
  std::uint64_t whole_{};  ///< pieces that are full
  std::vector<double> values_;
};

/// What a run that was killed has left. Throws base::InputError.
std::unique_ptr<RecordReader> make_spool_reader(const std::string& path);

/// Fills the place of `part`, in which a record waited, with what `write` writes; throws
/// base::ComputationError, with the part as it was.
void replace_part(base::PartFile& part, bool holds_samples,
                  const std::function<bool(OutStream&)>& write);

}  // namespace hydrapod::data
