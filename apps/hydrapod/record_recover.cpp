#include "hydrapod/data/processing.hpp"

#include "hydrapod/command.hpp"
#include "hydrapod/record_arguments.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  RecordArguments record{};
  OutputArguments output{};
};

/// How much there was, and whether it is what was written.
std::string words(const std::string& file, const data::RecoverResult& result) {
  const bool all = result.declared && result.samples >= *result.declared && !result.uneven;
  const std::string read =
      result.declared && result.samples < *result.declared
          ? fmt::format("{} of {}", result.samples, samples_text(*result.declared))
      : all && result.samples > 1 ? "all " + samples_text(result.samples)
      : all                       ? "the only sample"
                                  : samples_text(result.samples);
  std::string text =
      fmt::format("{}: {} {} read", file, read, result.samples == 1 ? "was" : "were");
  if (result.uneven) text += ", not of all channels";
  if (result.unfinished)
    text += "; the record was not completed";
  else if (!result.declared)
    text += "; the file does not say how many there were";
  switch (result.checksum) {
    case data::ChecksumFinding::holds:
      return text + "; the checksum holds";
    case data::ChecksumFinding::differs:
      return text + "; the checksum does not hold: " +
             (all ? "not all is what was written" : "not all is there or what was written");
    case data::ChecksumFinding::none:
      break;
  }
  return text + (result.has_checksum
                     ? "; the checksum is one of the whole record and cannot vouch for a part"
                     : "; no checksum vouches for what was read");
}

void run(const Arguments& arguments) {
  data::RecoverOptions options{
      .format = choose_format(arguments.output),
      .read = {.sample_rate = sample_rate("--rate", arguments.record.rate)}};
  const auto result = with_record("recovering", [&](const numerics::Progress& progress) {
    options.progress = [&](double share) { return !progress(share); };
    return data::recover_record(arguments.record.file, arguments.output.file, options);
  });
  print_diagnostics(result.notes);
  print_note(words(arguments.record.file, result));
  report_written(result.file, result.samples, result.complete);
}

}  // namespace

void add_record_recover(Command record) {
  Command command = record.add_command(
      "recover", "Write what is left of a damaged record as a new one",
      {{"record recover run.h5 -o rest.h5", "of a file that was cut off"},
       {"record recover run.h5 -o rest.csv", "in any format"}},
      "\n\nSamples are taken from the first one on, up to the damage. The damaged file stays as it "
      "is. The notes\nof the new record say which file it is from. HDF5 and MAT 7.3 files that "
      "cannot be opened are searched\nfor the samples of hydrapod; of other programs' nothing is "
      "recovered.");
  auto& arguments = command.calls(&run);
  add_record_options(command, arguments.record);
  add_output_options(command, arguments.output);
}

}  // namespace hydrapod::cli
