#pragma once
/// One least-squares problem: a machine file with its choices made, targets, parameters. Private to
/// the module.
///
/// The solver's variables x are ln p where a parameter keeps its sign (bounds on one side of zero),
/// else (p − start)/scale: so a step of 0.01 is some per cent everywhere.

#include <memory>

#include "admissibility.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/observation/observation.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::calibration {

using observation::ModeTarget;
using observation::MotionAgainst;
using observation::Observation;
using observation::Observed;
using observation::ObservedMode;
using observation::ObservedSystem;
using observation::ResponseTarget;
using observation::SeenPoint;
using observation::Targets;
using observation::Vector6c;
using spatial::Vector6;

struct Prior {
  double value{};
  double spread{};
};

/// A parameter with everything resolved to SI.
struct Variable {
  std::vector<std::string> paths{};
  std::vector<model::ParameterId> ids{};
  std::string unit{};
  double start{}, lower{}, upper{};
  std::optional<std::array<double, 2>> stated{};  ///< as in FittedParameter
  std::optional<Prior> prior{};
  double scale{1.0};  ///< of a linear variable
  int sign{};         ///< ±1: x = ln |p|; 0: linear

  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double x(double value) const;
  [[nodiscard]] double slope(double x) const;  ///< dp/dx
  [[nodiscard]] double x_lower() const { return sign < 0 ? x(upper) : x(lower); }
  [[nodiscard]] double x_upper() const { return sign < 0 ? x(lower) : x(upper); }
};

/// Everything that residuals are computed from, at one x.
struct State {
  std::vector<double> values{};  ///< parameters [SI]
  model::Machine machine{};
  std::vector<ModePoint> points{};  ///< one per place, where modes are those of mechanics
  std::vector<double> modes_at{};   ///< values that `points` are of; empty: none
  std::vector<double> seen_at{};    ///< values that the responses of `seen` are of; empty: none
  std::vector<SeenPoint> seen{};    ///< one per place; modes of mechanics are those of `points`
  /// The same a step to each side, parameter by parameter; of plant and system to first order
  /// (tangent.hpp).
  std::vector<std::vector<SeenPoint>> seen_below{}, seen_above{};
  std::vector<double> steps{};  ///< [SI]
  Eigen::VectorXd margins{};    ///< admissibility
  Eigen::MatrixXd dmargins{};   ///< per parameter
};

class Problem;

/// A group of residuals. J is size × parameters, per SI unit of the parameter.
class ResidualKind {
 public:
  virtual ~ResidualKind() = default;
  [[nodiscard]] int size() const { return size_; }
  /// How many values it says something about.
  [[nodiscard]] int values() const { return values_; }
  /// Is it the frequency of a target?
  [[nodiscard]] virtual bool is_frequency() const { return false; }
  /// May it be an outlier?
  [[nodiscard]] bool is_data() const { return is_data_; }
  virtual void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                        Eigen::MatrixXd* J) const = 0;

 protected:
  ResidualKind(int size, int values, bool is_data = true)
      : size_(size), values_(values), is_data_(is_data) {}

 private:
  int size_, values_;
  bool is_data_;
};

struct ProblemOptions {
  bool hold_to_physics{true};  ///< add the admissibility residuals
};

class Problem {
 public:
  /// Throws base::InputError when a target's pose is unknown or has more targets than modes.
  Problem(const model::Machine& machine, const Targets& targets, std::vector<Variable> variables,
          dynamics::ModelKind kind, const ProblemOptions& options);

  /// As it was given, before the variables have other values.
  [[nodiscard]] const model::Machine& machine() const { return machine_.machine; }
  [[nodiscard]] const Targets& targets() const { return targets_; }
  [[nodiscard]] dynamics::ModelKind kind() const { return kind_; }
  [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }
  [[nodiscard]] const std::vector<std::unique_ptr<ResidualKind>>& residuals() const {
    return residuals_;
  }
  [[nodiscard]] int size() const { return static_cast<int>(variables_.size()); }
  /// Are modes those of the plant, controlled or not? Else of mechanics.
  [[nodiscard]] bool observes_plant() const { return targets_.observed != Observed::mechanics; }
  [[nodiscard]] int point_of_response(int response) const { return point_of_response_[response]; }
  [[nodiscard]] int point_of(int target) const { return point_of_[target]; }
  /// observation::platform_metric of the machine at the start, for motions of the target's point.
  [[nodiscard]] const spatial::Matrix6& metric(int target) const { return metric_[target]; }
  [[nodiscard]] const spatial::Matrix6& metric_of_response(int response) const {
    return metric_of_response_[response];
  }

  /// The state at x; false where the machine has no modes there.
  bool evaluate(const Eigen::VectorXd& x, bool derivatives, State& state) const;

  /// All residuals, and their derivatives by x when the state has them; those of frequencies that
  /// have a common error without their correlation.
  void residuals(const Eigen::VectorXd& x, const State& state, Eigen::VectorXd& r,
                 Eigen::MatrixXd* J) const;

  [[nodiscard]] Eigen::VectorXd start() const;

 private:
  void find_poses(const model::Machine& machine);
  void without_common_error(Eigen::VectorXd& r, Eigen::MatrixXd* J) const;
  /// Where modes are observed: a pose of the machine, and the amplitude of the platform [m], 0: of
  /// small motions.
  struct Place {
    std::size_t pose{};
    double amplitude{};
    bool operator==(const Place&) const = default;
  };
  [[nodiscard]] std::vector<std::size_t> targets_at(std::size_t point) const;
  bool see_modes(const std::vector<double>& scales, State& state) const;
  bool pair_modes_at(std::size_t point, State& state) const;
  /// False where the derivatives of a mode that a target is paired with cannot be had.
  bool add_damped_derivatives(std::size_t point, const std::vector<double>& scales,
                              State& state) const;
  bool see_all(const std::vector<double>& scales, State& state) const;
  [[nodiscard]] const control::ControllerParameters* controller(const model::NamedPose& pose) const;
  [[nodiscard]] Observation see(const model::Machine& machine, std::size_t point) const;
  [[nodiscard]] ObservedSystem system(const model::Machine& machine, std::size_t point) const;
  bool see_beside(std::size_t parameter, double step, State& state) const;
  void add_margins(const std::vector<double>& scales, State& state) const;

  VariedMachine machine_;
  const Targets& targets_;
  std::vector<Variable> variables_;
  dynamics::ModelKind kind_;
  ProblemOptions options_;
  std::vector<Place> places_{};  ///< of the points
  std::vector<int> point_of_{}, point_of_response_{};
  std::vector<spatial::Matrix6> metric_{}, metric_of_response_{};
  std::vector<std::unique_ptr<ResidualKind>> residuals_{};
  observation::CommonError common_error_;
};

/// What is left of every column of the measured responses at a line, in the metric `root` of
/// motions of the measured point and
/// scaled to length one, beside the calculated one with the phase, and unless it is one to forces
/// the size, that fit it best: 6 × inputs.
Eigen::MatrixXcd response_rest(const Observation& seen, const ResponseTarget& target,
                               std::size_t line, const spatial::Matrix6& root);

/// Frequency, damping and shape of one target each, of the plant's modes.
void add_plant_residuals(const Targets& targets, std::vector<std::unique_ptr<ResidualKind>>& kinds);
/// Responses, all of a pose together.
void add_response_residuals(const Targets& targets,
                            std::vector<std::unique_ptr<ResidualKind>>& kinds);

/// Frequency, damping and shape of one target each, the priors, the constraints.
std::vector<std::unique_ptr<ResidualKind>> make_residuals(const Targets& targets,
                                                          const std::vector<Variable>& variables,
                                                          bool hold_to_physics,
                                                          std::size_t constraints);

}  // namespace hydrapod::calibration
