#include "hydrapod/command.hpp"
#include "hydrapod/record_arguments.hpp"

namespace hydrapod::cli {

void add_record_options(Command command, RecordArguments& arguments) {
  command.add_options(
      {{"FILE", arguments.file,
        "Record: HDF5, MAT (5 or 7.3), CSV, Universal File or RPC III, detected by its content",
        reads_required},
       {"--rate", arguments.rate, "Sample rate, Hz or with a unit, for files that do not state it"},
       {"--sample-rate,--file-rate", arguments.rate, "", hidden}});
}

void add_output_options(Command command, OutputArguments& arguments) {
  command.add_options(
      {{"-o", arguments.file, "File to write: .h5, .mat, .csv, .uff or .rpc",
        OptionRule{.required = true, .file = FileUse::output}},
       {"--format", arguments.format,
        "hdf5, mat5, mat73, csv, uff (binary), uff-ascii, rpc (floats) or rpc-short (16-bit "
        "integers); default: by the ending"}});
}

data::RecordFormat choose_format(const OutputArguments& arguments) {
  if (arguments.format.empty()) return data::format_of_ending(arguments.file);
  const std::vector<std::string_view> words{"hdf5", "mat5",      "mat73", "csv",
                                            "uff",  "uff-ascii", "rpc",   "rpc-short"};
  return *data::format_from_text(words[choose_word("--format", arguments.format, words)]);
}

std::optional<double> sample_rate(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  constexpr double most = 1e12;  // [Hz]
  const double rate = positive_quantity(option, text, "Hz", "a sample rate must be positive");
  if (!(rate < most))
    base::refuse(option + " " + text, fmt::format("a sample rate must be below {:g} Hz", most));
  return rate;
}

tasks::RecordOptions record_of(const RecordArguments& arguments) {
  return {.file = arguments.file, .sample_rate = sample_rate("--rate", arguments.rate)};
}

tasks::RecordOutput output_of(const OutputArguments& arguments) {
  return {.path = arguments.file, .format = choose_format(arguments)};
}

std::string samples_text(std::int64_t count) {
  return fmt::format("{} sample{}", count, count == 1 ? "" : "s");
}

void report_written(const std::string& file, std::int64_t samples, bool complete) {
  if (!complete)
    throw base::ComputationError(
        fmt::format("interrupted; {} contains the first {}", file, samples_text(samples)));
  print_note(fmt::format("wrote {}: {}", file, samples_text(samples)));
}

void report_written(const tasks::WrittenRecord& written) {
  print_diagnostics(written.notes);
  report_written(written.file, written.samples, written.complete);
}

void add_record(Command app) {
  Command command = app.add_command(
      "record", "Show, convert, cut, resample, plot, verify and recover records of a test rig",
      {{"record show run.h5", "channels, levels, clipping, drop-outs"},
       {"record convert run.h5 -o run.uff", "to another format"},
       {"record cut run.h5 --from 0.2 --to 0.7 --role response -o part.mat", "a part of it"},
       {"record resample run.h5 --new-rate 250 -o slow.h5", "another sample rate, without aliases"},
       {"record plot run.h5 -o run.svg", "time histories and spectra as a picture"},
       {"record verify run.h5", "does it hold what was written?"},
       {"record recover run.h5 -o rest.h5", "what is left of a damaged one"}});
  command.require_subcommand(1);
  add_record_show(command);
  add_record_convert(command);
  add_record_cut(command);
  add_record_resample(command);
  add_record_plot(command);
  add_record_verify(command);
  add_record_recover(command);
}

}  // namespace hydrapod::cli
