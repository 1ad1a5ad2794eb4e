// The kinds of residuals; a new kind of evidence is a new class here.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "problem.hpp"

namespace hydrapod::calibration {

namespace {

using dynamics::PlatformRows;
using observation::regularised;
using spatial::Matrix6;

constexpr observation::ObservationOptions options{};
constexpr double together = 2.0 * options.same_frequency;  // of ω²

/// Where a target's mode is found.
struct Found {
  const ModePoint& point;
  int mode;
  const std::vector<int>& group;
};

Found found(const Problem& problem, const State& state, int target) {
  const int point = problem.point_of(target);
  return {state.points[point], state.seen[point].mode_of[target],
          state.seen[point].group_of(target)};
}

/// (ω − ω_t) / deviation
class FrequencyResidual : public ResidualKind {
 public:
  explicit FrequencyResidual(int target) : ResidualKind(1, 1), target_(target) {}
  [[nodiscard]] bool is_frequency() const override { return true; }
  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    const auto& [point, mode, group] = found(problem, state, target_);
    const auto& target = problem.targets().modes[target_];
    r[0] = (point.omega(mode) - target.omega) / target.deviation;
    if (J == nullptr) return;
    if (point.damped_mode(mode) != nullptr) {
      *J = point.dpole_omega.row(mode) / target.deviation;
      return;
    }
    const double least = 1e-6 * target.omega;  // at buckling the derivative has a pole
    const double omega = std::max(std::abs(point.omega(mode)), least);
    *J = point.domega2.row(mode) / (2.0 * omega * target.deviation);
  }

 private:
  int target_;
};

/// (ζ − ζ_t) / deviation with ζ = φᵀ C φ / 2ω + the modal ratio: first order in the coupling that
/// dampers make between modes; where the damped mode is known, its own.
class DampingResidual : public ResidualKind {
 public:
  explicit DampingResidual(int target) : ResidualKind(1, 1), target_(target) {}
  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    const auto [point, mode, group] = found(problem, state, target_);
    const auto& target = problem.targets().modes[target_];
    const double ratio = modal::modal_ratio(state.machine).value;
    if (const auto* damped = point.damped_mode(mode)) {
      r[0] = (damped->damping_ratio - *target.damping) / target.damping_deviation;
      if (J != nullptr) *J = point.dpole_ratio.row(mode) / target.damping_deviation;
      return;
    }
    const double omega2 = std::max(point.modes.omega2[mode], 1e-12 * target.omega * target.omega);
    const double omega = std::sqrt(omega2);
    const dynamics::ModelVector phi = point.modes.shapes.col(mode);
    const dynamics::ModelVector C_phi = point.model.C * phi;
    const auto& arms = point.model.arms;
    const double viscous =
        (phi.dot(C_phi) + modal::relaxed_damping(arms, phi, omega)) / (2.0 * omega);
    r[0] = (viscous + ratio - *target.damping) / target.damping_deviation;
    if (J == nullptr) return;
    dynamics::ModelVector force = C_phi;
    for (const auto& arm : arms) force += damper_at(arm, omega) * arm.s_y.dot(phi) * arm.s_y;
    *J = force.transpose() * modal::shape_derivatives(point.modes, mode, point.derivatives) / omega;
    *J -= viscous / (2.0 * omega2) * point.domega2.row(mode);
    for (Eigen::Index j = 0; j < J->cols(); ++j)
      (*J)(0, j) += phi.dot(point.derivatives[static_cast<std::size_t>(j)].C * phi) / (2.0 * omega);
    if (!arms.empty()) add_arms(point, phi, mode, *J);
    if (state.machine.damping.modal_ratio && arms.empty()) add_ratio(problem, *J);
    *J /= target.damping_deviation;
  }

 private:
  /// What changes of the arms and of the frequency at which they are dampers do.
  static void add_arms(const ModePoint& point, const dynamics::ModelVector& phi, int mode,
                       Eigen::MatrixXd& J) {
    const double omega = std::sqrt(std::max(point.modes.omega2[mode], 0.0));
    if (omega == 0.0) return;
    double by_omega = 0.0;
    for (const auto& arm : point.model.arms) {
      const double square = omega * omega + arm.rate * arm.rate;
      by_omega -= 2.0 * omega * damper_at(arm, omega) / square * std::pow(arm.s_y.dot(phi), 2);
    }
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      const auto& of = point.derivatives[static_cast<std::size_t>(j)];
      const double change = (modal::relaxed_damping(of.arms_above, phi, omega) -
                             modal::relaxed_damping(of.arms_below, phi, omega)) /
                            (2.0 * of.step);
      J(0, j) += (change + by_omega * point.domega2(mode, j) / (2.0 * omega)) / (2.0 * omega);
    }
  }

  static void add_ratio(const Problem& problem, Eigen::MatrixXd& J) {
    static const auto ratio =
        model::find_parameter(model::Machine{}, "damping.modal_ratio").value();
    const auto& variables = problem.variables();
    for (std::size_t j = 0; j < variables.size(); ++j)
      if (std::ranges::count(variables[j].ids, ratio) > 0)
        J(0, static_cast<Eigen::Index>(j)) += 1.0;
  }

  int target_;
};

/// With elastomers the real part of the damped mode: seals then are as stiff as they are at its
/// frequency. Its derivatives are taken to be those of the undamped shape.
dynamics::ModelVector shape_of(const ModePoint& point, int mode) {
  if (const auto* damped = point.damped_mode(mode)) return damped->real;
  return point.modes.shapes.col(mode);
}

/// What of the target's shape the group of the mode does not show: r = (1 − P) u / deviation
/// (observation/pairing.hpp), so that for one mode |r|² = (1 − MAC) / deviation².
class ShapeResidual : public ResidualKind {
 public:
  explicit ShapeResidual(int target) : ResidualKind(6, 6), target_(target) {}
  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    const auto [point, mode, members] = found(problem, state, target_);
    const auto& target = problem.targets().modes[target_];
    // of the start: else the residual would move with the platform's mass
    const Matrix6& root = problem.metric(target_);
    const Vector6 u = (root * *target.shape).normalized();
    const Matrix6 at_point = to_target_point(point.model, target);
    const bool by_base = target.shape_against == MotionAgainst::base;
    const PlatformRows seen =
        by_base ? point.model.against_base : PlatformRows::Identity(6, point.model.dof());
    Eigen::MatrixXd A(6, members.size());
    for (std::size_t k = 0; k < members.size(); ++k)
      A.col(static_cast<Eigen::Index>(k)) = root * at_point * (seen * shape_of(point, members[k]));
    const Eigen::MatrixXd W = regularised(A);
    r = (u - A * (W.transpose() * u)) / target.shape_deviation;
    if (J == nullptr) return;
    J->setZero(6, problem.size());
    std::vector<Eigen::MatrixXd> dphi;
    for (const int k : members)
      dphi.push_back(modal::shape_derivatives(point.modes, k, point.derivatives, together));
    for (int j = 0; j < problem.size(); ++j) {
      Eigen::MatrixXd dA(6, members.size());
      for (std::size_t k = 0; k < members.size(); ++k) {
        const dynamics::ModelVector motion = shape_of(point, members[k]);
        Vector6 change = seen * dphi[k].col(j);
        if (by_base) change += point.against_base_derivatives[static_cast<std::size_t>(j)] * motion;
        dA.col(static_cast<Eigen::Index>(k)) =
            root * (at_point * change + moving_center(point, target, j, seen * motion));
      }
      const Eigen::VectorXd p = W.transpose() * u;
      const Eigen::VectorXd dP_u = dA * p + W * (dA.transpose() * u) -
                                   W *
                                       (dA.transpose() * (A * p) + A.transpose() * (dA * p) +
                                        regularising_change(A, dA) * p) /
                                       (1.0 + options.weak);
      J->col(j) = -dP_u / target.shape_deviation;
    }
  }

 private:
  /// What ε changes by, see regularised().
  static double regularising_change(const Eigen::MatrixXd& A, const Eigen::MatrixXd& dA) {
    Eigen::Index largest = 0;
    A.colwise().squaredNorm().maxCoeff(&largest);
    return 2.0 * options.weak * A.col(largest).dot(dA.col(largest));
  }

  /// What the point's motion changes by when parameter j moves the mass centre.
  static Vector6 moving_center(const ModePoint& point, const ModeTarget& target, int j,
                               const Vector6& motion) {
    Vector6 change = Vector6::Zero();
    if (target.shape_point)
      change.head<3>() =
          -motion.tail<3>().cross(point.center_derivatives[static_cast<std::size_t>(j)]);
    return change;
  }

  int target_;
};

/// (p − value) / spread
class PriorResidual : public ResidualKind {
 public:
  explicit PriorResidual(int variable) : ResidualKind(1, 1, false), variable_(variable) {}
  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    const auto& prior = *problem.variables()[variable_].prior;
    r[0] = (state.values[variable_] - prior.value) / prior.spread;
    if (J == nullptr) return;
    J->setZero(1, problem.size());
    (*J)(0, variable_) = 1.0 / prior.spread;
  }

 private:
  int variable_;
};

/// Constraints that would be broken, at 1000 per unit of their relative margin. They begin to push
/// a little before the limit, so that a fit that leans on one ends within it.
class AdmissibilityResidual : public ResidualKind {
 public:
  explicit AdmissibilityResidual(int constraints) : ResidualKind(constraints, constraints, false) {}
  void evaluate(const Problem& problem, const State& state, Eigen::Ref<Eigen::VectorXd> r,
                Eigen::MatrixXd* J) const override {
    constexpr double weight = 1000.0, room = 1e-3;
    if (J != nullptr) J->setZero(size(), problem.size());
    for (int k = 0; k < size(); ++k) {
      // margins of exactly zero belong to numbers that only need a sign
      const bool broken = state.margins[k] < room && state.margins[k] != 0.0;
      r[k] = broken ? weight * (state.margins[k] - room) : 0.0;
      if (broken && J != nullptr) J->row(k) = weight * state.dmargins.row(k);
    }
  }
};

/// Frequency, damping and shape of one target each, of mechanics.
void add_mechanics_residuals(const Targets& targets,
                             std::vector<std::unique_ptr<ResidualKind>>& kinds) {
  for (int i = 0; i < static_cast<int>(targets.modes.size()); ++i) {
    const auto& target = targets.modes[i];
    kinds.push_back(std::make_unique<FrequencyResidual>(i));
    if (target.damping) kinds.push_back(std::make_unique<DampingResidual>(i));
    if (target.shape) kinds.push_back(std::make_unique<ShapeResidual>(i));
  }
}

}  // namespace

std::vector<std::unique_ptr<ResidualKind>> make_residuals(const Targets& targets,
                                                          const std::vector<Variable>& variables,
                                                          bool hold_to_physics,
                                                          std::size_t constraints) {
  std::vector<std::unique_ptr<ResidualKind>> kinds;
  if (targets.observed != Observed::mechanics)
    add_plant_residuals(targets, kinds);
  else
    add_mechanics_residuals(targets, kinds);
  add_response_residuals(targets, kinds);
  for (int j = 0; j < static_cast<int>(variables.size()); ++j)
    if (variables[j].prior) kinds.push_back(std::make_unique<PriorResidual>(j));
  if (hold_to_physics)
    kinds.push_back(std::make_unique<AdmissibilityResidual>(static_cast<int>(constraints)));
  return kinds;
}

}  // namespace hydrapod::calibration
