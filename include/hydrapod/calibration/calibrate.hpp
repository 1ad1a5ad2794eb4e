#pragma once
/// Finds the numbers of a machine file that nobody printed, and says which ones the data cannot
/// tell.
///
/// For every combination of the plan's alternatives, a least-squares problem over the free
/// parameters is solved from several starts: frequencies, dampings and shapes of the targets in
/// units of their deviations, priors, and the constraints that a machine which can be built must
/// keep (admissibility.hpp). Combinations are ranked: those that are admissible first, then by
/// misfit. Theory: docs/theory/calibration.md.

#include "hydrapod/calibration/identifiability.hpp"
#include "hydrapod/calibration/plan.hpp"
#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::calibration {

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
  double value{};                    ///< [unit]
  double deviation{};                ///< standard deviation [unit], prior included; inf: free
  double interval_low{};             ///< 95 %, [unit]
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

/// The machine file of a candidate: the text of `file` with the choices and the values put in, all
/// its comments kept, every changed value marked with its uncertainty. Throws
/// base::ComputationError should the result not read as the machine that was fitted.
std::string calibrated_text(const model::MachineFile& file, const Candidate& candidate);

}  // namespace hydrapod::calibration
