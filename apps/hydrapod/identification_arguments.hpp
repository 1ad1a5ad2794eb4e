#pragma once
/// Measurements on the command line: what frf, identify, diagnose and report have in common.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/options.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/measurement.hpp"

namespace hydrapod::cli {

/// What is measured in which records, in words.
struct MeasurementArguments {
  std::vector<std::string> files{};
  std::string inputs{}, outputs{}, instruments{};  ///< names with commas
  bool from_drive{}, from_excitation{}, whole_record{};
  bool accelerometers{};               ///< as outputs, brought to the platform
  std::vector<std::string> sensors{};  ///< "NAME, at=X Y Z, along=z" where the record says nothing
  std::string estimator{"auto"};
  std::string window{"hann"};
  std::optional<int> block{};
  std::optional<double> overlap{};
  std::string period{}, settling{}, rate{}, exponential_window{};
  std::string machine{}, pose{}, model{}, point{};
};

struct IdentificationArguments {
  MeasurementArguments measurement{};
  std::string from{}, to{};
  int order{};                   ///< 0: follows from the references
  double highest_damping{30.0};  ///< [%]
  std::string against{"auto"};
};

struct DiagnosisArguments {
  std::vector<std::string> measured{};
  std::string against{"auto"};  ///< the system that was measured
  std::string want{"2 %"};
  std::string poses{};
  diagnosis::DiagnoseOptions options{};
};

void add_measurement_options(Command command, MeasurementArguments& arguments);
/// All but the files.
void add_identification_options(Command command, IdentificationArguments& arguments);

/// "--want", "--poses" and the errors of the model.
void add_diagnosis_options(Command command, DiagnosisArguments& arguments);

/// Throw base::InputError.
tasks::MeasureOptions measure_options(const MeasurementArguments& arguments);
tasks::IdentifyOptions identify_options(const IdentificationArguments& arguments);
tasks::DiagnoseOptions diagnose_options(const DiagnosisArguments& arguments,
                                        const model::Machine& machine);

/// Heading of pictures: the machine by the title of its record, where it has one, and the files.
report::PlotText measured_plot_text(const std::vector<std::string>& files,
                                    const tasks::Measured& measured,
                                    const identification::FrequencyResponses& responses);

/// The system of --against; none for "auto" (and for `also`, another word that is accepted).
std::optional<observation::Observed> observed_system(const std::string& word,
                                                     const std::string& also = {});

}  // namespace hydrapod::cli
