/// record convert, cut and resample: a record in, a record out.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include "hydrapod/command.hpp"

#include "hydrapod/data/processing.hpp"
#include "hydrapod/record_arguments.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  RecordArguments record{};
  OutputArguments output{};
  std::string from{}, to{};
  std::vector<std::string> channels{};
  std::string role{}, direction{};
  std::string rate{};  ///< the new one, Hz or with a unit
};

void convert(const Arguments& arguments) {
  const auto format = choose_format(arguments.output);
  auto record = open_record(arguments.record);
  const auto writer = data::open_record_writer(arguments.output.file, record.header(), format);
  std::int64_t samples = 0;
  const InterruptNote interrupt;
  const bool complete = read_all(interrupt, record, "converting", [&](const auto& block) {
    writer->append(block);
    samples += block.rows();
  });
  const std::string file = writer->close(complete);
  print_diagnostics(writer->notes());
  report_written(file, samples, complete);
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
                                          const Arguments& arguments) {
  std::optional<data::Role> role;
  if (!arguments.role.empty())
    role = static_cast<data::Role>(
        choose_word("--role", arguments.role, {"excitation", "drive", "response", "other"}));
  const auto direction = data::direction_from_text(arguments.direction);
  if (!direction)
    base::refuse("--direction " + arguments.direction,
                 "unknown direction; accepted are x, y, z, rx, ry, rz, these with a -, and "
                 "\"leg 1\" to \"leg 6\"");
  for (const std::string& pattern : arguments.channels)
    if (std::ranges::none_of(header.channels,
                             [&](const auto& channel) { return matches(pattern, channel.name); }))
      refuse_channel(pattern, header);
  std::vector<Eigen::Index> kept;
  for (std::size_t c = 0; c < header.channels.size(); ++c) {
    const auto& channel = header.channels[c];
    const bool named = arguments.channels.empty() ||
                       std::ranges::any_of(arguments.channels, [&](const auto& pattern) {
                         return matches(pattern, channel.name);
                       });
    if (named && (!role || channel.role == *role) &&
        (arguments.direction.empty() || channel.direction == *direction))
      kept.push_back(static_cast<Eigen::Index>(c));
  }
  if (kept.empty()) base::refuse("--role, --direction", "no channel matches");
  return kept;
}

/// A time on the record's clock as the number of the first sample that is not before it.
std::int64_t sample_at(const std::string& option, const std::string& text,
                       const data::RecordHeader& header, std::int64_t otherwise) {
  if (text.empty()) return otherwise;
  const double time = plain_or_quantity(option + " " + text, text, "s");
  const double sample = (time - header.start) * header.sample_rate;
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

void cut(const Arguments& arguments) {
  const auto format = choose_format(arguments.output);
  auto record = open_record(arguments.record);
  data::RecordHeader header = record.header();
  const auto kept = chosen_channels(header, arguments);
  const std::int64_t from = sample_at("--from", arguments.from, header, 0);
  const std::int64_t to =
      sample_at("--to", arguments.to, header, std::numeric_limits<std::int64_t>::max());
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
  const InterruptNote interrupt;
  const bool complete = read_all(interrupt, record, "cutting", [&](const auto& block) {
    const std::int64_t first = std::clamp<std::int64_t>(from - at, 0, block.rows());
    const std::int64_t last = std::clamp<std::int64_t>(to - at, first, block.rows());
    at += block.rows();
    if (last == first) return;
    if (!writer) writer = data::open_record_writer(arguments.output.file, header, format);
    const data::Samples part = block.middleRows(first, last - first)(Eigen::all, kept);
    writer->append(part);
    written += part.rows();
  });
  if (!writer && !complete) throw base::ComputationError("interrupted before the first sample");
  if (!writer) refuse_range(record.header(), at);
  const std::string file = writer->close(complete);
  print_diagnostics(writer->notes());
  const double end = record.header().start + static_cast<double>(at) / record.header().sample_rate;
  if (complete && !arguments.to.empty() && at < to)
    print_note(fmt::format("the record ends at {:.9g} s, before --to {}", end, arguments.to));
  report_written(file, written, complete);
}

void resample(const Arguments& arguments) {
  const auto format = choose_format(arguments.output);
  const auto wanted = sample_rate("--new-rate", arguments.rate);
  if (!wanted)
    base::refuse("--new-rate",
                 "the new sample rate in Hz is missing (--rate is that of a file that does not "
                 "state it)");
  const double rate = *wanted;
  auto record = open_record(arguments.record);
  data::RecordHeader header = record.header();
  const double before = header.sample_rate;
  constexpr double most = 1e4;
  if (before / rate > most || rate / before > most)
    base::refuse("--new-rate",
                 fmt::format("{} Hz is more than 1:10000 from the record's {} Hz", rate, before));
  header.sample_rate = rate;
  const auto writer = data::open_record_writer(arguments.output.file, header, format);
  std::int64_t written = 0;
  data::Resampler resampler(header.channels.size(), before, rate, [&](const auto& block) {
    writer->append(block);
    written += block.rows();
  });
  const InterruptNote interrupt;
  const bool complete =
      read_all(interrupt, record, "resampling", [&](const auto& block) { resampler.add(block); });
  resampler.finish();
  const std::string file = writer->close(complete);
  print_diagnostics(writer->notes());
  report_written(file, written, complete);
}

}  // namespace

void add_record_convert(Command record) {
  Command command = record.add_command(
      "convert", "Write a record in another format",
      {{"record convert run.h5 -o run.mat", "for MATLAB and Octave"},
       {"record convert run.h5 -o run.unv --format uff-ascii", "a Universal File in plain text"},
       {"record convert run.csv -o again.h5", "from a table of another program"}});
  auto& arguments = command.calls(&convert);
  add_record_options(command, arguments.record);
  add_output_options(command, arguments.output);
}

void add_record_cut(Command record) {
  Command command = record.add_command(
      "cut", "Write a part of a record: a time range, some channels",
      {{"record cut run.h5 --from 0.2 --to \"700 ms\" -o part.h5", "half a second"},
       {"record cut run.h5 --channel \"demand*\" -o demand.csv", "channels by name"},
       {"record cut run.h5 --role response -o response.mat", "measured channels"}});
  auto& arguments = command.calls(&cut);
  add_record_options(command, arguments.record);
  add_output_options(command, arguments.output);
  command.add_options(
      {{"--from", arguments.from, "First time, s or with a unit; default: the start"},
       {"--to", arguments.to, "Time before which it ends; default: the end"},
       {"--channel", arguments.channels, "Name of a channel, * for any text; may be repeated",
        one_each},
       {"--role", arguments.role, "Only excitation, drive, response or other"},
       {"--direction", arguments.direction, "Only x … rz or \"leg 1\" … \"leg 6\""}});
}

void add_record_resample(Command record) {
  Command command = record.add_command(
      "resample", "Change the sample rate, with a linear-phase anti-alias filter",
      {{"record resample run.h5 --new-rate 200 -o slow.h5", "five times fewer samples"},
       {"record resample run.h5 --new-rate 44100 -o fast.h5", "any ratio"}});
  auto& arguments = command.calls(&resample);
  add_record_options(command, arguments.record);
  add_output_options(command, arguments.output);
  command.add_options(
      {{"--new-rate", arguments.rate, "New sample rate, Hz or with a unit; required"}});
}

}  // namespace hydrapod::cli
