#pragma once
/// Tasks on measurements: frequency responses, modes, and whatever a file holds as targets. Tasks
/// that explain them: parameters fitted to modes, and the part that is guilty. And the page with
/// all of it: one HTML file with modes, Bode diagrams and what was simulated, measured, diagnosed.
///
///     const auto found = tasks::identify({.measure = {.files = {"run.h5"}}});
///     for (const auto& mode : found.modes.modes) std::printf("%.3f Hz\n", mode.fit.omega() /
///     two_pi);
///     const auto cause = tasks::diagnose(machine, {.measured = {.files = {"run.h5"}}});
///     for (const auto& sentence : report::summary(cause.file))
///       std::printf("%s\n", sentence.c_str());
///
/// What one task writes every task that can use it reads. A file is recognised by what it holds:
/// modes (TOML, CSV, JSON of identify or modes), responses (JSON of frf, Universal File), records.

#include <memory>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/responses.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::tasks {

/// Records, or one file of responses, and how responses are estimated from records.
struct MeasureOptions {
  std::vector<std::string> files{};  ///< records are averaged together
  /// Records in memory in place of files; `files` are then their names, for messages.
  std::vector<std::shared_ptr<const data::Record>> records{};
  std::optional<double> sample_rate{};  ///< [Hz] for files that do not tell it
  /// `platform` and `outputs_to_platform` follow from the machine.
  identification::MeasureOptions estimate{};
  /// Outputs are accelerometers, brought to accelerations of the platform in six directions.
  bool accelerometers{};
  std::vector<data::PlacedSensor> sensors{};  ///< where they sit; empty: as the record says
  /// [s] after which the window that an analyser applied to what follows a hit is e^−1; none: as
  /// the record says. Responses are then those at 1/window + iω.
  std::optional<double> exponential_window{};
  /// The machine that was measured: turns leg lengths into directions of the platform, and modes
  /// are compared with its modes. Path of a machine file; empty: the one in the record, if any.
  /// The excitation was not measured: half spectra of the outputs stand for responses.
  bool output_only{};
  std::string machine{};
  std::string pose{};                          ///< see pose_of; empty: as the record says
  std::optional<dynamics::ModelKind> model{};  ///< none: as the record says
  std::optional<Machine> known{};              ///< the machine, where it is read already
  std::optional<spatial::Vector3> p_PQ{};  ///< point whose motion is meant [m]; none: mass centre
};

/// Frequency responses and where they come from.
struct Measured {
  identification::Measurement measurement{};   ///< of responses that were read, only `responses`
  std::optional<data::RecordSet> records{};    ///< none: responses were read
  std::optional<data::RecordHeader> header{};  ///< where it is known: of the first record
  bool from_accelerometers{};                  ///< outputs were brought to the platform
  std::optional<Machine> machine{};
  std::vector<base::Diagnostic> warnings{};

  [[nodiscard]] const identification::FrequencyResponses& responses() const {
    return measurement.responses;
  }
  [[nodiscard]] const data::Experiment* experiment() const {
    return header ? &header->experiment : nullptr;
  }
};

/// Frequency responses of records, averaged together, or half spectra. Reads records, JSON of frf
/// and Universal Files. `progress` that asks to stop ends the reading of records; the result is of
/// what was read. Throws base::InputError and base::ComputationError.
Measured frf(const MeasureOptions& options, const Progress& progress = {});

/// The responses with those at iω, for files: those of a closed loop and of hits are estimated at
/// a + iω, and brought there by their modal model (`on_axis`, identification::on_imaginary_axis).
/// Where no mode is found, they are the plain instrumental estimate, and of hits the plain ratio.
identification::FrequencyResponses shared_responses(const Measured& measured,
                                                    const Progress& progress = {});

/// The system that the inputs see: in a record of a test rig the plant from the drives on, else the
/// machine under its controller. None: not known.
std::optional<observation::Observed> observed_in(const Measured& measured);

/// Frequency responses in a few numbers.
struct ResponseSummary {
  struct Output {
    double median_coherence{}, lowest_coherence{};  ///< multiple, over the lines; 0: not known
    /// The largest response, per level of its input where that is known, so that inputs of
    /// different units compare.
    std::size_t line{}, input{};
    double magnitude{}, deviation{};  ///< of that response [output / input]
  };
  std::vector<Output> outputs{};
  double median_condition{}, largest_condition{};  ///< of the input matrix; 0: not known
};

ResponseSummary summary_of(const identification::FrequencyResponses& responses);

struct IdentifyOptions {
  MeasureOptions measure{};
  identification::IdentifyOptions modes{};
  int bootstrap{};  ///< draws to check the intervals with; 0: none
  bool cross_check{};
  bool compare{true};  ///< with the modes of the machine, where one is known
  std::optional<observation::Observed> against{};  ///< system to compare with; none: observed_in()
};

struct Identified {
  Measured measured{};
  identification::Identification modes{};
  std::vector<std::optional<identification::CrossCheck>> cross_checks{};  ///< per mode, or empty
  std::optional<identification::BootstrapScatter> bootstrap{};
  std::optional<report::ComparedModes> compared{};
  std::vector<base::Diagnostic> warnings{};  ///< those of `measured` too
};

/// Modes of records or responses, with their uncertainty, compared with the machine where it is
/// known. Throws as frf(). What cannot be had besides the modes is a warning.
Identified identify(const IdentifyOptions& options, const Progress& progress = {});

struct MeasuredOptions {
  /// Each may say its pose, "run.h5@low", by its name in the machine file; else it was taken at the
  /// machine's pose. Lists of modes say it themselves.
  std::vector<std::string> files{};
  std::optional<observation::Observed> observed{};  ///< system that was measured; none: found out
  /// Was the machine's pose asked for? Else a record counts at the pose that it states.
  bool pose_given{true};
};

struct MeasuredTargets {
  observation::Targets targets{};
  /// Per file "run.h5: pose high, as the record states; mechanics, hydraulics and valves, …".
  std::vector<std::string> origins{};
  std::vector<base::Diagnostic> warnings{};
};

/// Modes as a person or a spreadsheet lists them, which calibration/calibrate.hpp reads?
bool is_mode_list(const std::string& path);

/// The pose that a record, or JSON made of one, states; none: it states none. It is one of
/// `machine` by its name where both have the same numbers, or by its numbers; else of the record's
/// own name.
std::optional<model::NamedPose> stated_pose(const std::string& path, const model::Machine& machine);

/// Modes, and responses beside them, of any files as targets for `machine`, whose pose must be one
/// of its file's. Throws base::InputError and base::ComputationError.
MeasuredTargets read_measured(const Machine& machine, const MeasuredOptions& options,
                              const Progress& progress = {});

/// A record of a test rig as a file. What is left of a damaged one: data::recover_record().
struct RecordOptions {
  std::string file{};
  std::optional<double> sample_rate{};  ///< [Hz] for files that do not tell it
};

struct RecordOutput {
  std::string path{};
  std::optional<data::RecordFormat> format{};  ///< none: by the ending of `path`
};

struct ShownRecord {
  data::RecordSet record;  ///< read to its end
  data::RecordOverview overview{};
};

/// Channels of a record with levels, clipping, drop-outs and spectra. Throws base::InputError for a
/// file that is no record, base::ComputationError where `progress` stops it.
ShownRecord show_record(const RecordOptions& options, const Progress& progress = {});

struct WrittenRecord {
  std::string file{};      ///< where it is, see data::RecordWriter::close
  std::int64_t samples{};  ///< in it
  bool complete{true};     ///< false: `progress` stopped it, and the file has the first samples
  std::optional<double> ends_early{};     ///< [s] end of the record, before RecordPart::to
  std::vector<base::Diagnostic> notes{};  ///< of reading and of writing
};

/// Writes a record in another format. Throws base::InputError for a file that is no record and for
/// an ending that is none, base::ComputationError where the disk is full.
WrittenRecord convert_record(const RecordOptions& options, const RecordOutput& output,
                             const Progress& progress = {});

/// What is kept.
struct RecordPart {
  std::optional<double> from{}, to{};   ///< [s] on the record's clock; none: start, end
  std::vector<std::string> channels{};  ///< names, `*` for any text; empty: all
  std::optional<data::Role> role{};
  std::optional<data::Direction> direction{};
};

/// Writes a part of a record: a time range, some channels. Throws as convert_record(), and
/// base::InputError where no channel matches and where no sample lies in the range.
WrittenRecord cut_record(const RecordOptions& options, const RecordOutput& output,
                         const RecordPart& part, const Progress& progress = {});

/// Writes a record with another sample rate [Hz], through a linear-phase anti-alias filter.
/// See data::Resampler. Throws as convert_record(), and base::InputError for a rate more than
/// 1:10000 from that of the record.
WrittenRecord resample_record(const RecordOptions& options, const RecordOutput& output, double rate,
                              const Progress& progress = {});

struct VerifiedRecord {
  std::int64_t samples{};
  std::size_t channels{};
  data::ChecksumFinding checksum{};
  std::vector<base::Diagnostic> notes{};
};

/// Compares the checksum of a record with its channels and samples. Throws base::InputError for a
/// file that cannot be read, base::ComputationError where `progress` stops it.
VerifiedRecord verify_record(const std::string& file, const Progress& progress = {});

struct PlottedRecord {
  std::size_t shown{}, channels{};  ///< numbers of channels: in the picture, in the record
  std::vector<base::Diagnostic> notes{};
};

/// Draws time histories and spectra of a record as a picture, .svg, .png or .pdf. `channels`:
/// names; none: the first report::most_plotted_channels. Throws base::InputError for names that the
/// record does not have, base::ComputationError without gnuplot or samples.
PlottedRecord plot_record(const RecordOptions& options, const std::string& picture,
                          const std::vector<std::string>& channels = {},
                          const Progress& progress = {});

/// Machines, records, responses and lists of identified modes, set beside the first of them.
struct CompareOptions {
  /// Machine files (TOML), each perhaps with a pose, "machine.toml@low"; JSON of `hydrapod modes`;
  /// identified modes (JSON, CSV, Universal File with datasets 55); records; responses.
  std::vector<std::string> files{};
  std::vector<std::string> overrides{};  ///< for every machine file; of one that stands alone: of a
                                         ///< second version of it, beside the first
  std::vector<std::string> poses{};      ///< one: of machine files that say none; of a machine file
                                         ///< that stands alone: several, which are compared
  std::optional<dynamics::ModelKind> model{};
  /// The system whose modes are calculated; none: that which was measured, else mechanics.
  std::optional<observation::Observed> observed{};
  double level{0.05};  ///< of the tests
  int points{600};     ///< of calculated responses
};

struct Compared {
  report::SideBySide result{};
  std::vector<base::Diagnostic> warnings{};
};

/// Machines, poses, records and identified modes side by side, the first with each other one.
/// Throws base::InputError for fewer than two things, for the same thing twice and for files
/// without modes.
Compared compare(const CompareOptions& options, const Progress& progress = {});

/// What is known of a free parameter besides the data.
struct KnownParameter {
  std::string path{};
  calibration::PriorAmounts prior{};
};

struct CalibrateOptions {
  /// File of targets: TOML or CSV (calibration/calibrate.hpp), or whatever read_measured()
  /// reads.
  std::string targets{};
  calibration::Plan plan{};              ///< added to that of the file; its options hold
  std::vector<KnownParameter> priors{};  ///< of free parameters of the file or of `plan`
  std::optional<int> starts{};           ///< instead of the file's, as the next two
  std::optional<std::uint64_t> seed{};
  std::optional<calibration::Loss> loss{};
  std::vector<std::string> profiles{};  ///< paths of free parameters to be held and profiled
};

struct Calibrated {
  observation::Targets targets{};
  calibration::Plan plan{};  ///< as used
  calibration::Calibration result{};
  std::vector<calibration::Profile> profiles{};
  bool interrupted{};
  std::vector<base::Diagnostic> warnings{};
};

/// Fits numbers of the machine file to measured modes. Throws base::InputError for a targets file
/// or paths that cannot be, base::ComputationError when no combination has modes.
Calibrated calibrate(const Machine& machine, const CalibrateOptions& options,
                     const Progress& progress = {});

struct DiagnoseOptions {
  MeasuredOptions measured{};  ///< without files: the machine file alone
  diagnosis::DiagnoseOptions rules{};
  diagnosis::RemedyGoal goal{.drop = 0.02};  ///< of the guide sleeves
  /// Where the goal is to be met, and where could be measured; empty: all poses of the file.
  std::vector<model::NamedPose> poses{};
};

/// "2 %", "drop 2 %", "5.2 Hz", "x=5.2 Hz", "x=3 %"; and as requirements of studies are written,
/// "x >= 5.2 Hz", "lowest >= 5.2 Hz", "drop <= 2 %". A number without a unit is a frequency [Hz].
/// `argument` is what messages call the text. Throws base::InputError.
diagnosis::RemedyGoal read_goal(std::string_view text, const std::string& argument);

struct Diagnosed {
  Machine machine{};  ///< as given, its pose among those of its file
  diagnosis::CaseFile file{};
  observation::Targets measured{};     ///< as the files have it, with all lines of responses
  std::vector<std::string> origins{};  ///< see MeasuredTargets
  std::vector<base::Diagnostic> warnings{};
};

/// Cause of low frequencies, its uncertainty, and the stiffness that is required. Diagnosis of the
/// measurement, then attribution and remedy of the machine that explains it best. Throws
/// base::InputError for a measurement without modes and for goals that cannot be.
Diagnosed diagnose(const Machine& machine, const DiagnoseOptions& options = {},
                   const Progress& progress = {});

/// The measured mode that comes most from what gives way beside the oil, as number of the
/// explaining machine's mode, from 1; 0 where there is none at that pose.
int identified_mode(const diagnosis::Diagnosis& found, const std::string& pose);

struct ReportOptions {
  std::vector<model::NamedPose> poses{};            ///< empty: the machine's pose
  report::HtmlOptions page{};                       ///< `kind` is not used
  std::optional<SimulateOptions> simulation{};      ///< at the first pose
  std::optional<IdentifyOptions> identification{};  ///< beside the modes at the first pose
  /// The page then shows the machine that explains the measurement best, its guilty mode first.
  std::optional<DiagnoseOptions> diagnosis{};
  std::string comparison{};  ///< JSON of compare() to be shown too; empty: none
};

struct Report {
  report::Json document{};
  std::vector<base::Diagnostic> warnings{};
};

/// One HTML page with moving modes, Bode diagrams and all numbers: what report::html_page() draws.
Report report_document(const Machine& machine, const ReportOptions& options = {},
                       const Progress& progress = {});

}  // namespace hydrapod::tasks
