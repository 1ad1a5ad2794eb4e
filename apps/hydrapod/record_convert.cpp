/// record convert, cut and resample: a record in, a record out.

#include "hydrapod/command.hpp"
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
  report_written(with_record("converting", [&](const auto& progress) {
    return tasks::convert_record(record_of(arguments.record), output_of(arguments.output),
                                 progress);
  }));
}

std::optional<double> time_of(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  return plain_or_quantity(option + " " + text, text, "s");
}

tasks::RecordPart part_of(const Arguments& arguments) {
  tasks::RecordPart part{.from = time_of("--from", arguments.from),
                         .to = time_of("--to", arguments.to),
                         .channels = arguments.channels};
  if (!arguments.role.empty())
    part.role = static_cast<data::Role>(
        choose_word("--role", arguments.role, {"excitation", "drive", "response", "other"}));
  if (arguments.direction.empty()) return part;
  part.direction = data::direction_from_text(arguments.direction);
  if (!part.direction)
    base::refuse("--direction " + arguments.direction,
                 "unknown direction; accepted are x, y, z, rx, ry, rz, these with a -, and "
                 "\"leg 1\" to \"leg 6\"");
  return part;
}

void cut(const Arguments& arguments) {
  const auto output = output_of(arguments.output);
  const auto part = part_of(arguments);
  const auto written = with_record("cutting", [&](const auto& progress) {
    return tasks::cut_record(record_of(arguments.record), output, part, progress);
  });
  if (written.ends_early)
    print_note(fmt::format("the record ends at {:.9g} s, before --to {}", *written.ends_early,
                           arguments.to));
  report_written(written);
}

void resample(const Arguments& arguments) {
  const auto output = output_of(arguments.output);
  const auto rate = sample_rate("--new-rate", arguments.rate);
  if (!rate)
    base::refuse("--new-rate",
                 "the new sample rate in Hz is missing (--rate is that of a file that does not "
                 "state it)");
  report_written(with_record("resampling", [&](const auto& progress) {
    return tasks::resample_record(record_of(arguments.record), output, *rate, progress);
  }));
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
