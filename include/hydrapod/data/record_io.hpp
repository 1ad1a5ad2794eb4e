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
/// | rpc       | .rpc .rsp .drv .tim| RPC III: header; samples as 32-bit floats              |
/// | rpc_short | .rpc .rsp .drv .tim| RPC III: header; samples as 16-bit integers with scale |
///
/// The layouts are described in docs/howto/record.md and docs/rpc-iii.md. Files of other programs
/// are read as far as they make sense; what was left out or repaired is said in the reader's notes.
///
/// Named variables in a MAT file of version 5 or in HDF5, for results that are no record.
///
/// The writers of MAT files are hydrapod's own. libmatio 1.5.23 cannot append to a variable of
/// version 5. On a full disk its functions for version 5 return 0 and leave a truncated file, those
/// for version 7.3 end in a segmentation fault. Files of version 7.3 have time stamps, so that
/// equal records are not equal files. tests/data/matio_test.cpp reads with libmatio what is written
/// here, and the reverse.

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

enum class RecordFormat { hdf5, mat5, mat73, csv, uff, uff_ascii, rpc, rpc_short };

/// "hdf5", "mat5", "mat73", "csv", "uff", "uff-ascii", "rpc", "rpc-short".
std::string_view format_text(RecordFormat format);
std::optional<RecordFormat> format_from_text(std::string_view text);
/// What a file of that name is written as (.mat as mat5, .uff as uff, .rsp as rpc). Throws
/// base::InputError naming the endings that are known.
RecordFormat format_of_ending(const std::string& path);

class Checksum;  // private to the module

/// Writes a record sample by sample into `PATH.part`, which becomes PATH at close(): until then a
/// file that was there before stays, and after a crash or a kill the part that was written so far
/// can be read from `PATH.part` (all formats), as it can after a failure to write, whose
/// message names it. Otherwise a writer that goes without close() takes its part with it.
class RecordWriter {
 public:
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;
  virtual ~RecordWriter();

  /// Appends samples, one row each. Throws std::invalid_argument for a wrong number of columns or
  /// after close(), base::ComputationError when the disk is full.
  void append(const Eigen::Ref<const Samples>& samples);
  /// Completes the file; where it then is. A record that ended early (not `complete`) does not
  /// replace a file that was there before, but stays beside it as a part. Throws
  /// base::ComputationError.
  std::string close(bool complete = true);

  /// What the format could not hold of the record; complete after close().
  [[nodiscard]] virtual std::vector<base::Diagnostic> notes() const { return {}; }

 protected:
  /// `summed`: the format keeps samples bit for bit, and the file gets their checksum.
  explicit RecordWriter(const RecordHeader& header, bool summed = true);
  /// Of what was written so far, see Checksum.
  [[nodiscard]] std::string checksum() const;

 private:
  virtual void write(const Eigen::Ref<const Samples>& samples) = 0;
  virtual std::string finish(bool complete) = 0;

  std::size_t channels_;
  std::unique_ptr<Checksum> checksum_;
  bool closed_{};
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
      sample_rate{};  ///< [Hz] for files that do not tell it; refused where the file's is another
};

/// What a file of a measurement holds.
enum class FileKind {
  record,
  frequency_responses,  ///< Universal File with functions of type 4, a table of text, or arrays
  modal_results,        ///< Universal File with modes (55, 2414) and no function
  mode_table,           ///< CSV with a column of frequencies and none of times
  json,
  toml
};

/// Told by what the file holds; TOML by its ending. Throws base::InputError where the file cannot
/// be read.
FileKind file_kind(const std::string& path);

class RecordReader;  // private to the module: one file

/// Of a file that was read to its end.
enum class ChecksumFinding {
  none,    ///< the file has none: another program wrote it, or it was not completed
  holds,   ///< channels and samples are those that were written
  differs  ///< they are not: the file was damaged or changed
};

/// The records of one experiment, one or several files with the same channels and sample rate. Each
/// file is opened once, its format found by what it holds; samples stream from the open file as
/// often as they are wanted.
class RecordSet {
 public:
  /// Throws base::InputError for a file that is no record, for one that is named twice, and for one
  /// whose channels or sample rate are not those of the first; std::invalid_argument for no file.
  explicit RecordSet(std::vector<std::string> files, const ReadOptions& options = {});
  /// The same of records in memory, whose samples are not copied. `names` stand for files in
  /// messages. Throws as the other, and std::invalid_argument for a header that does not hold, for
  /// samples of another number of columns, and for other numbers of names than of records.
  RecordSet(std::vector<std::shared_ptr<const Record>> records, std::vector<std::string> names,
            const ReadOptions& options = {});
  RecordSet(RecordSet&&) noexcept;
  RecordSet& operator=(RecordSet&&) noexcept;
  ~RecordSet();

  /// The same samples once more, with what is taken as missing now, to be streamed on another
  /// thread; none where samples of a file are not in memory.
  [[nodiscard]] std::optional<RecordSet> of_memory() const;

  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }
  /// Nothing for a record in memory.
  [[nodiscard]] std::optional<RecordFormat> format(std::size_t file = 0) const;
  /// Of a file; title, notes and experiment of the set are those of the first.
  [[nodiscard]] const RecordHeader& header(std::size_t file = 0) const;
  [[nodiscard]] const Experiment& experiment() const { return header().experiment; }

  /// Samples of all files; none where a text file that was not read to its end does not tell.
  [[nodiscard]] std::optional<std::int64_t> sample_count() const;
  /// Samples of a file, which is read to its end where it does not tell.
  std::int64_t count_samples(std::size_t file);

  /// `block` is a piece of `file`; false ends the reading.
  using Use = std::function<bool(std::size_t file, const Eigen::Ref<const Samples>& block)>;
  /// All samples from the beginning, file after file, in blocks of about a megabyte. False when
  /// `use` ended it. Throws base::InputError where a file is damaged so that nothing sensible
  /// follows.
  bool stream(const Use& use);

  /// From the next time on that a file is read to its end its samples stay in memory, where those
  /// of all channels and files are at most `most`: it is not read again.
  void keep_samples(std::int64_t most) { most_kept_ = most; }

  /// After the file was read to its end.
  [[nodiscard]] ChecksumFinding checksum(std::size_t file = 0) const;

  /// What was skipped, converted or missing, of all files: at opening and in the last stream().
  [[nodiscard]] std::vector<base::Diagnostic> notes() const;

  /// Samples begin … end of a channel of a file.
  struct Stretch {
    std::size_t file{}, channel{};
    std::int64_t begin{}, end{};
    bool operator==(const Stretch&) const = default;
  };
  /// From now on these are missing (NaN) in stream(), in place of those of the last call.
  void take_as_missing(std::vector<Stretch> stretches);
  [[nodiscard]] const std::vector<Stretch>& taken_as_missing() const { return missing_; }

 private:
  RecordSet(const RecordSet&);
  void add(std::shared_ptr<RecordReader> reader);
  bool stream_file(std::size_t file, const Use& use);
  bool stream_kept(std::size_t file, const Use& use) const;
  [[nodiscard]] bool keeps() const;
  [[nodiscard]] bool misses(std::size_t file, std::int64_t first, std::int64_t rows) const;
  void blank(std::size_t file, std::int64_t first, Eigen::Ref<Samples> block) const;

  std::vector<std::string> files_;
  std::vector<std::shared_ptr<RecordReader>> readers_;
  std::vector<std::optional<std::int64_t>> counts_;
  std::vector<Stretch> missing_;
  std::int64_t most_kept_{};
  std::vector<std::shared_ptr<const Samples>> kept_;  // of each file; none: it is read
};

/// A block of about a megabyte for samples of `header`.
Samples make_block(const RecordHeader& header);

struct ReadRecordResult {
  Record record{};
  std::vector<base::Diagnostic> notes{};
};

/// The whole record at once.
ReadRecordResult read_record(const std::string& path, const ReadOptions& options = {});
void write_record(const std::string& path, const Record& record, RecordFormat format);

/// An array of numbers, a text, or a row of texts (a cell array).
struct MatVariable {
  std::string name{};
  std::vector<int> size{};  ///< of the array, two numbers or more; numbers by columns
  std::vector<double> real{};
  std::vector<double> imaginary{};  ///< empty: real
  std::vector<std::string> texts{};
  bool is_number{}, is_text{}, is_list{};  ///< none: an array
};

MatVariable mat_number(const std::string& name, double value);
MatVariable mat_array(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& values);
MatVariable mat_complex(const std::string& name, const Eigen::Ref<const Eigen::MatrixXcd>& values);
/// One matrix behind the other: rows × columns × pages. All of one size.
MatVariable mat_pages(const std::string& name, std::span<const Eigen::MatrixXcd> pages);
MatVariable mat_pages(const std::string& name, std::span<const Eigen::MatrixXd> pages);
MatVariable mat_text(const std::string& name, const std::string& text);
MatVariable mat_list(const std::string& name, const std::vector<std::string>& texts);

/// Written whole or not at all. Throws std::invalid_argument for names that MATLAB does not take
/// and sizes that do not fit, base::ComputationError for more than 2 GiB, else as
/// base::write_file_whole.
void write_mat_variables(const std::string& path, const std::vector<MatVariable>& variables);

/// The same as datasets of an HDF5 file, laid out as numpy has them: an array of rows × columns ×
/// pages is pages × rows × columns there, complex numbers are pairs (r, i), a single row or column
/// is a list. Texts `format`, `title` and `date` and single numbers are attributes of the file.
void write_hdf5_variables(const std::string& path, const std::vector<MatVariable>& variables);

}  // namespace hydrapod::data
