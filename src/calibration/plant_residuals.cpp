// What a measurement says of what was observed (observation.hpp), as residuals: modes of the plant
// or of the system, responses of any; derivatives are central differences of the residuals
// themselves, with the same modes on both sides.
#include "hydrapod/observation/pairing.hpp"
#include "problem.hpp"

namespace hydrapod::calibration {

namespace {

using spatial::Matrix6;

class DifferencedResidual : public ResidualKind {
 public:
  DifferencedResidual(int target, int size, int values)
      : ResidualKind(size, values), target_(target) {}

  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    const auto p = static_cast<std::size_t>(point(problem));
    r = value(problem, state.seen[p]);
    if (J == nullptr) return;
    J->resize(size(), problem.size());
    for (int j = 0; j < problem.size(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      J->col(j) =
          (value(problem, state.seen_above[at][p]) - value(problem, state.seen_below[at][p])) /
          (2.0 * state.steps[at]);
    }
  }

 protected:
  [[nodiscard]] virtual Eigen::VectorXd value(const Problem& problem,
                                              const SeenPoint& point) const = 0;
  /// Of the problem's poses.
  [[nodiscard]] virtual int point(const Problem& problem) const {
    return problem.point_of(target_);
  }
  [[nodiscard]] int target() const { return target_; }
  [[nodiscard]] const ObservedMode& mode(const SeenPoint& point) const {
    const auto k = point.mode_of[static_cast<std::size_t>(target_)];
    return point.seen.modes[static_cast<std::size_t>(k)];
  }

 private:
  int target_;
};

double frequency_difference(const ObservedMode& mode, const ModeTarget& wanted) {
  return (mode.omega() - wanted.omega) / wanted.deviation;
}

double damping_difference(const ObservedMode& mode, const ModeTarget& wanted) {
  return (mode.damping_ratio() - *wanted.damping) / wanted.damping_deviation;
}

/// One number of a mode against its target's, in deviations.
class PlantNumber : public DifferencedResidual {
 public:
  using Difference = double (*)(const ObservedMode&, const ModeTarget&);
  PlantNumber(int target, Difference difference)
      : DifferencedResidual(target, 1, 1), difference_(difference) {}
  [[nodiscard]] bool is_frequency() const override { return difference_ == frequency_difference; }

 private:
  [[nodiscard]] Eigen::VectorXd value(const Problem& problem,
                                      const SeenPoint& point) const override {
    return Eigen::VectorXd::Constant(1,
                                     difference_(mode(point), problem.targets().modes[target()]));
  }

  Difference difference_;
};

/// (1 − A Wᴴ) u / deviation, as of mechanics (residuals.cpp): real parts, then imaginary ones.
class PlantShape : public DifferencedResidual {
 public:
  explicit PlantShape(int target) : DifferencedResidual(target, 12, 6) {}

 private:
  [[nodiscard]] Eigen::VectorXd value(const Problem& problem,
                                      const SeenPoint& point) const override {
    const auto& wanted = problem.targets().modes[target()];
    const Matrix6& root = problem.metric(target());
    const Vector6c u = (root.cast<std::complex<double>>() * shape_of(wanted)).normalized();
    const auto& group = point.group_of(static_cast<std::size_t>(target()));
    const double deviation =
        wanted.complex_shape ? wanted.complex_shape->deviation : wanted.shape_deviation;
    const Vector6c r = (u - shown_part(point.seen, group, wanted, root, u)) / deviation;
    Eigen::VectorXd parts(12);
    parts << r.real(), r.imag();
    return parts;
  }
};

/// All columns of responses at one pose: what is left of each, over its deviation.
class Responses : public DifferencedResidual {
 public:
  Responses(int target, const ResponseTarget& measured)
      : DifferencedResidual(
            target,
            12 * static_cast<int>(measured.s.size()) * static_cast<int>(measured.inputs.cols()),
            measured.values) {}

 private:
  [[nodiscard]] int point(const Problem& problem) const override {
    return problem.point_of_response(target());
  }
  [[nodiscard]] Eigen::VectorXd value(const Problem& problem,
                                      const SeenPoint& seen) const override {
    const auto& measured = problem.targets().responses[target()];
    const auto& root = problem.metric_of_response(target());
    Eigen::VectorXd all(size());
    int row = 0;
    for (std::size_t line = 0; line < measured.s.size(); ++line) {
      const Eigen::MatrixXcd rest = response_rest(seen.seen, measured, line, root);
      for (int input = 0; input < rest.cols(); ++input, row += 12) {
        const Vector6c r = rest.col(input) / measured.deviation[line][input];
        all.segment<6>(row) = r.real();
        all.segment<6>(row + 6) = r.imag();
      }
    }
    return all;
  }
};

}  // namespace

Eigen::MatrixXcd response_rest(const Observation& seen, const ResponseTarget& target,
                               std::size_t line, const Matrix6& root) {
  using Complex = std::complex<double>;
  const bool forces = target.entry == observation::Entry::forces;
  Matrix6 to_point = Matrix6::Identity();
  to_point.topRightCorner<3, 3>() =
      -spatial::skew(seen.mechanics.X_BP * target.point - seen.mechanics.p_BC);
  const Matrix6 map = root * to_point;
  // forces at the point are as much at the mass centre, with their moments about that
  const Eigen::MatrixXd inputs = forces ? to_point.transpose() * target.inputs : target.inputs;
  const Eigen::MatrixXcd V = map.cast<Complex>() *
                             seen.response(target.s[line], target.entry, target.against,
                                           target.window ? &*target.window : nullptr) *
                             inputs.cast<Complex>();
  Eigen::MatrixXcd rest = root.cast<Complex>() * target.H[line];
  for (Eigen::Index input = 0; input < rest.cols(); ++input) {
    const double size = rest.col(input).norm();
    const Vector6c u = rest.col(input) / size, v = V.col(input);
    const Complex both = v.dot(u),
                  factor = both / (forces ? size * std::abs(both) : v.squaredNorm());
    rest.col(input) = u - v * factor;
  }
  return rest;
}

void add_plant_residuals(const Targets& targets,
                         std::vector<std::unique_ptr<ResidualKind>>& kinds) {
  for (int i = 0; i < static_cast<int>(targets.modes.size()); ++i) {
    const auto& target = targets.modes[i];
    kinds.push_back(std::make_unique<PlantNumber>(i, frequency_difference));
    if (target.damping) kinds.push_back(std::make_unique<PlantNumber>(i, damping_difference));
    if (target.shape) kinds.push_back(std::make_unique<PlantShape>(i));
  }
}

void add_response_residuals(const Targets& targets,
                            std::vector<std::unique_ptr<ResidualKind>>& kinds) {
  for (int i = 0; i < static_cast<int>(targets.responses.size()); ++i)
    kinds.push_back(std::make_unique<Responses>(i, targets.responses[i]));
}

}  // namespace hydrapod::calibration
