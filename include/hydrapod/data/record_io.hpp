#pragma once
/// Records to and from files, in blocks: memory does not grow with the length of a record.
///
/// | format    | endings            | what it keeps                                          |
/// | --------- | ------------------ | ------------------------------------------------------ |
/// | hdf5      | .h5 .hdf5          | everything, bit for bit                                |
/// | mat5      | .mat               | everything, bit for bit; up to 2 GiB                   |
/// | mat73     | .mat               | everything, bit for bit (HDF5 inside)                  |
/// | csv       | .csv .txt          | everything, bit for bit                                |
/// | uff       | .uff .unv .uf      | Universal File, 58b: samples bit for bit               |
/// | uff_ascii | .uff .unv .uf      | Universal File, 58: samples to 13 digits               |
///
/// The layouts are described in docs/howto/record.md. Files of other programs are read as far as
/// they make sense; what was left out or repaired is said in the reader's notes.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

enum class RecordFormat { hdf5, mat5, mat73, csv, uff, uff_ascii };

/// "hdf5", "mat5", "mat73", "csv", "uff", "uff-ascii".
std::string_view format_text(RecordFormat format);
std::optional<RecordFormat> format_from_text(std::string_view text);
/// What a file of that name is written as (.mat as mat5, .uff as uff). Throws base::InputError
/// naming the endings that are known.
RecordFormat format_of_ending(const std::string& path);

/// Writes a record sample by sample into `PATH.part`, which becomes PATH at close(): until then a
/// file that was there before stays, and after a crash or a kill the part that was written so far
/// can be read from `PATH.part` (HDF5, MAT 7.3, CSV), as it can after a failure to write, whose
/// message names it. Otherwise a writer that goes without close() takes its part with it.
class RecordWriter {
 public:
  RecordWriter() = default;
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;
  virtual ~RecordWriter() = default;

  /// Appends samples, one row each. Throws std::invalid_argument for a wrong number of columns or
  /// after close(), base::ComputationError when the disk is full.
  virtual void append(const Eigen::Ref<const Samples>& samples) = 0;
  /// Completes the file. Throws base::ComputationError.
  virtual void close() = 0;
};

/// Throws std::invalid_argument for a header that does not hold (validate), base::InputError where
/// the file cannot be made.
std::unique_ptr<RecordWriter> open_record_writer(const std::string& path,
                                                 const RecordHeader& header, RecordFormat format);
/// The same, with the format of the file's ending.
std::unique_ptr<RecordWriter> open_record_writer(const std::string& path,
                                                 const RecordHeader& header);

struct ReadOptions {
  std::optional<double>
      sample_rate{};  ///< [Hz] for files that do not tell it; else the file's holds
};

/// Reads a record from beginning to end.
class RecordReader {
 public:
  RecordReader() = default;
  RecordReader(const RecordReader&) = delete;
  RecordReader& operator=(const RecordReader&) = delete;
  virtual ~RecordReader() = default;

  [[nodiscard]] virtual RecordFormat format() const = 0;
  [[nodiscard]] virtual const RecordHeader& header() const = 0;
  /// Number of samples that can be read; not known before the end of a text file.
  [[nodiscard]] virtual std::optional<std::int64_t> sample_count() const = 0;
  /// Fills the first rows of `block` with the next samples and returns how many; 0 at the end.
  /// `block` has a column per channel and at least one row. Throws base::InputError where the file
  /// is damaged so that nothing sensible follows.
  virtual std::int64_t read(Eigen::Ref<Samples> block) = 0;
  /// What was skipped, converted or missing so far; warnings, complete once read() returned 0.
  [[nodiscard]] virtual const std::vector<base::Diagnostic>& notes() const = 0;
};

/// Recognises the format by what the file holds. Throws base::InputError.
std::unique_ptr<RecordReader> open_record_reader(const std::string& path,
                                                 const ReadOptions& options = {});

/// A block for `reader` of about a megabyte.
Samples make_block(const RecordHeader& header);

struct ReadRecordResult {
  Record record{};
  std::vector<base::Diagnostic> notes{};
};

/// The whole record at once.
ReadRecordResult read_record(const std::string& path, const ReadOptions& options = {});
void write_record(const std::string& path, const Record& record, RecordFormat format);

}  // namespace hydrapod::data
