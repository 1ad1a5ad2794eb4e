#include "hydrapod/command.hpp"

#include <algorithm>

#include "hydrapod/data/processing.hpp"
#include "hydrapod/record_arguments.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/reproduction.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  RecordArguments record{};
  std::string format{};
  bool spectra{};
  std::string file{"-"};
};

/// How the record was made, a line per statement.
std::string experiment_text(const data::Experiment& e) {
  std::string out;
  const auto add = [&](const char* what, const std::string& text) {
    if (!text.empty()) out += fmt::format("{}: {}\n", what, text);
  };
  add("program", e.program);
  if (!e.command.empty()) add("command", shell_text(e.command));
  add("pose", e.pose_name);
  add("model", e.model);
  for (const auto& change : e.overrides) add("--set", change);
  if (e.excitation) {
    add("excitation", e.excitation->entry);
    for (const auto& signal : e.excitation->signals) add("signal", signal);
  }
  if (e.seed) add("seed", fmt::format("{}", *e.seed));
  add("controller", e.controller);
  for (const auto& s : e.sensors)
    out += fmt::format("sensor: {} at {:.4g} {:.4g} {:.4g} m along {:.4g} {:.4g} {:.4g}\n", s.name,
                       s.position.x(), s.position.y(), s.position.z(), s.axis.x(), s.axis.y(),
                       s.axis.z());
  return out;
}

std::string heading(const data::RecordHeader& header, const data::RecordOverview& overview,
                    data::RecordFormat format, const TableStyle& style) {
  std::string out;
  if (!header.title.empty()) out += bold(header.title, style) + '\n';
  out +=
      fmt::format("{} channel{}, {} samples at {:.9g} Hz: {:.6g} s from {:.6g} s ({})\n",
                  header.channels.size(), header.channels.size() == 1 ? "" : "s", overview.samples,
                  header.sample_rate, overview.duration, header.start, data::format_text(format));
  if (!header.date.empty() || header.repeat > 1)
    out += fmt::format("recorded {}, repeat {}\n", header.date.empty() ? "?" : header.date,
                       header.repeat);
  out += experiment_text(header.experiment);
  if (!header.notes.empty()) out += header.notes + (header.notes.ends_with('\n') ? "" : "\n");
  if (!header.experiment.machine.empty()) out += "The machine file is in the record.\n";
  if (const auto& g = header.geometry; !g.empty())
    out +=
        fmt::format("geometry: {} node{}, {} line{}\n", g.nodes.size(),
                    g.nodes.size() == 1 ? "" : "s", g.lines.size(), g.lines.size() == 1 ? "" : "s");
  return out + '\n';
}

std::string count_text(std::int64_t count) { return count == 0 ? "" : fmt::format("{}", count); }

std::string hold_text(const data::ChannelOverview& c) {
  if (c.constant) return "constant";
  constexpr std::int64_t worth_showing = 10;
  return c.longest_hold < worth_showing ? "" : fmt::format("{}", c.longest_hold);
}

/// "WING 12": part and node.
std::string place_text(const data::Channel& channel) {
  const std::string node = channel.point == 0 ? "" : fmt::format("{}", channel.point);
  const char* between = channel.entity.empty() || node.empty() ? "" : " ";
  return channel.entity + between + node;
}

/// What Universal Files of other programs say of the channels.
std::string id_text(const std::vector<data::Channel>& channels) {
  std::string text;
  for (const data::Channel& channel : channels)
    if (!channel.id_lines.empty())
      text += fmt::format("{}: {}\n", channel.name, fmt::join(channel.id_lines, " | "));
  return text.empty() ? "" : "\nLines of text:\n" + text;
}

std::string table(const data::RecordHeader& header, const data::RecordOverview& overview,
                  const TableStyle& style) {
  const bool placed =
      !header.geometry.empty() || std::ranges::any_of(header.channels, [](const data::Channel& c) {
        return !c.entity.empty() || !c.id_lines.empty();
      });
  std::vector<Column> columns{"<channel", "<unit",        "<direction", "<role", "mean",   "RMS",
                              "peak",     "strongest Hz", "at limit",   "held",  "missing"};
  if (placed) columns.emplace_back("<node");
  Table table(columns);
  for (std::size_t i = 0; i < header.channels.size(); ++i) {
    const data::Channel& channel = header.channels[i];
    const data::ChannelOverview& c = overview.channels[i];
    const bool strongest = c.strongest_frequency > 0.0;
    std::vector<std::string> row{channel.name,
                                 channel.unit,
                                 std::string(data::direction_text(channel.direction)),
                                 std::string(data::role_text(channel.role)),
                                 fmt::format("{:.5g}", c.mean),
                                 fmt::format("{:.5g}", c.rms),
                                 fmt::format("{:.5g}", c.peak),
                                 strongest ? fmt::format("{:.4g}", c.strongest_frequency) : "",
                                 count_text(c.at_limit),
                                 hold_text(c),
                                 count_text(c.missing + c.infinite)};
    if (placed) row.push_back(place_text(channel));
    table.add_row(row);
  }
  return table.text(style);
}

constexpr const char* legend =
    "\nRMS and peak are about the mean. At limit: samples in runs of three or more at the lowest "
    "or\n"
    "highest value. Held: longest run of one value, from 10 samples on. Missing: no number.\n";

void run(const Arguments& arguments) {
  const std::size_t format = result_format(arguments.format, arguments.file, {"table", "json"});
  const auto shown = with_record("reading", [&](const auto& progress) {
    return tasks::show_record(record_of(arguments.record), progress);
  });
  const auto& [record, overview] = shown;
  const data::RecordHeader& header = record.header();
  print_diagnostics(record.notes());
  if (format == 1)
    return write_output(
        arguments.file,
        json_text({}, report::record_json(record, overview, arguments.spectra), -1));
  const auto style = table_style(arguments.file);
  write_result(arguments.file, format,
               heading(header, overview, *record.format(), style) + table(header, overview, style) +
                   legend + id_text(header.channels));
}

}  // namespace

void add_record_show(Command record) {
  Command command = record.add_command(
      "show", "Channels of a record with levels, clipping and drop-outs",
      {{"record show run.h5", "a table"},
       {"record show run.csv --format json", "the same for programs"},
       {"record show run.h5 --format json --spectra -o run.json", "with spectra"}});
  auto& arguments = command.calls(&run);
  add_record_options(command, arguments.record);
  command.add_options(
      {{"--format", arguments.format, "table or json; default: by the ending of -o, else table"},
       {"--spectra", arguments.spectra, "Power spectral densities in the JSON"},
       {"-o", arguments.file, "File to write; - prints", writes}});
}

}  // namespace hydrapod::cli
