/// Records as files: a look at one, another format, a part of it, another sample rate, a picture,
/// checksums.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/tasks/measurement.hpp"

namespace hydrapod::tasks {

namespace {

data::RecordSet open_record(const RecordOptions& options) {
  return data::RecordSet({options.file}, {.sample_rate = options.sample_rate});
}

data::RecordFormat format_of(const RecordOutput& output) {
  return output.format ? *output.format : data::format_of_ending(output.path);
}

/// The record to its end, block by block. False where `progress` stopped it; its share is 0 where
/// the length is not known.
bool read_blocks(data::RecordSet& record, const Progress& progress,
                 const std::function<void(const Eigen::Ref<const data::Samples>&)>& use) {
  const auto count = record.sample_count();
  std::int64_t done = 0;
  return record.stream([&](std::size_t /*file*/, const auto& block) {
    use(block);
    done += block.rows();
    const double share =
        count && *count > 0 ? static_cast<double>(done) / static_cast<double>(*count) : 0.0;
    return !progress || !progress(share);
  });
}

/// Samples of a record; a table is read to its end for that. Spectra depend on the number, and are
/// not to depend on the format.
std::int64_t count_samples(data::RecordSet& record, const Progress& progress) {
  if (!record.sample_count() &&
      !record.stream([&](auto, const auto&) { return !progress || !progress(0.0); }))
    throw base::ComputationError("interrupted");
  return record.sample_count().value_or(0);
}

data::OverviewBuilder overview_of(data::RecordSet& record, const Progress& progress) {
  return {record.header(), data::default_segment(record.header(), count_samples(record, progress))};
}

[[noreturn]] void refuse_channel(const std::string& name, const data::RecordHeader& header) {
  std::vector<std::string_view> known;
  for (const auto& channel : header.channels) known.push_back(channel.name);
  const auto near = base::nearest(name, known);
  base::refuse("--channel " + name, "the record has no such channel; " +
                                        (near ? fmt::format("did you mean '{}'?", *near)
                                              : fmt::format("it has {}", fmt::join(known, ", "))));
}

/// `*` stands for any text.
bool matches(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == pattern.npos) return pattern == name;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t at = star; at <= name.size(); ++at)
    if (matches(rest, name.substr(at))) return true;
  return false;
}

/// Which channels are kept: named by a pattern if there are some, of the role, of the direction.
std::vector<Eigen::Index> chosen_channels(const data::RecordHeader& header,
                                          const RecordPart& part) {
  for (const std::string& pattern : part.channels)
    if (std::ranges::none_of(header.channels,
                             [&](const auto& channel) { return matches(pattern, channel.name); }))
      refuse_channel(pattern, header);
  std::vector<Eigen::Index> kept;
  for (std::size_t c = 0; c < header.channels.size(); ++c) {
    const auto& channel = header.channels[c];
    const bool named =
        part.channels.empty() || std::ranges::any_of(part.channels, [&](const auto& pattern) {
          return matches(pattern, channel.name);
        });
    if (named && (!part.role || channel.role == *part.role) &&
        (!part.direction || channel.direction == *part.direction))
      kept.push_back(static_cast<Eigen::Index>(c));
  }
  if (kept.empty()) base::refuse("--role, --direction", "no channel matches");
  return kept;
}

/// A time on the record's clock as the number of the first sample that is not before it.
std::int64_t sample_at(const std::optional<double>& time, const data::RecordHeader& header,
                       std::int64_t otherwise) {
  if (!time) return otherwise;
  const double sample = (*time - header.start) * header.sample_rate;
  constexpr double slack = 1e-6;  // times that name a sample mean that sample
  return static_cast<std::int64_t>(std::clamp(std::ceil(sample - slack), 0.0, 9e15));
}

[[noreturn]] void refuse_range(const data::RecordHeader& header,
                               const std::optional<std::int64_t>& count) {
  const auto length =
      count ? fmt::format(" and has {:.9g} s", static_cast<double>(*count) / header.sample_rate)
            : "";
  base::refuse("--from, --to", fmt::format("no sample lies there; the record begins at {:.9g} s{}",
                                           header.start, length));
}

/// Completes the file.
WrittenRecord close_record(data::RecordWriter& writer, const data::RecordSet& record,
                           std::int64_t samples, bool complete) {
  WrittenRecord written{.file = writer.close(complete),
                        .samples = samples,
                        .complete = complete,
                        .notes = record.notes()};
  for (auto& note : writer.notes()) written.notes.push_back(std::move(note));
  return written;
}

std::vector<std::size_t> shown_channels(const data::RecordHeader& header,
                                        const std::vector<std::string>& names) {
  std::vector<std::size_t> shown;
  for (const std::string& name : names) {
    const auto found = data::find_channel(header, name);
    if (!found) refuse_channel(name, header);
    shown.push_back(*found);
  }
  if (names.empty())
    for (std::size_t c = 0; c < std::min(header.channels.size(), report::most_plotted_channels);
         ++c)
      shown.push_back(c);
  if (shown.size() > report::most_plotted_channels)
    base::refuse("--channel",
                 fmt::format("{} channels are too many for one picture (at most {}); choose some",
                             shown.size(), report::most_plotted_channels));
  return shown;
}

}  // namespace

ShownRecord show_record(const RecordOptions& options, const Progress& progress) {
  ShownRecord shown{.record = open_record(options)};
  auto builder = overview_of(shown.record, progress);
  if (!read_blocks(shown.record, progress, [&](const auto& block) { builder.add(block); }))
    throw base::ComputationError("interrupted");
  shown.overview = builder.result();
  return shown;
}

WrittenRecord convert_record(const RecordOptions& options, const RecordOutput& output,
                             const Progress& progress) {
  const auto format = format_of(output);
  auto record = open_record(options);
  const auto writer = data::open_record_writer(output.path, record.header(), format);
  std::int64_t samples = 0;
  const bool complete = read_blocks(record, progress, [&](const auto& block) {
    writer->append(block);
    samples += block.rows();
  });
  return close_record(*writer, record, samples, complete);
}

WrittenRecord cut_record(const RecordOptions& options, const RecordOutput& output,
                         const RecordPart& part, const Progress& progress) {
  const auto format = format_of(output);
  auto record = open_record(options);
  data::RecordHeader header = record.header();
  const auto kept = chosen_channels(header, part);
  const std::int64_t from = sample_at(part.from, header, 0);
  const std::int64_t to = sample_at(part.to, header, std::numeric_limits<std::int64_t>::max());
  const auto count = record.sample_count();
  if (from >= to || (count && from >= *count)) refuse_range(header, count);
  header.start += static_cast<double>(from) / header.sample_rate;
  std::vector<data::Channel> channels;
  for (const Eigen::Index c : kept)
    channels.push_back(header.channels[static_cast<std::size_t>(c)]);
  header.channels = channels;
  // made with the first sample: a table does not tell before its end that none lies there
  std::unique_ptr<data::RecordWriter> writer;
  std::int64_t at = 0, written = 0;
  const bool complete = read_blocks(record, progress, [&](const auto& block) {
    const std::int64_t first = std::clamp<std::int64_t>(from - at, 0, block.rows());
    const std::int64_t last = std::clamp<std::int64_t>(to - at, first, block.rows());
    at += block.rows();
    if (last == first) return;
    if (!writer) writer = data::open_record_writer(output.path, header, format);
    const data::Samples rows = block.middleRows(first, last - first)(Eigen::all, kept);
    writer->append(rows);
    written += rows.rows();
  });
  if (!writer && !complete) throw base::ComputationError("interrupted before the first sample");
  if (!writer) refuse_range(record.header(), at);
  auto result = close_record(*writer, record, written, complete);
  if (complete && part.to && at < to)
    result.ends_early =
        record.header().start + static_cast<double>(at) / record.header().sample_rate;
  return result;
}

WrittenRecord resample_record(const RecordOptions& options, const RecordOutput& output, double rate,
                              const Progress& progress) {
  const auto format = format_of(output);
  if (!(rate > 0.0 && std::isfinite(rate)))
    throw std::invalid_argument(
        fmt::format("resample_record: rate is {} Hz, expected above 0", rate));
  auto record = open_record(options);
  data::RecordHeader header = record.header();
  const double before = header.sample_rate;
  constexpr double most = 1e4;
  if (before / rate > most || rate / before > most)
    base::refuse("--new-rate",
                 fmt::format("{} Hz is more than 1:10000 from the record's {} Hz", rate, before));
  header.sample_rate = rate;
  const auto writer = data::open_record_writer(output.path, header, format);
  std::int64_t written = 0;
  data::Resampler resampler(header.channels.size(), before, rate, [&](const auto& block) {
    writer->append(block);
    written += block.rows();
  });
  const bool complete =
      read_blocks(record, progress, [&](const auto& block) { resampler.add(block); });
  resampler.finish();
  return close_record(*writer, record, written, complete);
}

VerifiedRecord verify_record(const std::string& file, const Progress& progress) {
  data::RecordSet record({file});
  VerifiedRecord found{.channels = record.header().channels.size()};
  if (!read_blocks(record, progress, [&](const auto& block) { found.samples += block.rows(); }))
    throw base::ComputationError("interrupted");
  found.checksum = record.checksum();
  found.notes = record.notes();
  return found;
}

PlottedRecord plot_record(const RecordOptions& options, const std::string& picture,
                          const std::vector<std::string>& channels, const Progress& progress) {
  report::require_picture_ending(picture);
  auto record = open_record(options);
  const auto shown = shown_channels(record.header(), channels);
  auto overview = overview_of(record, progress);
  report::TraceBuilder traces(record.header().channels.size());
  const bool complete = read_blocks(record, progress, [&](const auto& block) {
    overview.add(block);
    traces.add(block);
  });
  if (!complete) throw base::ComputationError("interrupted");
  if (traces.stretches().empty()) throw base::ComputationError("the record has no samples to plot");
  data::RecordHeader header = record.header();
  if (header.title.empty()) header.title = record.files().front();
  report::plot_record(header, traces, overview.result(), shown,
                      fmt::format("{}; {:.6g} samples a second", fmt::join(record.files(), ", "),
                                  header.sample_rate),
                      picture);
  return {.shown = shown.size(), .channels = header.channels.size(), .notes = record.notes()};
}

}  // namespace hydrapod::tasks
