// What a measurement of the plant says, as residuals; derivatives are central differences of the
// residuals themselves, with the same modes on both sides.
#include "hydrapod/calibration/pairing.hpp"
#include "problem.hpp"

namespace hydrapod::calibration {

namespace {

using spatial::Matrix6;

class DifferencedResidual : public ResidualKind {
 public:
  explicit DifferencedResidual(int point_target) : target_(point_target) {}

  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    const auto p = static_cast<std::size_t>(problem.point_of(target_));
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
      : DifferencedResidual(target), difference_(difference) {}
  [[nodiscard]] int size() const override { return 1; }

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
  using DifferencedResidual::DifferencedResidual;
  [[nodiscard]] int size() const override { return 12; }
  [[nodiscard]] int values() const override { return 6; }

 private:
  [[nodiscard]] Eigen::VectorXd value(const Problem& problem,
                                      const SeenPoint& point) const override {
    const auto& wanted = problem.targets().modes[target()];
    const Matrix6 root = problem.metric(target()).asDiagonal();
    const Vector6c u = (root.cast<std::complex<double>>() * shape_of(wanted)).normalized();
    const auto& group = point.group_of[static_cast<std::size_t>(target())];
    const double deviation =
        wanted.complex_shape ? wanted.complex_shape->deviation : wanted.shape_deviation;
    const Vector6c r = (u - shown_part(point.seen, group, wanted, root, u)) / deviation;
    Eigen::VectorXd parts(12);
    parts << r.real(), r.imag();
    return parts;
  }
};

}  // namespace

void add_plant_residuals(const Targets& targets,
                         std::vector<std::unique_ptr<ResidualKind>>& kinds) {
  for (int i = 0; i < static_cast<int>(targets.modes.size()); ++i) {
    const auto& target = targets.modes[i];
    kinds.push_back(std::make_unique<PlantNumber>(i, frequency_difference));
    if (target.damping) kinds.push_back(std::make_unique<PlantNumber>(i, damping_difference));
    if (target.shape) kinds.push_back(std::make_unique<PlantShape>(i));
  }
}

}  // namespace hydrapod::calibration
