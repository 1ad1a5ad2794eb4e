#pragma once
/// The numbers of a machine that meet requirements at every pose with the least or largest aim.

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

/// What is made small or large: an output, the worst of all poses, or one of the changed numbers.
struct Aim {
  std::string text{};  ///< "minimise platform.mass"
  std::string name{}, unit{};
  bool maximise{};
  int output{-1}, change{-1};  ///< one of them is set
};

/// A number of one's own of a design, whose values [SI] are those of the changes, at a pose. Called
/// from several threads; base::ComputationError and NaN: it has none.
struct OwnOutput {
  Column column{};
  std::function<double(std::span<const double> values, const model::NamedPose& pose)> of{};
};

struct DesignProblem {
  model::Machine machine{};
  dynamics::ModelKind kind{};
  std::vector<model::NamedPose> poses{};
  std::vector<Input> changes{};  ///< uniform distributions; their ends are the bounds
  std::vector<OwnOutput> own{};
  std::vector<Column> outputs{};  ///< see design_outputs()
  std::vector<Requirement> requirements{};
  std::vector<Aim> aims{};  ///< one; two for a trade-off
};

/// Outputs of machine_problem(), extra_outputs(), then `own`. The rest of `problem` may be empty
/// yet. Throws base::InputError for one of `own` named as another.
std::vector<Column> design_outputs(const DesignProblem& problem);

/// Outputs of a machine at one pose, and their derivatives.
class DesignModel {
 public:
  /// Outputs outside `wanted` (numbers of columns) are left out where they cost more than modes do.
  /// Throws base::ComputationError where the machine has modes neither as it is nor at the bounds.
  DesignModel(const DesignProblem& problem, const model::NamedPose& pose, std::vector<int> wanted);
  /// Of one design; NaN where there is none, also the status is in it.
  void outputs(std::span<const double> values, std::span<double> outputs);
  /// Of many, modes in SIMD lanes.
  void outputs(std::span<const Row> rows);
  struct Derivatives {
    Eigen::MatrixXd by_change{};  ///< a row per wanted output, a column per change [SI]
    /// Per wanted output: of the mode that has its value, dω²/dp = φᵀ (dK/dp − ω² dM/dp) φ; else by
    /// central differences of the output.
    std::vector<bool> of_mode{};
  };
  Derivatives derivatives(std::span<const double> values, std::span<const double> outputs);

 private:
  void add_differences(std::span<const double> values, std::span<const double> outputs,
                       Derivatives& result);
  struct Parts;
  std::shared_ptr<Parts> parts_;
};

struct DesignOptions {
  std::uint64_t samples{2048};  ///< Sobol points at which the search begins, besides the corners
  std::uint64_t seed{1};
  int starts{6};  ///< local searches, from the best samples
  int front{11};  ///< points of a trade-off curve
  int threads{};
};

/// A design with the worst of all poses.
struct DesignPoint {
  std::vector<double> values{};  ///< of the changes [SI]
  bool computed{}, feasible{};   ///< status 0 at every pose; and every requirement is met there
  std::vector<double> aims{};
  std::vector<double> worst{};  ///< per requirement, NaN where there is none
  std::vector<int> pose{};      ///< per requirement, where that is
};

/// What keeps the aim from getting better.
struct Limit {
  enum class Kind {
    requirement,  ///< `requirement` is met with less than 1e-4 of its bound to spare, at `pose`
    lower_bound,  ///< of `change`
    upper_bound,
    jump  ///< beyond `values`, a step of 1e-5 of the range of `change`, `requirement` is missed at
          ///< once by more than 1e-3 of its bound: another mode takes over
  };
  Kind kind{};
  int requirement{-1}, change{-1}, pose{-1};
  /// Change of the aim per change of the requirement's or the change's bound [SI], the Lagrange
  /// multiplier with its sign; none where the local model does not explain the point.
  std::optional<double> price{};
  double beyond{};  ///< of a jump: the output there
};

/// The extreme value of a requirement's output that was found, without all other requirements.
struct Reach {
  double value{};
  bool enough{};
  std::vector<double> values{};  ///< of the changes
};
struct DesignResult {
  DesignPoint present{};  ///< the machine as it is, also where that is beyond the bounds
  DesignPoint best{};     ///< feasible, or the least violation found
  std::vector<Limit> limits{};
  std::vector<Reach> reach{};        ///< per requirement, where no feasible design was found
  std::vector<DesignPoint> front{};  ///< of two aims, ascending in the first, none dominated
  std::uint64_t evaluations{};       ///< designs, each at every pose
  std::uint64_t feasible_samples{}, samples{};
  /// Samples per Status, each with the highest one of all poses.
  std::array<std::uint64_t, 5> statuses{};
  bool interrupted{};
};

/// Sobol points, then SLSQP with derivatives and COBYLA (NLopt) from the best of them, then steps
/// along single changes down to 1e-9 of their range, which also end at jumps. What is returned was
/// evaluated at every pose, one design at a time. Ctrl-C ends the search with the best so far.
DesignResult design(const DesignProblem& problem, const DesignOptions& options,
                    const numerics::Progress& progress = {});

/// Where single changes lead from a design: least margin over all requirements and poses as a share
/// of the bound, per change `count` values between its bounds.
struct Slice {
  std::vector<double> values{};
  std::vector<std::vector<double>> worst{};  ///< per requirement
};
std::vector<Slice> design_slices(const DesignProblem& problem, const DesignPoint& at, int count);

}  // namespace hydrapod::study
