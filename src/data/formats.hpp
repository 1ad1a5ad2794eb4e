#pragma once
/// The readers and writers behind record_io.hpp, one pair per format.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "checksum.hpp"
#include "geometry.hpp"
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

  /// None: the record is in memory.
  [[nodiscard]] std::optional<RecordFormat> format() const { return format_; }
  [[nodiscard]] const std::string& rate_key() const { return rate_key_; }
  [[nodiscard]] const RecordHeader& header() const { return header_; }
  [[nodiscard]] const std::vector<base::Diagnostic>& notes() const { return notes_.all(); }
  /// Not known before the end of a text file.
  [[nodiscard]] std::optional<std::int64_t> sample_count() const { return count_; }
  /// Samples that the file says it was written with; none where it does not say.
  [[nodiscard]] std::optional<std::int64_t> declared() const { return declared_; }
  /// Channels are absent or end before others.
  [[nodiscard]] bool uneven() const { return uneven_; }
  [[nodiscard]] ChecksumFinding checksum() const { return finding_; }
  /// The file states a checksum, as far as it has been read.
  [[nodiscard]] bool has_checksum() const {
    return !stated_checksum_.empty() && stated_checksum_ != no_checksum_yet;
  }
  /// Its writer was killed: more may have been written than the file tells.
  [[nodiscard]] bool unfinished() const { return unfinished_; }
  /// Fills the first rows of `block` with the next samples and returns how many; 0 at the end.
  std::int64_t read(Eigen::Ref<Samples> block);
  /// Back to the first sample, with the notes of the opening.
  void rewind();

 protected:
  /// The samples behind the first done_ ones as the file has them; where count_ is known, no more
  /// are asked for than there are.
  virtual std::int64_t read_values(Eigen::Ref<Samples> block) = 0;
  virtual void to_first_sample() {}
  /// Where the file states its sample rate, for messages.
  std::string rate_key_{"sample_rate_hz"};

  /// Names become unique, units SI, and samples are then multiplied by what that takes.
  void settle_channels(bool by_hydrapod);

  /// From the first sample on, samples are summed up with header_, and at the end compared with
  /// stated_checksum_, unless that is empty.
  void begin_checksum();

  /// Of a file that says that it was not completed.
  void note_unfinished();

  Notes notes_;
  std::string stated_checksum_{};
  std::optional<RecordFormat> format_{};
  RecordHeader header_{};
  std::vector<double> factors_{};
  std::optional<std::int64_t> count_{};  ///< of samples
  std::optional<std::int64_t> declared_{};
  bool uneven_{}, unfinished_{};
  std::int64_t done_{};  ///< samples that have been read

 private:
  void check_sum(const Eigen::Ref<const Samples>& samples);

  std::unique_ptr<Checksum> checksum_{};
  ChecksumFinding finding_{};
  std::optional<Notes> opened_{};  ///< notes before the first read
};

/// Rows of a block (make_block).
Eigen::Index rows_at_once(const RecordHeader& header);

std::unique_ptr<RecordWriter> make_csv_writer(const std::string& path, const RecordHeader& header);
/// `for_matlab`: MATLAB 7.3.
std::unique_ptr<RecordWriter> make_hdf5_writer(const std::string& path, const RecordHeader& header,
                                               bool for_matlab);
std::unique_ptr<RecordWriter> make_mat5_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_uff_writer(const std::string& path, const RecordHeader& header,
                                              bool binary);
std::unique_ptr<RecordWriter> make_rpc_writer(const std::string& path, const RecordHeader& header,
                                              bool as_shorts);

std::unique_ptr<RecordReader> make_rpc_reader(const std::string& path);
std::unique_ptr<RecordReader> make_mat5_reader(const std::string& path, const ReadOptions& options);
std::unique_ptr<RecordReader> make_uff_reader(const std::string& path);
/// `damaged`: see open_damaged_reader.
std::unique_ptr<RecordReader> make_csv_reader(const std::string& path, const ReadOptions& options,
                                              bool damaged = false);
std::unique_ptr<RecordReader> make_hdf5_reader(const std::string& path, const ReadOptions& options);
/// What is left of a record of hydrapod, see hdf5_remains.cpp.
std::unique_ptr<RecordReader> make_hdf5_remains_reader(const std::string& path);

/// The reader for what the file holds, with a header that is valid. Throws base::InputError.
std::unique_ptr<RecordReader> open_reader(const std::string& path, const ReadOptions& options);
/// The same for a file that may be damaged anywhere: of a table, a last line without an end is left
/// out, and so is what follows a line that cannot be read.
std::unique_ptr<RecordReader> open_damaged_reader(const std::string& path,
                                                  const ReadOptions& options);
/// Throws base::InputError where the record has another sample rate than `options` say.
void require_rate(const std::string& name, const RecordReader& reader, const ReadOptions& options);
/// An HDF5 file, or one that was.
bool begins_as_hdf5(const std::string& path);

/// Fills header.experiment, but for the machine file that is there already, from its JSON; where
/// that is empty, from what older records of hydrapod say in header.notes.
void settle_experiment(const std::string& json, Notes& notes, RecordHeader& header);

/// Words of the files that hydrapod writes.
inline constexpr const char* record_mark = "hydrapod record";
inline constexpr int record_version = 1;
inline constexpr const char* checksum_name = "checksum";
/// What a reader says where it does not hold.
inline constexpr const char* checksum_differs =
    "the checksum does not hold: channels or samples are not those that were written; the file was "
    "damaged or changed";
/// Where the format has one, but the file has not.
inline constexpr const char* absent_checksum =
    "the checksum is missing: the file was damaged, or an early version of hydrapod wrote it";
/// Of a header that hydrapod wrote, but for the line that says so.
inline constexpr const char* damaged_mark =
    "the file looks like a record of hydrapod whose mark is damaged: it is read as one of another "
    "program, and no checksum is compared";

/// What HDF5 and MAT files of hydrapod hold of a record besides its samples: tells `sink` every
/// field, until it says false: attribute(name, text or number) short ones, text(name, text) those
/// of several lines, channels(name, texts or points) those of the channels.
template <class Sink>
bool put_header(const RecordHeader& header, Sink&& sink) {
  std::vector<std::string> name, unit, direction, role;
  std::vector<int> point;
  const auto text_if_any = [&](const char* key, const std::string& text) {
    return text.empty() || sink.text(key, text);
  };
  for (const Channel& channel : header.channels) {
    name.push_back(channel.name);
    unit.push_back(channel.unit);
    direction.emplace_back(direction_text(channel.direction));
    role.emplace_back(role_text(channel.role));
    point.push_back(channel.point);
  }
  return sink.attribute("format", std::string(record_mark)) &&
         sink.attribute("format_version", record_version) &&
         sink.attribute(checksum_name, std::string(no_checksum_yet)) &&
         sink.attribute("title", header.title) &&
         sink.attribute("sample_rate_hz", header.sample_rate) &&
         sink.attribute("start_s", header.start) && sink.attribute("date", header.date) &&
         sink.attribute("repeat", header.repeat) && sink.text("notes", header.notes) &&
         sink.text("experiment", experiment_json(header.experiment)) &&
         sink.text("machine", header.experiment.machine) &&
         text_if_any(geometry_name, geometry_json(header.geometry)) &&
         text_if_any(channel_texts_name, channel_texts_json(header.channels)) &&
         sink.channels("name", name) && sink.channels("unit", unit) &&
         sink.channels("direction", direction) && sink.channels("role", role) &&
         sink.channels("point", point);
}

/// Where the times of samples are read rather than told, they are this near to even: a tenth of a
/// step, and 1e-5 of the time itself for times of six digits.
bool is_time_of_sample(double time, double start, double step, std::uint64_t sample);

/// A rate with the rounding of printed times taken off: the whole number nearby, within
/// `tolerance` of it.
double rounded_rate(double rate, double tolerance);

}  // namespace hydrapod::data
