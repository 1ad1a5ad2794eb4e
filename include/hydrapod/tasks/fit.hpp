#pragma once
/// Tasks that explain measurements: parameters fitted to modes, and the part that is guilty. And
/// the page with all of it: one HTML file with modes, Bode diagrams and what was simulated,
/// measured, diagnosed.
///
///     const auto found = tasks::diagnose(machine, {.measured = {.files = {"run.h5"}}});
///     for (const auto& sentence : report::summary(found.file)) std::printf("%s\n",
///     sentence.c_str());

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::tasks {

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
