#pragma once
/// A record's overview as JSON; the fields are listed in docs/howto/json.md.
///
/// Pictures of records: each channel over time beside its power spectral density.
///
/// Measured modes beside a model's, for people and programs.
///
/// Frequency responses and identified modes as files of other programs.
///
/// Frequency responses and identified modes as JSON; the fields are documented in
/// docs/howto/json.md.
///
/// Pictures of frequency responses and of identified modes, drawn by gnuplot; formats and errors as
/// for plot_bode (bode.hpp).
///
/// Identified modes as the page of `hydrapod report` shows them: with what it takes to switch poles
/// on and off there and to fit the responses anew.
///
/// A calibration and sensitivities as JSON, as pictures and in words.
///
/// A diagnosis as JSON and as a picture. The fields are documented in docs/howto/json.md.
///
/// Machines, records and lists of modes side by side.

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/data/processing.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

/// data::experiment_json as an object.
Json experiment_object(const data::Experiment& experiment);

/// What `hydrapod record show FILE --format json` prints. `record` must have been read to its end.
Json record_json(const data::RecordSet& record, const data::RecordOverview& overview,
                 bool with_spectra);

/// Lowest and highest sample of each of up to some hundred stretches of equal length, for a
/// record of any length: stretches grow as samples come.
class TraceBuilder {
 public:
  explicit TraceBuilder(std::size_t channels);
  void add(const Eigen::Ref<const data::Samples>& samples);

  struct Stretch {
    std::vector<double> low{}, high{};  ///< per channel; NaN where all samples are missing
  };
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] std::int64_t samples_per_stretch() const { return length_; }

 private:
  void halve();

  std::size_t channels_;
  std::int64_t length_{1};
  std::int64_t in_last_{};
  std::vector<Stretch> stretches_{};
};

/// Most channels of one picture.
inline constexpr std::size_t most_plotted_channels = 24;

/// Draws the channels `shown` (at most most_plotted_channels) to `path`, .svg, .png or .pdf. Throws
/// base::InputError, base::ComputationError as plot_bode does.
void plot_record(const data::RecordHeader& header, const TraceBuilder& traces,
                 const data::RecordOverview& overview, const std::vector<std::size_t>& shown,
                 const std::string& subtitle, const std::string& path);

/// What was compared with what.
struct ComparedModes {
  observation::ModeComparison result{};
  std::vector<std::string> labels{};  ///< of the model's modes
  observation::Observed source{};
  dynamics::ModelKind kind{};
  std::string machine{}, pose{};  ///< names
};

/// Identified modes beside those of the machine. Throws as observation::observe. The names of
/// machine and pose are the caller's to fill in.
ComparedModes compared_with(const identification::Identification& measured,
                            const observation::ComparisonFrame& frame, dynamics::ModelKind kind,
                            observation::Observed source, double highest_damping = 0.3);

/// "not found", "the platform does not feel it", "the outputs do not see it".
std::string_view words(observation::Unpaired reason);

/// "left the band in the fit", "is not above the noise", …
const char* words(identification::Objection reason);

/// "new", "frequency", "damping", "vector".
const char* words(identification::PoleStability stability);

/// Shapes of modes are then shown as they are.
bool have_one_unit(const std::vector<data::Channel>& outputs);

/// Per mode "x 1.00, −ry 0.26": the outputs that move most, signs against the first. Outputs that
/// have no unit in common are each in proportion to the size of their own responses.
std::vector<std::string> motion_words(const identification::Identification& result);

std::string warning_text(const data::ResponseWarning& warning);
std::string warning_text(const identification::ModeWarning& warning);

/// "Heavy motion platform, pose neutral, guide model: mechanics, hydraulics, …".
std::string comparison_heading(const ComparedModes& compared);

/// `machine`, `pose`, `model`, `source`, `pairs[]`, `not_in_model[]`, `not_measured[]`,
/// `outputs[]`, `cross_mac`.
Json comparison_json(const ComparedModes& compared, const identification::Identification& measured);

/// MAC of measured and model modes that were paired or left in the band. Throws as plot_bode; and
/// base::InputError where no shapes could be compared.
void plot_cross_mac(const ComparedModes& compared, const identification::Identification& measured,
                    const PlotText& text, const std::string& path);

/// Modes as Universal File, dataset 55 (data/modal_results.hpp).
void write_modes_uff(const std::string& path, const identification::Identification& result,
                     const std::string& title, const std::string& date);

/// MAT file of version 5 with the responses (data::response_arrays) and modes: a row each in
/// `pole`, `mode_frequency_hz`, `damping_ratio`, their `…_95`, `mpc`, `mpd_rad`, `quality`, a
/// column each in `shape`, `displacement_shape` and `participation`; `mac`, and the model's
/// response at the lines, `fitted`.
void write_modes_mat(const std::string& path, const identification::Identification& result);

/// `inputs[]`, `outputs[]`, `frequency_hz[]`, `response[output][input]` with `re[]`, `im[]` and
/// `deviation[]`, coherences, condition, and all that responses_from_json needs to give the same
/// responses again.
Json responses_json(const identification::FrequencyResponses& responses);

/// Responses out of such JSON. Throws base::InputError naming the field that is missing or does not
/// fit; `file` is what messages call it.
identification::FrequencyResponses responses_from_json(const Json& json, const std::string& file);

/// Where responses come from: `title`, `date`, `notes`, `machine_file` of the record; and back, if
/// `json` has it as `record`.
Json record_origin_json(const data::RecordHeader& header);
std::optional<data::RecordHeader> record_origin_from_json(const Json& json,
                                                          const std::string& file);

/// `modes[]`, `heavily_damped[]`, `harmonics[]`, `rejected[]`, `mac`, `band_hz`, `stabilisation[]`,
/// `clusters[]`, `indicator`, `fit_error`, `misfit`, `warnings[]`, `findings[]`.
Json identification_json(const identification::Identification& result);
/// Reads it: modes, heavily damped poles, inputs, outputs and lines of the responses. The chart,
/// the clusters and the model stay empty.
identification::Identification identification_from_json(const Json& json, const std::string& file);

/// Adds `cross_check` to each of `modes[]` of identification_json(): null where there is none.
void add_cross_checks(const std::vector<std::optional<identification::CrossCheck>>& cross_checks,
                      Json& json);

/// Adds `bootstrap` to each of `modes[]`, and `bootstrap_resamples`.
void add_bootstrap(const identification::BootstrapScatter& scatter, Json& json);

/// One line per mode. `observed`: the system that was measured, where it is known.
/// `experiment`: of the record, whose pose is noted; null: unknown.
std::string identified_modes_csv(const identification::Identification& result,
                                 std::optional<observation::Observed> observed = {},
                                 const data::Experiment* experiment = nullptr);

/// What such a table holds.
struct ListedModes {
  data::ModalResults modes{};  ///< and outputs; deviations of shapes are zero
  std::optional<observation::MotionAgainst> against{};
  std::optional<observation::Observed> observed{};
  data::Experiment experiment{};  ///< its pose
};
/// By its title row.
bool is_identified_modes_csv(const std::string& path);
/// Throws base::InputError with file:line:column.
ListedModes identified_modes_from_csv(const std::string& path);

/// "m/N", "rad/(1/m)"; the unit of the output where the input has none.
std::string response_unit(const std::string& output, const std::string& input);

/// Magnitude and phase of the direct responses (output k from input k; all inputs where their
/// numbers differ), with their 95 % band and, if `model` is given, its synthesis.
void plot_responses(const identification::FrequencyResponses& responses,
                    const identification::ModalModel* model, const PlotText& text,
                    const std::string& path);

/// Multiple coherence of every output, and the condition of the input matrix.
void plot_coherence(const identification::FrequencyResponses& responses, const PlotText& text,
                    const std::string& path);

/// Poles over frequency and model order, those of modes marked, in front of the mode indicator.
void plot_stabilisation(const identification::Identification& result, const PlotText& text,
                        const std::string& path);

/// MAC of the modes with each other.
void plot_mac(const identification::Identification& result, const PlotText& text,
              const std::string& path);

/// Throws base::InputError for an ending that is no picture: before the work is done.
void require_picture(const std::string& path);

/// "6 inputs, 6 outputs, 200 lines from 1 Hz to 20 Hz, h1 with 45.1 independent averages".
std::string measurement_text(const identification::FrequencyResponses& responses);

/// How outputs were brought to directions: "leg lengths brought to platform directions".
const char* frame_text(bool from_legs, bool from_accelerometers);

struct MeasuredText {
  std::vector<std::string> records{};
  std::string measured{};  ///< "6 inputs, 6 outputs, …"
  std::string frame{};     ///< how outputs were brought to directions
};

/// What identification_json() has, and `records[]`, `measured`, `frame`, `comparison` (or null; its
/// `pairs[]` with `motion` of the model's modes), `outputs[].time_derivatives`, `responses`:
/// `frequency_hz[]`, `response[output][input]` with `re[]`, `im[]`, `deviation[]`, at most 1000
/// lines, `multiple_coherence[]`, `input_correlation[]` of pairs of inputs or null; `taper`: ρ − 1
/// at even steps, null where resonances are not widened; poles of `stabilisation[]` with `pole`,
/// `participation`. Numbers to seven digits.
Json identification_section(const identification::Identification& result,
                            const std::optional<ComparedModes>& compared, const MeasuredText& text);

/// `candidates[]`, best first: choices, misfit, parameters, targets, identifiability.
Json calibration_json(const calibration::Calibration& result, const observation::Targets& targets);
struct ReadCalibration {
  calibration::Calibration result{};
  observation::Targets targets{};  ///< names, poses, frequencies and damping of modes
};
ReadCalibration calibration_from_json(const Json& json, const std::string& file);

/// `profiles[]` of parameters of the best candidate.
Json profile_json(const calibration::Profile& profile, const calibration::Candidate& candidate);

/// `modes[]`, `parameters[]`, `percent_per_percent` by mode, then by parameter.
Json sensitivity_json(const calibration::Sensitivities& sensitivities);
/// Reads it; `point` stays empty.
calibration::Sensitivities sensitivity_from_json(const Json& json, const std::string& file);

/// "determined", "not determined", "at its bound", "by the prior".
const char* verdict_word(calibration::Verdict verdict);

/// What a reader must know and numbers do not say: "The targets cannot be met: …", one per line.
std::vector<std::string> calibration_remarks(const calibration::Calibration& result,
                                             const observation::Targets& targets);

/// Target against model per mode, above the misfit of every combination; throws as report's other
/// pictures do.
void plot_calibration(const calibration::Calibration& result, const observation::Targets& targets,
                      const PlotText& text, const std::string& path);

/// Heat map: modes downwards, parameters across, colour and number in per cent per per cent.
void plot_sensitivities(const calibration::Sensitivities& sensitivities, const PlotText& heading,
                        const std::string& path);

/// "0.841 ± 0.012 MN/m", "1.23 GPa" (deviation 0 or not finite), "14.2 ± 0.3 t"; as many digits as
/// the deviation leaves, else four.
std::string amount_text(double value, double deviation, const std::string& unit);

/// "0.84 MN/m to 1.23 MN/m"; one amount where both are written alike.
std::string range_text(double least, double greatest, const std::string& unit);

/// Of the guide sleeves: "300 kN/m"; "200 kN/m to 300 kN/m" where legs differ.
std::string sleeves_text(const diagnosis::RemedyPoint& point);

/// "guide sleeve of leg 3", and "the stiffness of the guide sleeve of leg 3 differs from …".
std::string cause_name(const diagnosis::Cause& cause);
std::string cause_statement(const diagnosis::Cause& cause);
/// "nominal machine", "rigid-leg model", "guide sleeves of all legs and mass centre".
std::string hypothesis_name(const diagnosis::Diagnosis& diagnosis,
                            const diagnosis::Hypothesis& hypothesis);
/// "guide sleeves of all legs", "guide sleeve of leg 3".
std::string part_name(const diagnosis::Part& part);
/// "x", "ry + x", and for none "every direction".
std::string direction_words(const std::string& direction);
/// "no cause", "nominal machine", "cause identified", ….
const char* finding_word(diagnosis::Finding finding);

/// What a hypothesis's numbers are, and were in the file: "legs.guide_sleeve.stiffness 0.841 ±
/// 0.012 MN/m (nominal 30 MN/m)", "….air.fraction 0.0815 ± 0.0010 at 68.3 bar chamber pressure".
std::vector<std::string> parameter_words(const diagnosis::Hypothesis& hypothesis);
/// "predicts one resonance in x, two were measured", worst first.
std::vector<std::string> contradiction_words(const diagnosis::Diagnosis& diagnosis,
                                             const diagnosis::Hypothesis& hypothesis);
/// Why nothing explains the measurement; empty where something does.
std::vector<std::string> reason_words(const diagnosis::Diagnosis& diagnosis);

/// The best hypothesis with as many numbers as there are values; null: there is none.
const diagnosis::Hypothesis* fits_anything(const diagnosis::Diagnosis& diagnosis);
/// What was measured and could not be used as it is, or contradicts the mode that it was paired
/// with.
std::vector<std::string> note_words(const diagnosis::Diagnosis& diagnosis);
/// "a drop of at most 2 %", "at least 5.2 Hz in x".
std::string goal_words(const diagnosis::RemedyGoal& goal);
/// Sentences, most important first. `brief`: beside a measurement without what is calculated of the
/// fitted machine.
std::vector<std::string> summary(const diagnosis::CaseFile& file, bool brief = false);

/// `summary[]`, `finding`, `hypotheses[]`, `measured_modes[]`, `discriminators[]`,
/// `attribution[]`, `remedy`.
Json diagnosis_json(const diagnosis::CaseFile& file);
/// Reads it. The machine stays empty; of targets and fits there is what the JSON holds.
diagnosis::CaseFile diagnosis_from_json(const Json& json, const std::string& file);

/// Measured beside rigid and best hypothesis, ranking, frequency against stiffness; what there is
/// of these. `state`: of the machine that was asked about. Throws as report's other pictures do.
void plot_diagnosis(const diagnosis::CaseFile& file, const std::string& state,
                    const std::string& path);

/// What `hydrapod compare` sets side by side: modes and, where they are known, responses.
struct ComparedThing {
  enum class Kind { machine, modes, record };
  struct Mode {
    double omega{}, damping_ratio{};
    /// Standard deviations; none: not known. Of a calculated mode there are none.
    std::optional<double> omega_deviation{}, damping_deviation{};
    std::string label{};  ///< "x, knee of all legs", "x 1.00, −ry 0.26"
  };
  struct Response {
    std::string name{};  ///< "x from Fx", what is compared with the same of others
    std::string unit{};
    std::vector<double> frequency{};  ///< [Hz]
    std::vector<std::complex<double>> H{};
  };
  Kind kind{};
  std::string name{};         ///< as it was given
  std::string description{};  ///< "Heavy motion platform, pose low, guide model, nominal"
  std::vector<Mode> modes{};
  std::vector<Response> responses{};
};

/// A difference and the two-sided z test of it: z = difference/deviation, p = erfc(|z|/√2).
struct TestedDifference {
  enum class Verdict {
    cannot_say,  ///< neither side, or a measured one, has no known deviation
    not_significant,
    significant,
    calculated  ///< both numbers follow exactly from their files
  };
  double value{};
  std::optional<double> deviation{};  ///< root of the sum of the known variances
  std::optional<double> p{};
  Verdict verdict{};
};
const char* name(TestedDifference::Verdict verdict);

/// One thing against the first one.
struct ThingComparison {
  struct Pair {
    int first{}, second{};         ///< modes
    std::optional<double> mac{};   ///< none where shapes cannot be compared
    TestedDifference frequency{};  ///< of ω, second less first [rad/s]
    TestedDifference damping{};    ///< of ζ
  };
  int thing{};  ///< number of the second thing
  std::vector<Pair> pairs{};
  std::vector<int> first_left{}, second_left{};  ///< modes without a partner
  std::string shapes{};  ///< what shapes were compared on: "6 outputs, metric of …", "no shapes, …"
};

struct SideBySide {
  std::vector<ComparedThing> things{};
  std::vector<ThingComparison> comparisons{};  ///< of the second thing and further ones
  double level{};                              ///< of all tests of one comparison together
};

/// "z test at 5 % …": what "significant" means here.
std::string test_text(const SideBySide& result);
/// `things[]`, `comparisons[]`, `test`, `level_percent`.
Json side_by_side_json(const SideBySide& result);
/// Reads it.
SideBySide side_by_side_from_json(const Json& json, const std::string& file);
/// One line per pair and per mode without partner.
std::string side_by_side_csv(const SideBySide& result);
/// Differences of frequencies and damping with their 95 % intervals, and responses that at least
/// two things have, one over the other. Throws as report's other pictures do.
void plot_side_by_side(const SideBySide& result, const std::string& path);

/// Per pose and entry: `pose`, `entry`, `direct`, `scaled`, `frequency_hz[]`, `hypotheses[]`
/// (indices of the predictions), `curves[]` with `direction`, `unit`, `measured[]`, `predicted[][]`
/// (empty: cannot be computed). Numbers to five digits.
Json response_overlays_json(const std::vector<diagnosis::ResponseOverlay>& overlays,
                            const std::vector<std::size_t>& hypotheses);

/// "B − A: 5 of 6 modes of A have a partner; 2 frequencies and …".
std::string verdict_text(const SideBySide& result, const ThingComparison& comparison);

/// What side_by_side_json() has, with `comparisons[].verdict`, and responses as a picture needs
/// them: up to one and a half times the highest mode, at most 1000 lines, to six digits.
Json comparison_section(const SideBySide& result);

}  // namespace hydrapod::report
