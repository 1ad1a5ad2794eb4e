#pragma once
/// Which part is the cause: every cause, alone and in pairs, fitted to the measured modes.
///
/// A hypothesis is the nominal machine with none, one or two causes let free; beside them
/// stands the rigid-leg model. Hypotheses are ranked by
///
///     BIC = misfit/s² + k ln n + 2 ln C(N, m)
///
/// misfit: rᵀ R⁻¹ r of the n differences r in deviations, of modes and responses; R: correlations
/// of frequencies (DiagnoseOptions::common_share); k: numbers fitted; m of N causes are in it
/// (Bayesian information BIC with known deviations, and a prior that gives every number of causes
/// the same odds: with many causes one of them fits noise by chance); s ≥ 1: by what the deviations
/// are too small, from the hypothesis that fits best for its number of parameters. Two that differ
/// by less than `same` cannot be told apart by the data, and no cause is identified unless it beats
/// the nominal machine by more than that. A hypothesis with as many numbers as values is not
/// identified. Theory: docs/theory/diagnosis.md. Results are codes with data, words are `report`'s.
///
/// Causes are named changes of the model, each with numbers of its own. A new one needs its Kind,
/// its maker in src/diagnosis/causes.cpp, and its words in src/report/diagnosis_words.cpp.
///
/// Shares of the compliances in each drop below the rigid-leg model. Each part is made rigid alone,
/// and the modes are computed again, gravity and preload included. Shares need not sum to one: two
/// compliances in one leg do more together than either alone; one stiff leg breaks the symmetry.
///
/// How stiff the guide sleeves must be. The sleeves of all legs are scaled by one factor. Where
/// today's do not meet the goal, the smallest factor is wanted from which on everything stiffer
/// meets it at every pose; where they do, how much softer they might be; both to 1e-6.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::diagnosis {

/// Base, gimbals and payload made rigid: its rigid model is the rigid-leg model.
model::Machine without_mount_and_gimbals(model::Machine machine);

/// Least share (MAC) of a rigid mode in a mode that is compared with it.
inline constexpr double resonance_mac = 0.1;

struct ResonanceOptions {
  /// share ≥ max(least, of_largest × the largest share): the mode is a resonance of this direction.
  /// At equal damping ratios a peak is as high as share/ω²: half of the largest share is at least
  /// half the peak of any mode above. A lower mode may have a high peak too: FirstResonance::below.
  double of_largest{0.5};
  double least{};
};

/// A mode that holds a share of a rigid mode.
struct SharedMode {
  int mode{};      ///< index of the flexible mode
  double omega{};  ///< [rad/s]
  double mac{};    ///< how much of the rigid mode is in it; modes that repeat are counted together
};

/// A rigid mode stands for the direction in which it mostly moves the platform. With soft seals
/// several modes share it. Its first resonance is the lowest of those that hold at least
/// ResonanceOptions::of_largest of what the mode holds that holds most of it.
struct FirstResonance {
  std::string direction{};  ///< "x", "ry + x"
  int main_direction{};     ///< 0…5, x … rz
  int rigid_mode{};         ///< index of the rigid mode
  double omega_rigid{};     ///< [rad/s]
  int mode{};               ///< index of the flexible mode
  double omega{};           ///< [rad/s]
  double mac{};             ///< how much of the rigid mode is in it
  /// Of the modes below that hold resonance_mac or more, the one that holds most.
  std::optional<SharedMode> below{};
  /// 1 − ω/ω_rigid; negative where the seals lie below and push the mode up.
  [[nodiscard]] double drop() const { return 1.0 - omega / omega_rigid; }
};

/// One per rigid mode, in their order; ω and MAC are 0 where the legs fold. Throws
/// base::ComputationError where the machine has no equilibrium.
std::array<FirstResonance, 6> first_resonances(const model::Machine& machine,
                                               const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                               const ResonanceOptions& options = {});

using spatial::direction_name;

/// What is compliant or wrong. Two causes of one family are tried together only for two legs.
enum class Family {
  guide_sleeves,
  piston_rings,
  leg_axes,
  platform,
  mass_center,
  base,
  oil_lines,
  leakage,
  payload_modes,
  bending,
  elastomers
};

struct Cause {
  enum class Kind {
    guide_sleeves,
    piston_rings,
    bulk_modulus,  ///< of all legs; of one leg it is oil_springs
    oil_springs,
    air,         ///< entrained, in all legs
    cap_volume,  ///< of chamber or line
    rod_volume,
    gimbals,
    sticking_seals,  ///< of the cylinders: a spring beside the oil
    payload,         ///< the platform's mass
    payload_height,  ///< with its mass
    inertia,
    mass_and_inertia,
    mass_center,
    base_lateral,
    base_vertical,
    base_rocking,
    oil_lines,
    leakage,          ///< past the pistons; of machines whose linear models have chambers
    payload_sways,    ///< a part of the payload that the file has as rigid swings along x and y
    payload_heaves,   ///< the same along z
    payload_modes,    ///< modes of the payload that the file states: their frequencies
    rods_bend,        ///< more or less than stated, where rods and cases bend
    elastomer_ratio,  ///< dynamic over static stiffness of the guide sleeves' elastomers
    elastomer_loss,   ///< their loss factor
    struts,           ///< stiffness of plain struts
    screws,           ///< stiffness of the screws of electric cylinders
    guide_clearance   ///< gap between rod and guide ring, where the file states it
  };
  Kind kind{};
  std::optional<int> leg{};  ///< 0…5; none: all legs, or no leg at all
  std::vector<calibration::FreeParameter> free{};
  std::vector<model::Assignment> changes{};  ///< what the model needs before it can have this fault

  [[nodiscard]] Family family() const;
  [[nodiscard]] bool needs_rings() const { return kind == Kind::piston_rings; }  ///< of 30 DOF
  /// Tried in pairs. Off for those that another one stands for, which changes the same springs.
  [[nodiscard]] bool in_pairs() const;
};

/// Difference of the BIC up to which hypotheses count as equally good (odds of 20 : 1).
inline constexpr double same = 6.0;

/// How near a model with the right numbers comes to a real machine: added (root of the sum of
/// squares) to what the measurement says of its own errors.
struct DiagnoseOptions {
  double frequency_error{2e-3};  ///< of ω, relative
  /// Share of its variance, below 1, that is one error of all modes and poses (a mass, an oil a
  /// little off). 0: independent, and a common error as large is in the deviations of what is
  /// identified alone. With 0.5 causes that are no candidates are taken for one too often:
  /// docs/validation/diagnosis.md.
  double common_share{};
  double shape_error{0.05};  ///< of a shape scaled to unit kinetic energy of the platform
  /// Use damping ratios too. Off unless asked for: valves and controller damp a machine at work,
  /// and the dampers in a machine file are rarely known.
  bool damping{};
  double damping_error{0.3};   ///< of ζ, relative
  bool responses{true};        ///< use measured responses too
  double response_error{0.1};  ///< of a column of responses, relative
  std::size_t strongest{6};    ///< causes whose pairs with all others are tried
  int threads{0};              ///< 0: as many as there are processors; results do not depend on it
};

/// A measured mode, or a direction of the platform at a pose.
struct Place {
  std::string pose{};
  int direction{-1};   ///< 0…5; −1: not known
  std::string mode{};  ///< name of the mode whose direction is not known
};

/// What a hypothesis gets wrong.
struct Contradiction {
  enum class Kind {
    resonances,  ///< `predicted` resonances at places where `measured` were found
    frequency,   ///< predicted at `omega`, off by `difference`
    shape,       ///< measured at `omega`; `mac` with the predicted one
    drives,      ///< the response to drives at `omega`; `mac` of the motion
    forces,      ///< the response to forces at `omega`, of which the share `missed` is not met
    value        ///< `value` would explain `direction`, and puts the place off by `difference`
  };
  Kind kind{};
  std::vector<Place> places{};
  int predicted{}, measured{};
  double omega{}, difference{};  ///< [rad/s]; predicted − measured
  double mac{}, missed{};
  int direction{};
  double value{}, deviation{};
  std::string unit{};
};

/// None, one or two causes, fitted.
struct Hypothesis {
  std::vector<std::size_t> causes{};  ///< indices into Diagnosis::causes
  bool rigid{};                       ///< the rigid-leg model
  dynamics::ModelKind kind{};
  std::vector<model::Assignment> changes{};  ///< what it needs before its parameters
  int parameters{};
  double misfit{};
  double bic{};
  calibration::Candidate fit{};
  /// Fitted to modes as mechanics alone: what was measured cannot be had of this machine, or it is
  /// far from the best. Frequencies of the plant or the system are then times the ratio of
  /// mechanics to it of the nominal machine.
  bool by_mechanics{};
  std::vector<Contradiction> wrong{};  ///< worst first
  /// Its parameters started at the values of the file.
  bool from_nominal{true};
  /// At which entrained air is compressed [Pa]; none: air is no candidate.
  std::optional<double> air_pressure{};
  /// Part of the misfit that comes from responses.
  [[nodiscard]] double response_misfit() const;
};

enum class Finding {
  nothing_to_blame,  ///< the rigid-leg model explains the measurement
  nominal,           ///< the machine is as its file says, with the compliances stated there
  identified,        ///< one hypothesis stands out
  undecided,         ///< several explain it equally well
  unexplained,       ///< nothing in the list explains it; the best one says what it misses
  do_not_belong,     ///< machine and data do not belong together; so do `objections`, if any
  cannot_tell,       ///< only hypotheses with as many numbers as values explain it
  interrupted        ///< before all hypotheses were tried
};

/// Why a hypothesis does not explain what was measured; the first that holds.
enum class Unexplained {
  scatter,      ///< s > no_explanation: even the best differs by more than deviations allow
  shapes_only,  ///< frequencies are those of the nominal machine, shapes are not: sensors
  unlisted,     ///< no better than a cause that is no candidate
  misfit,       ///< a χ² too large for its degrees of freedom
  untested,     ///< too many numbers for the measured frequencies
  at_bound      ///< a number at its bound
};

/// Fewer measured modes or directions say nothing.
inline constexpr int fewest_modes = 4, fewest_directions = 3;

/// Why the data cannot be this machine's, or cannot say anything about it.
struct Objection {
  enum class Kind {
    few_modes,       ///< `count`
    no_directions,   ///< neither directions nor shapes
    few_directions,  ///< `count`
    frequencies      ///< `ratio` times those of this machine (median)
  };
  enum class Slip { none, thousand, radians, per_minute, mass_or_stiffness };  ///< of units
  Kind kind{};
  int count{};
  double ratio{};
  Slip slip{};
};

/// Mechanics was compared instead of the system that was measured.
struct Substitution {
  observation::Observed measured{};
  std::string error{};  ///< of the nominal machine with its hydraulics; empty: too few modes
};

/// Causes that were not tested: no machine with modes, or no plant, has their numbers.
struct Untested {
  std::vector<std::size_t> causes{};  ///< indices into Diagnosis::causes; one, or a pair
  std::string error{};
};

/// A measured mode, and where the best hypothesis says that it comes from.
struct MeasuredMode {
  std::string pose{};
  int direction{-1};                                ///< 0…5; −1: not said
  double amplitude{};                               ///< [m] at which it was measured; 0: small
  double omega{}, deviation{}, common_deviation{};  ///< as used [rad/s]
  double omega_stated{}, omega_best{};  ///< of the nominal machine, of the best hypothesis
  double shape_mac{};                   ///< with the best hypothesis; 0 without a shape
  double rigid_mac{}, omega_rigid{};    ///< mode of rigid legs of which it holds most; 0: none
  /// Is it a resonance of that mode (FirstResonance)? The share that no measured mode holds is
  /// taken to be in one that was not measured.
  bool resonance{};
  /// What the mode of the best hypothesis mostly does, where that contradicts `direction`; else −1.
  int mode_direction{-1};
  /// Shares of the elastic energy; `oil` is that of the axial springs of the legs.
  double oil{}, guide_sleeves{}, piston_rings{}, base{}, payload{}, bending{};
  model::LegType leg_type{};  ///< whose axial springs they are
  /// 1 − ω/ω_rigid, of what was measured.
  [[nodiscard]] double drop() const { return omega_rigid > 0.0 ? 1.0 - omega / omega_rigid : 0.0; }
};

/// A measurement that would tell two hypotheses apart.
struct Discriminator {
  std::size_t other{};  ///< index of the hypothesis to be told from the best
  std::string pose{};
  int direction{};
  double omega_best{}, omega_other{};  ///< what they predict there [rad/s]; 0: no resonance
  double deviations{};                 ///< difference over what frequencies are known to
};

struct Diagnosis {
  Finding finding{};
  std::vector<Objection> objections{};  ///< where there are any, nothing else was tried
  std::optional<Substitution> substitution{};
  std::vector<Cause> causes{};
  std::vector<Hypothesis> hypotheses{};  ///< best first
  /// Single causes, and pairs of causes each of which was tested alone.
  std::vector<Untested> untested{};
  std::vector<std::size_t>
      equivalent{};  ///< those that the data cannot tell from the best, it first
  std::vector<Discriminator> discriminators{};
  observation::Targets targets{};     ///< with the deviations that were used
  std::vector<MeasuredMode> modes{};  ///< one per target
  int values{};                       ///< n
  double scatter{1.0};                ///< s
  /// Why judged() explains nothing; of the findings unexplained and do_not_belong.
  std::optional<Unexplained> unexplained{};
  std::vector<std::string> nominal_at{};  ///< poses not measured at which it has these modes
  int odd_mode{};  ///< from 1, the only one without which the nominal machine has all; 0: none
  bool interrupted{};

  [[nodiscard]] const Hypothesis& best() const { return hypotheses.front(); }
  /// The best of those with fewer numbers than values; best() where all have as many.
  [[nodiscard]] const Hypothesis& judged() const;
  [[nodiscard]] const Hypothesis& nominal() const;
};

/// The machine as a hypothesis has it, beside the text of the file. Throws base::InputError where
/// no machine has such numbers.
model::MachineFile file_of(const model::MachineFile& file, const Hypothesis& hypothesis);
model::Machine machine_of(const model::MachineFile& file, const Hypothesis& hypothesis);

/// `poses`: where measurements could be made, for discriminators. `progress`: share of the work
/// done; true asks to stop with what there is. Throws base::InputError for poses that the machine
/// does not have, and base::ComputationError when the nominal machine has no modes.
Diagnosis diagnose(const model::MachineFile& file, const observation::Targets& measured,
                   dynamics::ModelKind kind, const std::vector<model::NamedPose>& poses,
                   const DiagnoseOptions& options = {}, const numerics::Progress& progress = {});

enum class Compliance { guide_sleeve, piston_ring, gimbals, base_mount, payload, bending };

struct Part {
  Compliance what{};
  std::optional<int> leg{};  ///< 0…5; none: that of all legs, or the base's or the payload's
};

struct PartShare {
  Part part{};
  double omega{};  ///< first resonance with this part rigid [rad/s]
  double share{};  ///< of the drop that is gone then
};

struct AttributedDrop {
  FirstResonance resonance{};
  std::vector<PartShare> parts{};  ///< all legs first, then single legs
};

/// One per rigid mode. `machine` in its model `kind`; parts it does not have are left out.
std::vector<AttributedDrop> attribute_drops(const model::Machine& machine,
                                            const spatial::Pose& X_BP, dynamics::ModelKind kind);

/// What is wanted: a frequency, or a largest shift against the rigid-leg model; one of the two.
struct RemedyGoal {
  std::optional<double> omega{};   ///< [rad/s] the first resonance must reach
  std::optional<double> drop{};    ///< 0.02: at most 2 % below rigid, and no more above
  std::optional<int> direction{};  ///< 0…5; none: every direction
};

struct RemedyPoint {
  double factor{};     ///< on today's stiffness
  double stiffness{};  ///< of the stiffest leg's sleeve [N/m]
  double omega{};      ///< lowest first resonance over poses and directions asked for [rad/s]
  double drop{};       ///< largest drop
  double mac{};        ///< FirstResonance::mac of the resonance with that drop
  std::optional<double> softest{};  ///< as `stiffness`, of the softest leg where legs differ [N/m]
};

/// Stiffness of the guide sleeves [N/m] of the stiffest leg, and where legs differ of the softest.
struct SleeveRange {
  double stiffest{};
  std::optional<double> softest{};
};
SleeveRange sleeves_of(const model::Machine& machine);

enum class RemedyStatus {
  found,
  met_already,  ///< today's stiffness, or less, is enough
  out_of_reach  ///< rigid sleeves would not be enough: `limit` is what they give
};

/// A first resonance before and after.
struct Change {
  std::string pose{}, direction{};                      ///< no direction: every one
  double omega_rigid{}, omega_today{}, omega_needed{};  ///< [rad/s]; 0 where the legs fold
  double mac_today{}, mac_needed{};                     ///< FirstResonance::mac
};

struct Remedy {
  RemedyStatus status{};
  RemedyPoint today{}, needed{}, limit{};
  std::string pose{};       ///< that asks for the most
  std::string direction{};  ///< and its direction; empty: every one
  /// Where rods or cases bend: rigid sleeves and legs that do not. The rods make the difference.
  std::optional<RemedyPoint> limit_without_bending{};
  std::vector<RemedyPoint> curve{};  ///< from a tenth of today's stiffness to what is nearly rigid
  std::vector<Change> changes{};     ///< everywhere, with the stiffness that is needed
};

/// `poses`: at least one. Throws std::invalid_argument for a goal that says neither or both.
/// `progress`: share of the work done; true asks to stop, and base::ComputationError says so.
Remedy find_remedy(const model::Machine& machine, const std::vector<model::NamedPose>& poses,
                   dynamics::ModelKind kind, const RemedyGoal& goal,
                   const numerics::Progress& progress = {});

/// Poses spread over what stroke and joints allow around the neutral one: its own, and where each
/// of 26 directions of translation and of rotation ends at a limit (halfway there too).
std::vector<model::NamedPose> workspace_poses(const model::Machine& machine);

/// All that `hydrapod diagnose` finds out. Attribution and remedy are of the best hypothesis, or
/// of the nominal machine where nothing was measured or rigid legs explain it.
struct CaseFile {
  std::optional<Diagnosis> diagnosis{};
  model::Machine machine{};       ///< the one that attribution and remedy are of
  bool fitted{};                  ///< it is the best hypothesis, not the nominal machine
  SleeveRange nominal_sleeves{};  ///< of the nominal machine
  dynamics::ModelKind kind{};
  std::string pose{};  ///< of the attribution
  std::vector<AttributedDrop> drops{};
  RemedyGoal goal{};
  std::optional<Remedy> remedy{};
};

struct ChiSquared {
  double sum{};   ///< Σ (difference/deviation)²
  int values{};   ///< that it is of
  int degrees{};  ///< of freedom; 0: nothing can be said
  [[nodiscard]] double reduced() const { return degrees > 0 ? sum / degrees : 0.0; }
  /// Of a sum as large or larger, where the deviations are right; 1 without degrees of freedom.
  [[nodiscard]] double probability() const;
};

/// Does a hypothesis explain what was measured, by the deviations stated? The kinds of values are
/// judged one by one, so that many values of one kind, well met, do not hide that another is
/// missed: frequencies with n_f − k degrees of freedom (they determine the k numbers for the most
/// part), shapes and damping ratios, responses. Of each kind the probability is that of a χ² as
/// large or larger; `probability` is the least of them times the number of kinds (Bonferroni), at
/// most 1. Theory: docs/theory/diagnosis.md.
struct Goodness {
  ChiSquared frequencies{}, shapes{}, responses{};
  double reduced{};  ///< misfit over values − numbers, 0 where there are no more values
  double probability{};
};

Goodness goodness(const Diagnosis& d, const Hypothesis& hypothesis);

/// Measured frequencies that are more than three deviations from the nominal machine's.
int moved_frequencies(const Diagnosis& d);

/// None: it explains what was measured. Called on ranked hypotheses.
std::optional<Unexplained> why_unexplained(const Diagnosis& d, const Hypothesis& hypothesis);

/// Frequencies − numbers < tested_by: as many numbers as frequencies, or one less, meet any. Of a
/// pair of causes moved_frequencies ≤ numbers too: the best of some hundred pairs may meet one by
/// one the frequencies that are not the nominal machine's.
inline constexpr int tested_by = 2;

/// s² as it comes out, below 1 too; 0 where nothing has more values than numbers.
double raw_scatter2(const Diagnosis& d);

/// Size of the motion in one direction: of forces and commands in the six directions the direct
/// response, else the root of the sum of squares over all inputs. Predictions are as the diagnosis
/// compares them. What a valve or a controller makes of a command is known worse than how the
/// platform then moves: they are then multiplied by one factor over all lines, which makes the mean
/// difference of the logarithms zero.
struct ResponseCurve {
  int direction{};                 ///< of the motion, 0…5
  std::vector<double> measured{};  ///< per line [m or rad, per input]
  /// Per hypothesis asked for, and line; empty where its machine has no such response.
  std::vector<std::vector<double>> predicted{};
};

struct ResponseOverlay {
  std::string pose{};
  observation::Entry entry{};
  bool direct{};                ///< response to the input of the same direction, else of all inputs
  bool scaled{};                ///< predictions are multiplied by one factor per curve
  std::vector<double> omega{};  ///< [rad/s]
  std::vector<ResponseCurve> curves{};  ///< x … rz
};

/// One per pose and entry of `measured`, whose lines reach from half the lowest measured mode to
/// one and a half times the highest; every second, … of them where there are more than `most`.
/// `stated`: model of the nominal machine. `hypotheses`: indices into Diagnosis::hypotheses.
std::vector<ResponseOverlay> response_overlays(const model::MachineFile& file,
                                               const observation::Targets& measured,
                                               dynamics::ModelKind stated, const Diagnosis& found,
                                               const std::vector<std::size_t>& hypotheses,
                                               std::size_t most = 300);

}  // namespace hydrapod::diagnosis
