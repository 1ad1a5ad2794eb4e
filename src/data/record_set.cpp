#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "formats.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/data/record_io.hpp"

namespace hydrapod::data {

namespace {

bool same_channels(const RecordHeader& a, const RecordHeader& b) {
  return a.sample_rate == b.sample_rate &&
         std::ranges::equal(a.channels, b.channels, {}, &Channel::name, &Channel::name);
}

bool same_unit(const std::string& a, const std::string& b) {
  if (a == b) return true;
  if (a.empty() || b.empty() || a == "1" || b == "1" || !base::si_unit(a) || !base::si_unit(b))
    return false;
  return base::read_quantity("1 " + a, b).ok();
}

/// One number of another unit in an average makes all of it wrong.
void refuse_other_units(const RecordHeader& first, const RecordHeader& other,
                        const std::string& first_file, const std::string& file) {
  const auto words = [](const std::string& unit) {
    return unit.empty() ? std::string("no unit") : base::printable(unit, 30);
  };
  for (std::size_t c = 0; c < first.channels.size(); ++c) {
    const auto &one = first.channels[c], &two = other.channels[c];
    if (!same_unit(one.unit, two.unit))
      base::refuse(file, fmt::format("{} is in {} and in {} it is in {}: records that are averaged "
                                     "together have the same units, or such that lead to SI",
                                     base::printable(two.name), words(two.unit), first_file,
                                     words(one.unit)));
  }
}

/// Channels that differ in the names of those that drive alone.
bool differ_in_inputs(const RecordHeader& a, const RecordHeader& b) {
  if (a.sample_rate != b.sample_rate || same_channels(a, b)) return false;
  const auto drives = [](const Channel& channel) {
    return channel.role == Role::excitation || channel.role == Role::drive;
  };
  return std::ranges::equal(a.channels, b.channels, [&](const Channel& one, const Channel& other) {
    return one.name == other.name || (drives(one) && drives(other));
  });
}

/// A record in memory as a file of a set, which has its samples.
class RecordInMemory : public RecordReader {
 public:
  RecordInMemory(const std::string& name, const Record& record) : RecordReader(name) {
    if (record.samples.cols() != std::ssize(record.header.channels))
      throw std::invalid_argument(fmt::format("{}: {} columns of samples for {} channels", name,
                                              record.samples.cols(),
                                              record.header.channels.size()));
    validate(record.header);
    header_ = record.header;
    count_ = record.samples.rows();
  }

 private:
  std::int64_t read_values(Eigen::Ref<Samples> /*block*/) override { return 0; }
};

/// `is_same(k, before)`. It would count twice in every average.
template <class IsSame>
void refuse_repeated(const std::vector<std::string>& names, const IsSame& is_same) {
  for (std::size_t k = 1; k < names.size(); ++k)
    for (std::size_t before = 0; before < k; ++before)
      if (is_same(k, before))
        base::refuse(names[k], fmt::format("is given twice, as {} before; it would count twice",
                                           names[before]));
}

}  // namespace

RecordSet::RecordSet(std::vector<std::string> files, const ReadOptions& options)
    : files_(std::move(files)) {
  if (files_.empty()) throw std::invalid_argument("RecordSet: no file is named");
  refuse_repeated(files_, [&](std::size_t k, std::size_t before) {
    std::error_code absent;
    return std::filesystem::equivalent(files_[k], files_[before], absent);
  });
  for (const auto& file : files_) add(open_reader(file, options));
}

RecordSet::RecordSet(std::vector<std::shared_ptr<const Record>> records,
                     std::vector<std::string> names, const ReadOptions& options)
    : files_(std::move(names)) {
  if (records.empty() || records.size() != files_.size())
    throw std::invalid_argument("RecordSet: expected records, and a name for each");
  refuse_repeated(files_,
                  [&](std::size_t k, std::size_t before) { return records[k] == records[before]; });
  for (std::size_t k = 0; k < records.size(); ++k) {
    auto reader = std::make_shared<RecordInMemory>(files_[k], *records[k]);
    require_rate(files_[k], *reader, options);
    add(std::move(reader));
    kept_[k] = {records[k], &records[k]->samples};
  }
}

/// The next one of files_.
void RecordSet::add(std::shared_ptr<RecordReader> reader) {
  const std::string& file = files_[readers_.size()];
  const RecordHeader& own = reader->header();
  const RecordHeader& first = readers_.empty() ? own : header();
  if (differ_in_inputs(first, own))
    base::refuse(file, "other inputs than " + files_[0] +
                           ": records of several inputs, as those of a hammer that roves from "
                           "point to point, are not combined; identify each record by itself, or "
                           "give the responses to all inputs as one file");
  if (!same_channels(first, own))
    base::refuse(file, fmt::format("other channels or another sample rate than {}: records that "
                                   "are averaged together have the same",
                                   files_[0]));
  refuse_other_units(first, own, files_[0], file);
  counts_.push_back(reader->sample_count());
  kept_.emplace_back();
  readers_.push_back(std::move(reader));
}

RecordSet::RecordSet(const RecordSet&) = default;
RecordSet::RecordSet(RecordSet&&) noexcept = default;
RecordSet& RecordSet::operator=(RecordSet&&) noexcept = default;
RecordSet::~RecordSet() = default;

std::optional<RecordSet> RecordSet::of_memory() const {
  if (std::ranges::any_of(kept_, [](const auto& samples) { return samples == nullptr; })) return {};
  return RecordSet(*this);
}

std::optional<RecordFormat> RecordSet::format(std::size_t file) const {
  return readers_.at(file)->format();
}

const RecordHeader& RecordSet::header(std::size_t file) const {
  return readers_.at(file)->header();
}

std::optional<std::int64_t> RecordSet::sample_count() const {
  std::int64_t sum = 0;
  for (const auto& count : counts_) {
    if (!count) return {};
    sum += *count;
  }
  return sum;
}

std::int64_t RecordSet::count_samples(std::size_t file) {
  if (!counts_.at(file)) stream_file(file, [](auto, const auto&) { return true; });
  return *counts_[file];
}

/// Where a text file was not read to its end nobody knows how many samples there are.
bool RecordSet::keeps() const {
  const auto count = sample_count();
  return count && *count <= most_kept_ / std::max<std::int64_t>(1, std::ssize(header().channels));
}

bool RecordSet::stream_file(std::size_t file, const Use& use) {
  if (kept_[file] != nullptr) return stream_kept(file, use);
  RecordReader& reader = *readers_[file];
  reader.rewind();
  Samples block = make_block(reader.header());
  auto all = std::make_shared<Samples>(keeps() ? *counts_[file] : 0, block.cols());
  std::int64_t samples = 0;
  while (const std::int64_t rows = reader.read(block)) {
    if (samples + rows <= all->rows()) all->middleRows(samples, rows) = block.topRows(rows);
    samples += rows;
    blank(file, samples - rows, block.topRows(rows));
    if (!use(file, block.topRows(rows))) return false;
  }
  counts_[file] = samples;
  if (samples > 0 && samples == all->rows()) kept_[file] = std::move(all);
  return true;
}

/// In the same blocks as from the file; they are copied where samples of them are missing.
bool RecordSet::stream_kept(std::size_t file, const Use& use) const {
  const Samples& all = *kept_[file];
  const Eigen::Index at_once = rows_at_once(header(file));
  Samples copy;
  for (Eigen::Index at = 0; at < all.rows(); at += at_once) {
    const auto rows = std::min(at_once, all.rows() - at);
    const bool is_whole = !misses(file, at, rows);
    if (!is_whole) {
      copy = all.middleRows(at, rows);
      blank(file, at, copy);
    }
    if (!(is_whole ? use(file, all.middleRows(at, rows)) : use(file, copy))) return false;
  }
  return true;
}

bool RecordSet::stream(const Use& use) {
  for (std::size_t k = 0; k < readers_.size(); ++k)
    if (!stream_file(k, use)) return false;
  return true;
}

void RecordSet::take_as_missing(std::vector<Stretch> stretches) { missing_ = std::move(stretches); }

/// Is one of so many rows of the file from `first` on taken as missing?
bool RecordSet::misses(std::size_t file, std::int64_t first, std::int64_t rows) const {
  return std::ranges::any_of(missing_, [&](const Stretch& stretch) {
    return stretch.file == file &&
           std::max(stretch.begin, first) < std::min(stretch.end, first + rows);
  });
}

/// `block`: samples of the file from `first` on.
void RecordSet::blank(std::size_t file, std::int64_t first, Eigen::Ref<Samples> block) const {
  for (const Stretch& stretch : missing_) {
    const std::int64_t begin = std::max(stretch.begin, first),
                       end = std::min<std::int64_t>(stretch.end, first + block.rows());
    if (stretch.file == file && begin < end)
      block.col(static_cast<Eigen::Index>(stretch.channel))
          .segment(begin - first, end - begin)
          .setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

std::vector<base::Diagnostic> RecordSet::notes() const {
  std::vector<base::Diagnostic> all;
  for (const auto& reader : readers_)
    all.insert(all.end(), reader->notes().begin(), reader->notes().end());
  return all;
}

ChecksumFinding RecordSet::checksum(std::size_t file) const {
  return readers_.at(file)->checksum();
}

}  // namespace hydrapod::data
