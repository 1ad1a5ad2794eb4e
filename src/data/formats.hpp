#pragma once
/// The readers and writers behind record_io.hpp, one pair per format.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/base/file.hpp"
#include "hydrapod/data/record_io.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// One file of a RecordSet.
class RecordReader {
 public:
  explicit RecordReader(const std::string& path) : notes_(path) {}
  RecordReader(const RecordReader&) = delete;
  RecordReader& operator=(const RecordReader&) = delete;
  virtual ~RecordReader() = default;

  [[nodiscard]] virtual RecordFormat format() const = 0;
  [[nodiscard]] const RecordHeader& header() const { return header_; }
  [[nodiscard]] const std::vector<base::Diagnostic>& notes() const { return notes_.all(); }
  /// Not known before the end of a text file.
  [[nodiscard]] virtual std::optional<std::int64_t> sample_count() const = 0;
  /// Fills the first rows of `block` with the next samples and returns how many; 0 at the end.
  std::int64_t read(Eigen::Ref<Samples> block);
  /// Back to the first sample, with the notes of the opening.
  void rewind();

 protected:
  /// Samples as the file has them.
  virtual std::int64_t read_values(Eigen::Ref<Samples> block) = 0;
  virtual void to_first_sample() = 0;
  /// Names become unique, units SI, and samples are then multiplied by what that takes.
  void settle_channels(bool by_hydrapod);

  Notes notes_;
  RecordHeader header_{};
  std::vector<double> factors_{};

 private:
  std::optional<Notes> opened_{};  ///< notes before the first read
};

std::unique_ptr<RecordWriter> make_csv_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_hdf5_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_mat5_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_mat73_writer(const std::string& path,
                                                const RecordHeader& header);
std::unique_ptr<RecordWriter> make_uff_writer(const std::string& path, const RecordHeader& header,
                                              bool binary);

std::unique_ptr<RecordReader> make_mat5_reader(const std::string& path, const ReadOptions& options);
std::unique_ptr<RecordReader> make_uff_reader(const std::string& path);
std::unique_ptr<RecordReader> make_csv_reader(const std::string& path, const ReadOptions& options);
std::unique_ptr<RecordReader> make_hdf5_reader(const std::string& path, const ReadOptions& options);

/// Throws std::invalid_argument unless `samples` has a column per channel.
void require_columns(const Eigen::Ref<const Samples>& samples, const RecordHeader& header);

/// What to say when `part` cannot be written to. With samples in it the part is kept, and the
/// message names it.
std::string failed_write(base::PartFile& part, bool holds_samples);

/// Words of the files that hydrapod writes.
inline constexpr const char* record_mark = "hydrapod record";
inline constexpr int record_version = 1;

/// Where the times of samples are read rather than told, they are this near to even: a tenth of a
/// step, and 1e-5 of the time itself for times of six digits.
bool is_time_of_sample(double time, double start, double step, std::uint64_t sample);

/// A rate with the rounding of printed times taken off: the whole number nearby, within
/// `tolerance` of it.
double rounded_rate(double rate, double tolerance);

}  // namespace hydrapod::data
