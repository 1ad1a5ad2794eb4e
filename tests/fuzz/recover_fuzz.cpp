/// What a killed run, a full disk or damage has left of a record of hydrapod, recovered.
///
/// Of a file that was cut off, and of the part of a record that was not completed, the recovered
/// record holds the first samples as they were written, or is refused. Of a damaged file it may
/// hold anything that can be read again.

#include "hydrapod/data/processing.hpp"
#include "record_recipe.hpp"

namespace {

using hydrapod::data::RecordFormat;
namespace data = hydrapod::data;
namespace fuzz = hydrapod::fuzz;

/// The bytes of the part of a record whose writer does not come to its end.
std::string part_of(const data::Record& record, RecordFormat format, const fuzz::Folder& folder) {
  const std::string path = folder.file("run");
  const auto writer = data::open_record_writer(path, record.header, format);
  const Eigen::Index half = record.samples.rows() / 2;
  writer->append(record.samples.topRows(half));
  writer->append(record.samples.bottomRows(record.samples.rows() - half));
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("")))
    if (entry.path().filename().string().starts_with("run.")) return fuzz::bytes_of(entry.path());
  return {};
}

/// Rows again and again: more than a writer holds back.
void make_long(data::Record& record, Eigen::Index rows) {
  const data::Samples few = record.samples;
  record.samples = data::Samples::NullaryExpr(
      rows, few.cols(), [&](Eigen::Index k, Eigen::Index c) { return few(k % few.rows(), c); });
}

/// Whether `path` holds the first `count` samples of `written`, and its checksum is right.
bool holds_first(const std::string& path, const data::Record& written, std::int64_t count) {
  data::Record first = written;
  if (count > written.samples.rows()) return false;
  first.samples.conservativeResize(count, Eigen::NoChange);
  data::RecordSet read({path});
  return !fuzz::differs(read, first) && read.checksum() == data::ChecksumFinding::holds;
}

}  // namespace

/// HDF5 leaks what it had read of a file that it then refuses.
extern "C" int __lsan_is_turned_off() { return 1; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  using enum RecordFormat;
  static const fuzz::Folder folder;
  static const std::string whole = folder.file("whole"), to = folder.file("recovered");
  FuzzedDataProvider bytes(input, size);
  const auto format =
      bytes.PickValueInArray({hdf5, mat73, mat5, csv, uff, uff_ascii, rpc, rpc_short});
  data::Record record = fuzz::record_from(bytes);
  if (bytes.ConsumeIntegralInRange(0, 15) == 9) make_long(record, 9000);
  std::string file;
  const bool is_part = bytes.ConsumeBool();
  if (is_part) {
    file = part_of(record, format, folder);
  } else {
    data::write_record(whole, record, format);
    file = fuzz::bytes_of(whole);
  }
  if (bytes.ConsumeBool()) file.resize(bytes.ConsumeIntegralInRange<std::size_t>(0, file.size()));
  const bool damaged = fuzz::damage(bytes, file);
  data::RecoverResult result;
  const bool recovered = fuzz::accepted([&] {
    const std::string& from = fuzz::file_of(file);
    result = fuzz::with_a_rate([&](const auto& options) {
      return data::recover_record(from, to, {.format = mat5, .read = options});
    });
  });
  if (!recovered) return 0;
  if (result.samples < 1 || result.file != to) std::abort();
  for (const auto& note : result.notes) fuzz::require_presentable(note);
  if (damaged || !fuzz::is_bit_for_bit(format) || result.uneven) {
    fuzz::read_to_the_end(to);
  } else if (!holds_first(to, record, result.samples)) {
    std::fprintf(stderr, "%s%s: %lld of %lld samples recovered otherwise than they were written\n",
                 std::string(data::format_text(format)).c_str(), is_part ? ", the part" : "",
                 static_cast<long long>(result.samples),
                 static_cast<long long>(record.samples.rows()));
    std::abort();
  }
  return 0;
}
