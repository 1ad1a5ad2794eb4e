#include "hydrapod/data/record_io.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "channel_units.hpp"
#include "checksum.hpp"
#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "response_files.hpp"
#include "spool.hpp"
#include "uff_dataset.hpp"

namespace hydrapod::data {

namespace {

constexpr std::array<std::string_view, 8> format_names{"hdf5", "mat5",      "mat73", "csv",
                                                       "uff",  "uff-ascii", "rpc",   "rpc-short"};
struct Ending {
  std::string_view ending;
  RecordFormat format;
};
constexpr std::array endings{
    Ending{".h5", RecordFormat::hdf5},  Ending{".hdf5", RecordFormat::hdf5},
    Ending{".mat", RecordFormat::mat5}, Ending{".csv", RecordFormat::csv},
    Ending{".txt", RecordFormat::csv},  Ending{".uff", RecordFormat::uff},
    Ending{".unv", RecordFormat::uff},  Ending{".uf", RecordFormat::uff},
    Ending{".rpc", RecordFormat::rpc},  Ending{".rsp", RecordFormat::rpc},
    Ending{".drv", RecordFormat::rpc},  Ending{".tim", RecordFormat::rpc}};

/// The first bytes of a file that must be a regular one.
std::string head_of(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0)
    base::refuse(path, fmt::format("cannot read the file: {}", std::strerror(errno)));
  if (!S_ISREG(info.st_mode))
    base::refuse(path,
                 "cannot read the file: a record is read from a regular file, not from a folder, "
                 "pipe or device");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) base::refuse(path, fmt::format("cannot read the file: {}", std::strerror(errno)));
  std::string head(1024, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  if (head.empty()) base::refuse(path, "the file is empty");
  return head;
}

bool has_hdf5_signature(std::string_view head) {
  constexpr std::string_view signature{"\x89HDF\r\n\x1a\n", 8};
  return head.starts_with(signature.substr(0, 4)) ||
         (head.size() >= 520 && head.substr(512).starts_with(signature));
}

/// Version 0x0100 and the mark of the byte order, whatever text stands before them.
bool has_mat5_mark(std::string_view head) {
  if (head.size() < 128) return false;
  return head.substr(124, 4) == std::string_view("\0\1IM", 4) ||
         head.substr(124, 4) == std::string_view("\1\0MI", 4);
}

/// What opens a file of named arrays; null for another file.
OpenVariableFile opens_variables(std::string_view head) {
  if (has_hdf5_signature(head)) return open_hdf5_variables;
  return head.starts_with("MATLAB 5.0") || has_mat5_mark(head) ? open_mat5_file : nullptr;
}

/// The first line that is not blank is "    -1".
bool begins_as_uff(std::string_view head) {
  const std::size_t text = std::min(head.find_first_not_of(" \t\r\n"), head.size());
  const std::size_t end = std::min(head.find_first_of("\r\n", text), head.size());
  head = head.substr(0, end);
  const std::string_view line = head.substr(head.find_last_of("\r\n", text) + 1);
  return line.starts_with("    -1") && base::trimmed(line) == "-1";
}

/// The first two keys of an RPC III file, each with a zero behind it.
bool begins_as_rpc(std::string_view head) {
  return head.starts_with("FORMAT") && head.substr(0, 160).find('\0') != head.npos &&
         head.find("NUM_HEADER_BLOCKS") != head.npos;
}

/// What a file that is no record holds instead, and what reads it.
[[noreturn]] void refuse_other_kind(const std::string& path, FileKind kind) {
  if (kind == FileKind::frequency_responses)
    base::refuse(path,
                 "holds frequency responses, no samples over time; `hydrapod identify` finds their "
                 "modes, `hydrapod frf` shows and converts them");
  if (kind == FileKind::modal_results)
    base::refuse(path, "holds modes (dataset 55 or 2414), no samples over time");
  base::refuse(path,
               "is JSON, no record; `hydrapod identify` reads the frequency responses of `hydrapod "
               "frf --format json`");
}

std::unique_ptr<RecordReader> open_by_content(const std::string& path, const ReadOptions& options,
                                              bool damaged) {
  const std::string head = head_of(path);
  if (has_hdf5_signature(head)) return make_hdf5_reader(path, options);
  if (opens_variables(head) != nullptr) return make_mat5_reader(path, options);
  if (begins_as_uff(head)) return make_uff_reader(path);
  if (begins_as_rpc(head)) return make_rpc_reader(path);
  if (head.starts_with(spool_mark)) return make_spool_reader(path);
  if (base::is_utf16(head)) base::refuse(path, std::string(base::utf16_refused));
  if (head.find('\0') != std::string::npos)
    base::refuse(path,
                 "this is not a record: it is neither HDF5, MAT, Universal File, RPC III nor text");
  return make_csv_reader(path, options, damaged);
}

std::unique_ptr<RecordReader> open_valid(const std::string& path, const ReadOptions& options,
                                         bool damaged) {
  std::unique_ptr<RecordReader> reader;
  try {
    reader = open_by_content(path, options, damaged);
  } catch (const base::InputError&) {
    const FileKind kind = file_kind(path);
    if (kind != FileKind::record && kind != FileKind::mode_table && kind != FileKind::toml)
      refuse_other_kind(path, kind);
    throw;
  }
  try {
    validate(reader->header());
  } catch (const std::invalid_argument& error) {
    base::refuse(path, error.what());
  }
  require_rate(path, *reader, options);
  return reader;
}

}  // namespace

void require_rate(const std::string& name, const RecordReader& reader, const ReadOptions& options) {
  constexpr double tolerance = 1e-3;
  const double stated = reader.header().sample_rate;
  if (!options.sample_rate || std::abs(stated - *options.sample_rate) <= tolerance * stated) return;
  const char* const what = reader.format() ? "file" : "record";
  base::refuse(name, fmt::format("{}: the {} states {:.9g} Hz, but --rate says {:.9g} Hz; expected "
                                 "is the rate of the {}: leave --rate out, or resample the record "
                                 "(`record resample`)",
                                 reader.rate_key(), what, stated, *options.sample_rate, what));
}

bool begins_as_hdf5(const std::string& path) { return has_hdf5_signature(head_of(path)); }

std::unique_ptr<RecordReader> open_reader(const std::string& path, const ReadOptions& options) {
  return open_valid(path, options, false);
}

std::unique_ptr<RecordReader> open_damaged_reader(const std::string& path,
                                                  const ReadOptions& options) {
  return open_valid(path, options, true);
}

namespace {

/// A column of frequencies and none of times in the title row.
bool is_mode_table(const std::string& path) {
  base::TableReader table(path);
  bool frequency = false;
  for (const base::TableTitle& title : table.titles()) {
    const std::string name = base::lower_case(title.name);
    if (name.find("time") != name.npos) return false;
    frequency = frequency || name.starts_with("frequency") || name.starts_with("omega");
  }
  return frequency;
}

}  // namespace

std::string_view format_text(RecordFormat format) {
  return format_names.at(static_cast<std::size_t>(format));
}

std::optional<RecordFormat> format_from_text(std::string_view text) {
  const auto at = std::find(format_names.begin(), format_names.end(), text);
  if (at == format_names.end()) return {};
  return static_cast<RecordFormat>(at - format_names.begin());
}

RecordFormat format_of_ending(const std::string& path) {
  const std::string found = base::lower_case(std::filesystem::path(path).extension().string());
  for (const auto& known : endings)
    if (found == known.ending) return known.format;
  base::refuse(
      path, fmt::format("the ending '{}' names no format of records; known are .h5, .hdf5, .mat, "
                        ".csv, .txt, .uff, .unv, .uf, .rpc, .rsp, .drv and .tim",
                        base::printable(found)));
}

std::unique_ptr<RecordWriter> open_record_writer(const std::string& path,
                                                 const RecordHeader& header, RecordFormat format) {
  validate(header);
  switch (format) {
    case RecordFormat::hdf5:
    case RecordFormat::mat73:
      return make_hdf5_writer(path, header, format == RecordFormat::mat73);
    case RecordFormat::csv:
      return make_csv_writer(path, header);
    case RecordFormat::uff:
    case RecordFormat::uff_ascii:
      return make_uff_writer(path, header, format == RecordFormat::uff);
    case RecordFormat::mat5:
      return make_mat5_writer(path, header);
    case RecordFormat::rpc:
    case RecordFormat::rpc_short:
      return make_rpc_writer(path, header, format == RecordFormat::rpc_short);
  }
  throw std::invalid_argument("open_record_writer: unknown format");
}

std::unique_ptr<RecordWriter> open_record_writer(const std::string& path,
                                                 const RecordHeader& header) {
  return open_record_writer(path, header, format_of_ending(path));
}

FileKind file_kind(const std::string& path) {
  if (base::has_ending(path, {".toml"})) return FileKind::toml;
  const std::string head = head_of(path);
  if (begins_as_uff(head)) return uff_kind(path);
  if (const auto open = opens_variables(head)) {
    Notes notes(path);
    return holds_responses(*open(path, notes)) ? FileKind::frequency_responses : FileKind::record;
  }
  if (head.find('\0') != std::string::npos || head.starts_with(spool_mark)) return FileKind::record;
  if (base::trimmed(head).starts_with('{')) return FileKind::json;
  if (is_response_table(path)) return FileKind::frequency_responses;
  return is_mode_table(path) ? FileKind::mode_table : FileKind::record;
}

ReadFrequencyResponsesResult read_frequency_responses(const std::string& path) {
  const std::string head = head_of(path);
  if (const auto open = opens_variables(head)) return read_response_arrays(path, open);
  return begins_as_uff(head) ? read_uff_responses(path) : read_response_table(path);
}

std::int64_t RecordReader::read(Eigen::Ref<Samples> block) {
  if (!opened_) opened_ = notes_;
  const auto wanted = count_ ? std::min<std::int64_t>(*count_ - done_, block.rows()) : block.rows();
  const std::int64_t rows = wanted > 0 ? read_values(block.topRows(wanted)) : 0;
  for (Eigen::Index c = 0; c < block.cols(); ++c)
    if (const double factor = factors_[static_cast<std::size_t>(c)]; factor != 1.0)
      block.col(c).head(rows) *= factor;
  done_ += rows;
  if (checksum_ && finding_ == ChecksumFinding::none) check_sum(block.topRows(rows));
  return rows;
}

void RecordReader::check_sum(const Eigen::Ref<const Samples>& samples) {
  checksum_->add(samples);
  const bool at_end = samples.rows() == 0 || (count_ && done_ == *count_);
  if (!at_end || !has_checksum()) return;
  const bool holds = stated_checksum_ == checksum_->text();
  finding_ = holds ? ChecksumFinding::holds : ChecksumFinding::differs;
  if (!holds) notes_.add(checksum_differs);
}

void RecordReader::rewind() {
  if (!opened_) return;
  notes_ = *opened_;
  done_ = 0;
  finding_ = ChecksumFinding::none;
  if (checksum_) begin_checksum();
  to_first_sample();
}

void RecordReader::settle_channels(bool by_hydrapod) {
  make_names_unique(header_.channels);
  factors_ = to_si(header_.channels, notes_, by_hydrapod);
}

void RecordReader::note_unfinished() {
  unfinished_ = true;
  notes_.add("the record was not completed: what was written last may be missing");
}

void RecordReader::begin_checksum() { checksum_ = std::make_unique<Checksum>(header_); }

Eigen::Index rows_at_once(const RecordHeader& header) {
  constexpr std::size_t bytes = 1 << 20;
  return static_cast<Eigen::Index>(
      std::clamp<std::size_t>(bytes / (sizeof(double) * header.channels.size()), 1, 65536));
}

Samples make_block(const RecordHeader& header) {
  return Samples::Zero(rows_at_once(header), std::ssize(header.channels));
}

ReadRecordResult read_record(const std::string& path, const ReadOptions& options) {
  RecordSet set({path}, options);
  ReadRecordResult result{.record = {.header = set.header()}};
  std::vector<double> values;
  set.stream([&](std::size_t /*file*/, const Eigen::Ref<const Samples>& block) {
    values.insert(values.end(), block.data(), block.data() + block.size());
    return true;
  });
  const auto columns = static_cast<Eigen::Index>(set.header().channels.size());
  result.record.samples = Eigen::Map<const Samples>(
      values.data(), static_cast<Eigen::Index>(values.size()) / columns, columns);
  result.notes = set.notes();
  return result;
}

void write_record(const std::string& path, const Record& record, RecordFormat format) {
  const auto writer = open_record_writer(path, record.header, format);
  writer->append(record.samples);
  writer->close();
}

RecordWriter::RecordWriter(const RecordHeader& header, bool summed)
    : channels_(header.channels.size()),
      checksum_(summed ? std::make_unique<Checksum>(header) : nullptr) {}

RecordWriter::~RecordWriter() = default;

void RecordWriter::append(const Eigen::Ref<const Samples>& samples) {
  if (samples.cols() != static_cast<Eigen::Index>(channels_))
    throw std::invalid_argument(
        fmt::format("RecordWriter::append: {} columns for {} channels", samples.cols(), channels_));
  if (closed_) throw std::invalid_argument("RecordWriter::append: the record is closed");
  write(samples);
  if (checksum_) checksum_->add(samples);
}

std::string RecordWriter::close(bool complete) {
  closed_ = true;
  return finish(complete);
}

std::string RecordWriter::checksum() const { return checksum_->text(); }

bool is_time_of_sample(double time, double start, double step, std::uint64_t sample) {
  const double planned = start + static_cast<double>(sample) * step;
  return std::abs(time - planned) <= 0.1 * step + 1e-5 * std::abs(planned);
}

double rounded_rate(double rate, double tolerance) {
  const double whole = std::round(rate);
  return whole > 0.0 && std::abs(rate - whole) <= tolerance * whole ? whole : rate;
}

}  // namespace hydrapod::data
