#include "hydrapod/command.hpp"
#include "hydrapod/record_arguments.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  std::vector<std::string> files{};
};

const char* words(data::ChecksumFinding finding) {
  switch (finding) {
    case data::ChecksumFinding::holds:
      return "the checksum holds";
    case data::ChecksumFinding::differs:
      return "the checksum does not hold";
    case data::ChecksumFinding::none:
      break;
  }
  return "no checksum: another program wrote the file, the format has none, or the file is not "
         "complete";
}

enum class Outcome { held, not_held, unreadable };

/// A file that cannot be read is said, and is no reason to leave out those after it.
Outcome verify(const std::string& file) {
  try {
    const auto found = with_record("verifying " + file, [&](const auto& progress) {
      return tasks::verify_record(file, progress);
    });
    print_diagnostics(found.notes);
    print_text(fmt::format("{}: {} samples of {} channels: {}\n", file, found.samples,
                           found.channels, words(found.checksum)));
    return found.checksum == data::ChecksumFinding::holds ? Outcome::held : Outcome::not_held;
  } catch (const base::InputError& error) {
    print_diagnostics(error.diagnostics());
  } catch (const base::ComputationError& error) {
    if (InterruptNote::noted()) throw;
    print_error(fmt::format("{}: {}", file, error.what()));
  }
  return Outcome::unreadable;
}

void run(const Arguments& arguments) {
  std::size_t held = 0, unreadable = 0;
  for (const auto& file : arguments.files) {
    const auto outcome = verify(file);
    held += outcome == Outcome::held ? 1 : 0;
    unreadable += outcome == Outcome::unreadable ? 1 : 0;
  }
  const auto files = arguments.files.size();
  auto summary = fmt::format("the checksum holds in {} of {} files", held, files);
  if (unreadable > 0)
    throw base::InputError(
        {{.message = fmt::format("{}; {} cannot be read", summary, unreadable)}});
  if (held < files) throw base::ComputationError(summary);
}

}  // namespace

void add_record_verify(Command record) {
  Command command = record.add_command(
      "verify", "Do records hold what was written? Compares their checksums",
      {{"record verify run.h5", "exit code 0 only where the checksum holds"},
       {"record verify *.h5", "several"}},
      "\n\nhydrapod writes a checksum into records in HDF5, MAT, CSV and binary Universal Files. "
      "It "
      "covers\nsample rate, start, channels (names, units, directions, roles) and samples.");
  auto& arguments = command.calls(&run);
  command.add_options({{"FILE", arguments.files, "Records", reads_required}});
}

}  // namespace hydrapod::cli
