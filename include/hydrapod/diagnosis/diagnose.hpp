#pragma once
/// Which part is guilty: every suspect, alone and in pairs, fitted to the modes that were measured.
///
/// An explanation is the machine as stated with none, one or two suspects let free; beside them
/// stands the rigid calculation, with legs that do not bend. Explanations are ranked by
///
///     criterion = misfit/s² + k ln n + 2 ln C(N, m)
///
/// misfit: Σ (difference/deviation)² over the n measured values, of modes and responses; k: numbers
/// fitted; m of N suspects are blamed (Bayesian information criterion with known deviations, and a
/// prior that gives every number of suspects the same odds: with many suspects one of them fits
/// noise by chance); s ≥ 1: by what the deviations are too small, from the explanation that fits
/// best for its number of parameters. Two that differ by less than `same` cannot be told apart by
/// the data, and nothing is blamed unless it beats the machine as stated by more than that. Theory:
/// docs/theory/diagnosis.md.

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/diagnosis/suspect.hpp"

namespace hydrapod::diagnosis {

/// Difference of the criterion up to which explanations count as equally good (odds of 20 : 1).
inline constexpr double same = 6.0;

/// s above which even the best explanation is none, and above which machine and data may not even
/// belong together. The right explanation has s = 1, where deviations are right.
inline constexpr double no_explanation = 2.0, another_machine = 5.0;

/// How near a model with the right numbers comes to a real machine: added (root of the sum of
/// squares) to what the measurement says of its own errors.
struct DiagnoseOptions {
  double frequency_error{2e-3};  ///< of ω, relative
  double shape_error{0.05};      ///< of a shape scaled to unit kinetic energy of the platform
  /// Use dampings too. Off unless asked for: valves and controller damp a machine at work, and the
  /// dampers in a machine file are rarely known.
  bool damping{};
  double damping_error{0.3};  ///< of ζ, relative
  /// Use measured responses too; see responses.hpp.
  bool responses{true};
  double response_error{0.1};  ///< of a column of responses, relative
  std::size_t strongest{6};    ///< suspects whose pairs with all others are tried
  int threads{0};              ///< 0: as many as there are processors; results do not depend on it
};

/// None, one or two suspects, fitted.
struct Explanation {
  std::vector<std::size_t> suspects{};  ///< indices into Diagnosis::suspects
  bool rigid{};                         ///< the rigid calculation
  std::string name{};                   ///< "the machine as stated", "guide sleeves of all legs"
  dynamics::ModelKind kind{};
  std::vector<model::Assignment> changes{};  ///< what it needs before its parameters
  int parameters{};
  double misfit{};
  double criterion{};
  calibration::Candidate fit{};
  /// Fitted to modes as mechanics alone: what was measured cannot be had of this machine, or it is
  /// far from the best. Frequencies of the plant or the system are then times the ratio of
  /// mechanics to it of the machine as stated.
  bool by_mechanics{};
  std::vector<std::string> wrong{};  ///< what it gets wrong, in words, worst first
};

enum class Finding {
  nothing_to_blame,  ///< the rigid calculation explains what was measured
  as_stated,         ///< the machine is as its file says, with the compliances stated there
  guilty,            ///< one explanation stands out
  undecided,         ///< several explain it equally well
  unexplained,       ///< nothing in the list explains it; `reasons` says what the best one misses
  do_not_belong      ///< machine and data do not belong together; `reasons` says why
};

/// "no cause", ….
const char* name(Finding finding);

/// A measured mode, and where the best explanation says that it comes from.
struct MeasuredMode {
  std::string pose{};
  int direction{-1};                    ///< 0…5; −1: not said
  double omega{}, deviation{};          ///< as used [rad/s]
  double omega_stated{}, omega_best{};  ///< of the machine as stated, of the best explanation
  double shape_mac{};                   ///< with the best explanation; 0 without a shape
  double omega_rigid{};  ///< mode of the rigid calculation of which it holds most; 0: none
  double rigid_mac{};
  double oil{}, guide_sleeves{}, piston_rings{}, base{};  ///< shares of the elastic energy
  /// 1 − ω/ω_rigid, of what was measured.
  [[nodiscard]] double drop() const { return omega_rigid > 0.0 ? 1.0 - omega / omega_rigid : 0.0; }
};

/// A measurement that would tell two explanations apart.
struct Discriminator {
  std::size_t other{};  ///< index of the explanation to be told from the best
  std::string pose{};
  int direction{};
  double omega_best{}, omega_other{};  ///< what they predict there [rad/s]; 0: no resonance
  double deviations{};                 ///< difference over what frequencies are known to
};

struct Diagnosis {
  Finding finding{};
  std::vector<std::string> reasons{};  ///< for unexplained and do_not_belong
  std::vector<std::string> notes{};    ///< what was measured and could not be used as it is
  std::vector<Suspect> suspects{};
  std::vector<Explanation> explanations{};  ///< best first
  std::vector<std::size_t> alike{};  ///< those that the data cannot tell from the best, it first
  std::vector<Discriminator> discriminators{};
  observation::Targets targets{};     ///< with the deviations that were used
  std::vector<MeasuredMode> modes{};  ///< one per target
  int values{};                       ///< n
  double scatter{1.0};                ///< s
  bool interrupted{};

  [[nodiscard]] const Explanation& best() const { return explanations.front(); }
  [[nodiscard]] const Explanation* find(const std::string& name) const;
  [[nodiscard]] const Explanation& as_stated() const;
};

/// The machine as an explanation has it, beside the text of the file. Throws base::InputError where
/// no machine has such numbers.
model::MachineFile file_of(const model::MachineFile& file, const Explanation& explanation);
model::Machine machine_of(const model::MachineFile& file, const Explanation& explanation);

/// `poses`: where measurements could be made, for discriminators. `progress`: share of the work
/// done; true asks to stop with what there is. Throws base::InputError for poses that the machine
/// does not have, and base::ComputationError when the machine as stated has no modes.
Diagnosis diagnose(const model::MachineFile& file, const observation::Targets& measured,
                   dynamics::ModelKind kind, const std::vector<model::NamedPose>& poses,
                   const DiagnoseOptions& options = {}, const numerics::Progress& progress = {});

}  // namespace hydrapod::diagnosis
