#include "hydrapod/data/processing.hpp"

#include <fmt/format.h>

#include "formats.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/version.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

using Diagnostics = std::vector<base::Diagnostic>;

/// None where the writer was killed, as it wrote more than the header tells.
std::optional<std::int64_t> declared_by(const RecordReader& reader) {
  return reader.unfinished() ? std::nullopt : reader.declared();
}

bool lacks_samples(const RecordReader& reader) {
  return reader.declared() && reader.sample_count().value_or(0) < *reader.declared();
}

/// The usual reader where it reads all; else what finds more.
std::unique_ptr<RecordReader> open_damaged(const std::string& path, const ReadOptions& options) {
  if (!begins_as_hdf5(path)) return open_damaged_reader(path, options);
  std::unique_ptr<RecordReader> usual;
  Diagnostics why;
  try {
    usual = open_reader(path, options);
    if (!lacks_samples(*usual)) return usual;
  } catch (const base::InputError& error) {
    why = error.diagnostics();
    if (why.back().message == hdf5_not_opened) why.clear();  // the other one says more
  }
  try {
    auto remains = make_hdf5_remains_reader(path);
    if (!usual || remains->sample_count() > usual->sample_count()) return remains;
  } catch (const base::InputError& error) {
    why.insert(why.end(), error.diagnostics().begin(), error.diagnostics().end());
  }
  if (!usual) throw base::InputError(std::move(why));
  return usual;
}

/// With a line in the notes that says where it is from.
RecordHeader header_of(const RecordReader& reader, const std::string& path) {
  RecordHeader header = reader.header();
  if (!header.notes.empty() && !header.notes.ends_with('\n')) header.notes += '\n';
  header.notes += fmt::format(
      "recovered by hydrapod {} from {}{}\n", base::version, base::printable(path),
      declared_by(reader) ? fmt::format(", which was written with {} samples", *declared_by(reader))
                          : "");
  return header;
}

void add_as_warnings(const Diagnostics& diagnostics, Diagnostics& all) {
  for (base::Diagnostic d : diagnostics) {
    d.severity = base::Severity::warning;
    all.push_back(std::move(d));
  }
}

/// A checksum of the whole record says nothing of a part: the finding, and what the reader says of
/// it. Where it holds, all is there, whatever the file says.
void settle_checksum(const RecordReader& reader, bool ended_early, RecoverResult& result) {
  result.has_checksum = reader.has_checksum();
  result.checksum = reader.checksum();
  if (result.checksum == ChecksumFinding::holds) result.declared = result.samples;
  const bool part = ended_early || result.uneven || !result.complete ||
                    (result.declared && result.samples < *result.declared);
  if (!part || result.checksum != ChecksumFinding::differs) return;
  result.checksum = ChecksumFinding::none;
  std::erase_if(result.notes, [](const auto& note) { return note.message == checksum_differs; });
}

}  // namespace

RecoverResult recover_record(const std::string& damaged, const std::string& to,
                             const RecoverOptions& options) {
  const auto reader = open_damaged(damaged, options.read);
  const RecordHeader header = header_of(*reader, damaged);
  RecoverResult result{.declared = declared_by(*reader),
                       .unfinished = reader->unfinished(),
                       .uneven = reader->uneven()};
  const auto writer = open_record_writer(to, header, options.format);
  Diagnostics ended;
  try {
    Samples block = make_block(header);
    while (const std::int64_t rows = reader->read(block)) {
      writer->append(block.topRows(rows));
      result.samples += rows;
      const auto count = reader->sample_count().value_or(0);
      const double share =
          count > 0 ? static_cast<double>(result.samples) / static_cast<double>(count) : 0.0;
      result.complete = !options.progress || options.progress(share);
      if (!result.complete) break;
    }
  } catch (const base::InputError& error) {  // what came before it is sound
    add_as_warnings(error.diagnostics(), ended);
  }
  result.notes = reader->notes();
  result.notes.insert(result.notes.end(), ended.begin(), ended.end());
  if (result.samples == 0) {
    result.notes.push_back({.file = damaged, .message = "not one sample can be read"});
    throw base::InputError(std::move(result.notes));
  }
  settle_checksum(*reader, !ended.empty(), result);
  result.file = writer->close(result.complete);
  const auto notes = writer->notes();
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  return result;
}

}  // namespace hydrapod::data
