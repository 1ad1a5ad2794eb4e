#include "hydrapod/command.hpp"

#include "hydrapod/record_arguments.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  RecordArguments record{};
  std::vector<std::string> channels{};
  std::string picture{};
};

void run(const Arguments& arguments) {
  const auto plotted = with_record("reading", [&](const auto& progress) {
    return tasks::plot_record(record_of(arguments.record), arguments.picture, arguments.channels,
                              progress);
  });
  print_diagnostics(plotted.notes);
  if (arguments.channels.empty() && plotted.shown < plotted.channels)
    print_note(fmt::format("the first {} of {} channels are shown; --channel chooses others",
                           plotted.shown, plotted.channels));
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
