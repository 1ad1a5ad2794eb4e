#pragma once
/// What the subcommands of `record` share.

#include <functional>
#include <optional>
#include <string>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/options.hpp"
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
data::ReadOptions read_options(const RecordArguments& arguments);

/// Throws base::InputError; for a wrong --rate too.
data::RecordSet open_record(const RecordArguments& arguments);

/// For a --channel `name` that the record does not have. Throws base::InputError.
[[noreturn]] void refuse_channel(const std::string& name, const data::RecordHeader& header);

/// Reads to the end in blocks, with a progress line titled `title` where the length is known. Notes
/// go to stderr at the end. False when Ctrl-C ended it before.
bool read_all(data::RecordSet& record, const std::string& title,
              const std::function<void(const Eigen::Ref<const data::Samples>&)>& use);
/// The same under a note of the caller, who has more to do than to read: completing a file may take
/// longer than reading, and Ctrl-C is answered as long as the note is there.
bool read_all(const InterruptNote& interrupt, data::RecordSet& record, const std::string& title,
              const std::function<void(const Eigen::Ref<const data::Samples>&)>& use);

/// Samples of a record; a table is read to its end for that. Spectra depend on the number, and are
/// not to depend on the format. Throws base::ComputationError where Ctrl-C came before the end.
std::int64_t count_samples(data::RecordSet& record);

/// "1 sample", "20 samples".
std::string samples_text(std::int64_t count);

/// Says what was written, or throws base::ComputationError where Ctrl-C came before the end.
void report_written(const std::string& file, std::int64_t samples, bool complete);

void add_record_show(Command record);
void add_record_convert(Command record);
void add_record_cut(Command record);
void add_record_resample(Command record);
void add_record_plot(Command record);
void add_record_verify(Command record);
void add_record_recover(Command record);

}  // namespace hydrapod::cli
