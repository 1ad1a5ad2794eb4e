#pragma once
/// Finds the numbers of a machine file that nobody printed, and says which ones the data cannot
/// tell.
///
/// For every combination of the plan's alternatives, a least-squares problem over the free
/// parameters is solved from several starts: frequencies, dampings and shapes of the targets in
/// units of their deviations, priors, and the constraints that a machine which can be built must
/// keep (admissibility.hpp). Combinations are ranked: those that are admissible first, then by
/// misfit. Theory: docs/theory/calibration.md.
///
/// What a calibration may change, and what it is to compare.
///
/// What data say about parameters, and what they cannot say.
///
/// From the weighted Jacobian J of the data at the solution (residuals in standard deviations per
/// relative change of each parameter) by its singular values: along a right singular vector with
/// value σ the data know the parameters to ± 1/σ. A direction known no better than ± `free_above`
/// is free. Parameters that can be traded for each other without the data noticing are found as the
/// smallest groups whose columns of J nearly depend on each other. Bounds are not asked: what only
/// a bound holds, the data do not know.
///
/// A file of targets, and of what a calibration to them may change.
///
/// From TOML (docs/howto/calibrate.md), or from CSV with a title row such as
/// `frequency [Hz],direction,deviation [Hz],damping [%],pose,x,y,z,rx,ry,rz`, which has targets
/// alone.
///
/// How the modes of a machine follow the numbers of its file.
///
/// The derivatives of eigenvalues and shapes are exact given those of M, K and C
/// (modal/damped_modes.hpp). Those of the matrices are central differences of the assembly,
/// equilibrium under gravity included, with a relative step of `relative_step`: masses, inertias
/// and stiffnesses enter M and K linearly and lengths as low polynomials over l², so that the error
/// is some 1e-9 of the derivative.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::calibration {

/// A number [SI], or a quantity as somebody wrote it, "12 kg", in a unit of the path it is meant
/// for.
using Amount = std::variant<double, std::string>;

/// Knowledge about a parameter besides the data: Gaussian, value ± spread.
struct PriorAmounts {
  Amount value{};
  Amount spread{};  ///< > 0
};

/// Where something was asked for.
struct Origin {
  std::string file{};  ///< or the argument: `--free legs.rod.mass`
  unsigned line{};
  unsigned column{};
};

/// A number of the machine file that the fit may change; several paths are tied to one value.
struct FreeParameter {
  std::vector<std::string> paths{};
  std::optional<Amount> start{};  ///< default: the value in the file
  std::optional<Amount> lower{};  ///< default: a tenth of the start
  std::optional<Amount> upper{};  ///< default: ten times the start
  std::optional<PriorAmounts> prior{};
  Origin origin{};
};

/// One of several things that may be true of a machine, as overrides `PATH=VALUE` of its file.
struct Choice {
  std::string name{};
  std::vector<std::string> overrides{};
};

/// Choices of which one is true; every combination of all alternatives is fitted.
struct Alternative {
  std::string name{};
  std::vector<Choice> choices{};
  Origin origin{};
};

enum class Loss {
  automatic,  ///< squares; where single targets lie far off the others, Cauchy
  squares,
  cauchy  ///< a target off by many deviations pulls little
};

struct FitOptions {
  int starts{8};          ///< per combination, the first at the start values, the others at random
  std::uint64_t seed{1};  ///< of the random starts
  /// Starts that go on after `trial_iterations`: those of least cost that differ; 0: all do.
  int kept{};
  int trial_iterations{10};
  Loss loss{Loss::automatic};
  int max_iterations{200};
  double tolerance{1e-9};  ///< relative change of the cost that ends a fit
  int threads{0};          ///< 0: as many as there are processors; results do not depend on it
};

struct Plan {
  std::vector<FreeParameter> free{};
  std::vector<Alternative> alternatives{};
  FitOptions options{};
};

/// A direction whose relative standard deviation is larger than this is called free.
inline constexpr double free_above = 0.3;

/// A parameter as identifiability sees it.
struct ParameterColumn {
  std::string name{};  ///< "legs.rod.mass"
  std::string unit{};  ///< SI
  double value{};      ///< at the solution
  double size{};       ///< what a relative change is relative to: |value|, or a range around zero
};

/// Parameters of which the data know a combination only.
struct Trade {
  std::vector<int> parameters{};  ///< indices; a single one: the data do not see it at all
  Eigen::VectorXd direction{};    ///< relative changes that the data do not notice, largest 1
  double deviation{};             ///< how far one may go along it, relative; inf: anywhere
  std::string words{};            ///< "only legs.rod.mass + 1.02 legs.added_axial_inertia is …"
};

struct Identifiability {
  Eigen::VectorXd singular_values{};  ///< of J, descending
  Eigen::MatrixXd directions{};       ///< right singular vectors, columns, relative changes
  int rank{};                         ///< directions known better than free_above
  int numerical_rank{};               ///< singular values above rounding
  Eigen::VectorXd deviations{};       ///< relative, data alone; inf where not determined at all
  Eigen::MatrixXd correlations{};     ///< of the determined parameters; NaN elsewhere
  std::vector<Trade> trades{};        ///< smallest groups, shortest first
};

/// Singular values of J above rounding.
int numerical_rank(const Eigen::MatrixXd& J);

/// Trades are sought in groups of up to four parameters, fewer where there would be more than some
/// ten thousand groups. `J`: residuals in deviations × parameters, per relative change. `scatter`:
/// factor on all deviations where the data tell their own scatter, else 1.
Identifiability identify_parameters(const Eigen::MatrixXd& J,
                                    const std::vector<ParameterColumn>& parameters,
                                    double scatter = 1.0);

enum class Verdict {
  determined,    ///< by the data, to better than free_above
  undetermined,  ///< the data leave it free: its value is one of many
  ambiguous,     ///< the data fix it, but another value meets them as well
  at_bound,      ///< it would like to go beyond its bound
  by_prior       ///< the prior decides, not the data
};

struct FittedParameter {
  std::vector<std::string> paths{};
  std::string unit{};
  double start{}, lower{}, upper{};  ///< [unit]
  /// Least and greatest value that the machine file states for the paths, where they differ [unit].
  std::optional<std::array<double, 2>> stated{};
  double value{};         ///< [unit]
  double deviation{};     ///< standard deviation [unit], prior included; inf: free
  double interval_low{};  ///< 95 %, [unit]
  double interval_high{};
  double data_deviation{};  ///< of the data alone [unit]; inf: free
  Verdict verdict{};
  std::optional<double> other_value{};  ///< of a solution that is as good [unit]
  bool has_prior{};
};

struct FittedTarget {
  int mode{};      ///< of mechanics at the pose; where the plant or the system is observed the most
                   ///< like it
  double omega{};  ///< of the model [rad/s]
  double difference{};  ///< model − target, in deviations
  double damping{};     ///< ζ of the model; 0 where the target has none
  double shape_mac{};   ///< with the target's shape; 0 where it has none
  bool outlier{};
  /// What the mode mostly does, where that contradicts the direction of a target without a shape.
  std::optional<int> mode_direction{};
};

/// How a column of measured responses is met.
struct FittedResponse {
  std::size_t target{};  ///< number in Targets::responses
  std::size_t line{};
  int input{};
  /// Share of the measured column that is not met; where its size does not count √(1 − MAC).
  double missed{};
  double difference{};  ///< the same in deviations
};

/// One combination of choices, fitted.
struct Candidate {
  std::vector<std::size_t> choice{};     ///< per alternative
  std::vector<std::string> overrides{};  ///< of these choices
  std::string name{};                    ///< "joint circles swapped, mass centre below"
  bool fitted{};                         ///< the machine has modes
  std::string problem{};                 ///< why not
  bool converged{};
  double misfit{};                      ///< Σ (difference)² over the data
  double worst{};                       ///< largest |model − target| [rad/s]
  std::vector<std::string> violated{};  ///< what this machine would have to be, and cannot
  int starts_that_agree{};              ///< starts that ended at this misfit
  int starts{};
  bool robust{};  ///< Cauchy loss was used
  std::vector<FittedParameter> parameters{};
  std::vector<FittedTarget> targets{};
  std::vector<FittedResponse> responses{};
  Identifiability identifiability{};
  double scatter{1.0};  ///< root of the reduced misfit where the targets give no deviations

  /// What the best fit would be with signs and constraints let go: filled in for combinations that
  /// fit worse than the best by far.
  struct Unbound {
    double misfit{}, worst{};
    std::vector<std::string> violated{};
    std::vector<double> values{};  ///< of the parameters [unit]
  };
  std::optional<Unbound> unbound{};

  [[nodiscard]] bool admissible() const { return fitted && violated.empty(); }
};

struct Calibration {
  std::vector<Alternative> alternatives{};
  std::vector<Candidate> candidates{};  ///< best first
  bool interrupted{};
  [[nodiscard]] const Candidate& best() const { return candidates.front(); }
};

using numerics::Progress;

/// Throws base::InputError for paths, poses, bounds or choices that cannot be, all at once, and
/// base::ComputationError when no combination has modes.
Calibration calibrate(const model::MachineFile& file, const observation::Targets& targets,
                      const Plan& plan, dynamics::ModelKind kind, const Progress& progress = {});

/// The machine as it is against the targets: a candidate without parameters.
Candidate compare(const model::MachineFile& file, const observation::Targets& targets,
                  dynamics::ModelKind kind);

/// One point of a profile: everything else fitted with the parameter held.
struct ProfilePoint {
  double value{};   ///< [unit]
  double misfit{};  ///< Σ (difference)², priors included
};

/// Profile likelihood of parameter `index` of `candidate`: how the misfit grows as it is held away
/// from its best value, over the parameter's interval (or bounds, where it is free).
struct Profile {
  int parameter{};
  std::vector<ProfilePoint> points{};  ///< ascending in value
  double interval_low{};               ///< 95 %: where the misfit has grown by 3.84 (scatter²)
  double interval_high{};  ///< −inf, +inf where it does not grow that much in the bounds
};
Profile profile(const model::MachineFile& file, const observation::Targets& targets,
                const Plan& plan, dynamics::ModelKind kind, const Candidate& candidate, int index,
                const Progress& progress = {});

/// Throws base::ComputationError for a target that no machine near the candidate has: its pair is
/// another mode, or its unit is wrong. It is more than 100 deviations and a quarter of the
/// frequency from its mode.
void require_possible_targets(const Candidate& candidate, const observation::Targets& targets);

/// The machine file of a candidate: the text of `file` with the choices and the values put in, all
/// its comments kept, every changed value marked with its uncertainty. Throws as
/// require_possible_targets(), and base::ComputationError should the result not read as the machine
/// that was fitted.
std::string calibrated_text(const model::MachineFile& file, const Candidate& candidate,
                            const observation::Targets& targets);

struct TargetsFile {
  observation::Targets targets{};
  Plan plan{};
};

/// Reads `path`; CSV where it ends in .csv, else TOML. Throws base::InputError with every mistake.
TargetsFile read_targets(const std::string& path, const std::vector<std::string>& poses = {});

/// The same from text; `file_name` decides between CSV and TOML and is what messages call it.
TargetsFile parse_targets(const std::string& text, const std::string& file_name,
                          const std::vector<std::string>& poses = {});

inline constexpr double relative_step = 1e-4;

/// The modes at one pose and how they follow the parameters.
struct ModePoint {
  dynamics::LinearModel model{};
  dynamics::NormalModes modes{};
  std::vector<modal::ModelDerivative> derivatives{};   ///< per parameter [per its SI unit]
  std::vector<spatial::Vector3> center_derivatives{};  ///< of the mass centre's place [m per unit]
  /// Of LinearModel::against_base.
  std::vector<dynamics::PlatformRows> against_base_derivatives{};
  Eigen::MatrixXd domega2{};  ///< modes × parameters
  /// Per mode the damped mode that it is, where that is known and oscillates: of machines with
  /// elastomers always, since the undamped modes have the dampers of the seals' arms rigid.
  std::vector<std::optional<modal::DampedMode>> damped{};
  std::vector<double> ratio_derivatives{};  ///< of the ratio ζ that all modes have, per parameter
  /// Of |λ| and ζ of the damped modes, modes × parameters; rows of the others are 0.
  Eigen::MatrixXd dpole_omega{}, dpole_ratio{};

  /// Do frequencies repeat?
  [[nodiscard]] bool repeats() const { return modes.group.back() + 1 < modes.size(); }
  /// Null where it is not known.
  [[nodiscard]] const modal::DampedMode* damped_mode(int mode) const;
  /// |λ| of the damped mode where it is known, else ω of the undamped one, negative below buckling.
  [[nodiscard]] double omega(int mode) const;
};

/// A machine with the numbers of it that vary: a parameter sets all of its ids to one value.
struct VariedMachine {
  model::Machine machine{};
  std::vector<std::vector<model::ParameterId>> parameters{};

  /// Of the parameters in `machine`, each in its first id [SI].
  [[nodiscard]] std::vector<double> values() const;
  /// The machine with the parameters at `values`, not validated.
  [[nodiscard]] model::Machine at(const std::vector<double>& values) const;
  /// The same into `result`, whose memory is used again.
  void at(const std::vector<double>& values, model::Machine& result) const;
};

/// Modes of `machine` at its pose number `pose`, without derivatives. Throws base::ComputationError
/// where the machine has no modes there.
ModePoint mode_point(const model::Machine& machine, std::size_t pose, dynamics::ModelKind kind);

/// Adds the derivatives by the parameters to the point of the machine at `values`. `scales`: size
/// of each parameter, for the steps. Turns the basis of modes that repeat to the parameter that
/// parts them most.
void add_derivatives(const VariedMachine& machine, const std::vector<double>& values,
                     std::size_t pose, std::span<const double> scales, ModePoint& point);

/// One mode's frequency |λ|, as modal::damped_modes() has it, against all numbers of the file.
struct Sensitivities {
  std::vector<model::FileNumber> parameters{};  ///< those that matter and are not zero
  /// Modes × parameters: d ln ω / d ln p; NaN for modes that have buckled or do not oscillate.
  Eigen::MatrixXd percent_per_percent{};
  /// [rad/s], ascending; 0: buckled; last the undamped ones of modes that do not oscillate.
  Eigen::VectorXd omega{};
};

/// All numbers of the file that change its modes at pose number `pose`, or those at `paths`.
/// Numbers that are zero have no relative sensitivity and are left out.
Sensitivities sensitivities(const model::MachineFile& file, std::size_t pose,
                            dynamics::ModelKind kind, const std::vector<std::string>& paths = {});

}  // namespace hydrapod::calibration
