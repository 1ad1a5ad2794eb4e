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

void run(const Arguments& arguments) {
  std::size_t held = 0;
  for (const auto& file : arguments.files) {
    data::RecordSet record({file});
    std::int64_t samples = 0;
    if (!read_all(record, "verifying " + file, [&](const auto& block) { samples += block.rows(); }))
      throw base::ComputationError("interrupted");
    fmt::print("{}: {} samples of {} channels: {}\n", file, samples,
               record.header().channels.size(), words(record.checksum()));
    held += record.checksum() == data::ChecksumFinding::holds ? 1 : 0;
  }
  if (held < arguments.files.size())
    throw base::ComputationError(
        fmt::format("the checksum holds in {} of {} files", held, arguments.files.size()));
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
