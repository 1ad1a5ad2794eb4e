#include "hydrapod/command.hpp"

#include <algorithm>

#include "hydrapod/record_arguments.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  RecordArguments record{};
  std::vector<std::string> channels{};
  std::string picture{};
};

std::vector<std::size_t> shown_channels(const data::RecordHeader& header,
                                        const std::vector<std::string>& names) {
  std::vector<std::size_t> shown;
  const std::size_t count = header.channels.size();
  for (const std::string& name : names) {
    const auto found = data::find_channel(header, name);
    if (!found) refuse_channel(name, header);
    shown.push_back(*found);
  }
  if (names.empty()) {
    for (std::size_t c = 0; c < std::min(count, report::most_plotted_channels); ++c)
      shown.push_back(c);
    if (shown.size() < count)
      print_note(fmt::format("the first {} of {} channels are shown; --channel chooses others",
                             shown.size(), count));
  }
  if (shown.size() > report::most_plotted_channels)
    base::refuse("--channel",
                 fmt::format("{} channels are too many for one picture (at most {}); choose some",
                             shown.size(), report::most_plotted_channels));
  return shown;
}

void run(const Arguments& arguments) {
  report::require_picture_ending(arguments.picture);
  auto record = open_record(arguments.record);
  const auto shown = shown_channels(record.header(), arguments.channels);
  data::OverviewBuilder overview(record.header(),
                                 data::default_segment(record.header(), count_samples(record)));
  report::TraceBuilder traces(record.header().channels.size());
  const bool complete = read_all(record, "reading", [&](const auto& block) {
    overview.add(block);
    traces.add(block);
  });
  if (!complete) throw base::ComputationError("interrupted");
  if (traces.stretches().empty()) throw base::ComputationError("the record has no samples to plot");
  data::RecordHeader header = record.header();
  if (header.title.empty()) header.title = record.files().front();
  report::plot_record(header, traces, overview.result(), shown, arguments.picture);
  print_written(arguments.picture);
}

}  // namespace

void add_record_plot(Command record) {
  Command command = record.add_command(
      "plot", "Time histories and spectra of a record as a picture (needs gnuplot)",
      {{"record plot run.h5 -o run.svg", "all channels, at most 24"},
       {"record plot run.h5 --channel \"demand x\" --channel \"demand ry\" -o two.png", "some"}});
  auto& arguments = command.calls(&run);
  add_record_options(command, arguments.record);
  command.add_options(
      {{"-o", arguments.picture, "Picture to write, .svg, .png or .pdf",
        OptionRule{.required = true, .file = FileUse::output}},
       {"--channel", arguments.channels, "Name of a channel; may be repeated", one_each}});
}

}  // namespace hydrapod::cli
