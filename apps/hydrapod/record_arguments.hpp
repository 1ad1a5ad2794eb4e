#pragma once
/// What the subcommands of `record` share.

#include <optional>
#include <string>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/options.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

struct RecordArguments {
  std::string file{};
  std::string rate{};  ///< for files that do not tell it, Hz or with a unit; empty: none
};

/// Adds FILE and --rate.
void add_record_options(Command command, RecordArguments& arguments);

struct OutputArguments {
  std::string file{};
  std::string format{};  ///< empty: by the ending
};

/// Adds -o and --format.
void add_output_options(Command command, OutputArguments& arguments);

/// The format asked for. Throws base::InputError.
data::RecordFormat choose_format(const OutputArguments& arguments);

/// A sample rate [Hz], of Hz or with a unit; none for an empty text. Throws base::InputError.
std::optional<double> sample_rate(const std::string& option, const std::string& text);

/// Throws base::InputError for a wrong --rate.
tasks::RecordOptions record_of(const RecordArguments& arguments);

/// The file asked for, with the format of --format or of its ending. Throws base::InputError.
tasks::RecordOutput output_of(const OutputArguments& arguments);

/// What `task` makes of a record, with a progress line titled `title` where the length is known.
/// Ctrl-C asks the task to stop.
template <class Task>
auto with_record(const std::string& title, const Task& task) {
  const InterruptNote interrupt;
  ProgressLine line(title);
  return task(numerics::Progress([&](double share) {
    if (share > 0.0) line.update(share);
    return InterruptNote::noted();
  }));
}

/// "1 sample", "20 samples".
std::string samples_text(std::int64_t count);

/// Says what was written, or throws base::ComputationError where Ctrl-C came before the end.
void report_written(const std::string& file, std::int64_t samples, bool complete);
void report_written(const tasks::WrittenRecord& written);

void add_record_show(Command record);
void add_record_convert(Command record);
void add_record_cut(Command record);
void add_record_resample(Command record);
void add_record_plot(Command record);
void add_record_verify(Command record);
void add_record_recover(Command record);

}  // namespace hydrapod::cli
