#pragma once
/// What `hydrapod frf` and `hydrapod identify` share: options of the measurement, reading records.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/identification/measure.hpp"
#include "hydrapod/options.hpp"
#include "hydrapod/record_machine.hpp"

namespace hydrapod::cli {

struct MeasurementArguments {
  std::vector<std::string> files{};
  std::string inputs{}, outputs{}, instruments{};  ///< names with commas
  bool from_drive{}, from_excitation{};
  bool accelerometers{};               ///< as outputs, brought to the platform
  std::vector<std::string> sensors{};  ///< "NAME, at=X Y Z, along=z" where the record says nothing
  std::string estimator{"auto"};
  std::string window{"hann"};
  std::optional<int> block{};
  std::optional<double> overlap{};
  std::string period{}, settling{}, sample_rate{};
  std::string machine{}, pose{}, model{}, point{};
  // what another command knows already
  std::optional<RecordMachine> known{};    ///< the machine
  std::optional<spatial::Vector3> p_PQ{};  ///< the point
};

/// The machine that was measured, if one is known; `experiment` of the records, if there is one.
std::optional<RecordMachine> measured_machine(const MeasurementArguments& arguments,
                                              const data::Experiment* experiment);
/// The point whose directions are meant: --point, else the mass centre; in B [m].
spatial::Vector3 measured_point(const MeasurementArguments& arguments,
                                const RecordMachine& machine);

void add_measurement_options(Command command, MeasurementArguments& arguments);

/// Opens the records.
data::RecordSet open_records(const MeasurementArguments& arguments);

/// Reads the records with a progress line; Ctrl-C ends the reading and keeps what was read.
/// Warnings go to stderr. Throws base::InputError and base::ComputationError.
/// `output_only`: spectra of the responses alone.
identification::Measurement measure(data::RecordSet& records, const MeasurementArguments& arguments,
                                    bool output_only = false);

/// --format, or where it is empty what the ending of `output` says, else the first of `words`, a
/// table. Throws base::InputError for another word, and for uff and mat without a file name.
std::size_t result_format(const std::string& format, const std::string& output,
                          const std::vector<std::string_view>& words);

/// The same in pieces, for the bootstrap.
identification::GroupedSpectra measure_in_groups(data::RecordSet& records,
                                                 const MeasurementArguments& arguments, int groups);

/// "6 inputs, 6 outputs, h1, 45.1 averages, lines 0.061 Hz apart"; what was measured, for headings.
std::string measurement_text(const identification::FrequencyResponses& responses);

/// Warnings of the estimate, as diagnostics on stderr.
void print_warnings(const std::string& file, const std::vector<std::string>& warnings);

}  // namespace hydrapod::cli
