#include "hydrapod/observation/pairing.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "pair_cost.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using spatial::Matrix6;

}  // namespace

Vector6c turned_to_real(const Vector6c& motion) {
  const Complex sum = motion.cwiseProduct(motion).sum();
  return (motion * std::polar(1.0, -0.5 * std::arg(sum))).real().cast<Complex>();
}

Matrix6 metric_root(const Matrix6& mass) {
  // on its way a fit may try a platform whose inertia no body has
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(mass);
  return solver.eigenvectors() * solver.eigenvalues().cwiseAbs().cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

Matrix6 platform_metric(const model::Machine& machine, const spatial::Pose& X_BP,
                        const spatial::Vector3& p_PQ) {
  const auto& R = X_BP.R_BP;
  Matrix6 mass = Matrix6::Zero(), to_center = Matrix6::Identity();
  mass.topLeftCorner<3, 3>().diagonal().setConstant(machine.platform.mass);
  mass.bottomRightCorner<3, 3>() = R * machine.platform.inertia * R.transpose();
  to_center.topRightCorner<3, 3>() = -spatial::skew(R * (machine.platform.mass_center - p_PQ));
  return metric_root(mass) * to_center;
}

std::vector<std::vector<int>> group_of_each(std::span<const Complex> poles,
                                            const ObservationOptions& options) {
  std::vector<std::vector<int>> groups;
  for (const Complex a : poles) {
    auto& group = groups.emplace_back();
    for (std::size_t b = 0; b < poles.size(); ++b) {
      const double decay = std::min(std::abs(a.real()), std::abs(poles[b].real()));
      if (std::abs(a - poles[b]) <=
          std::max(options.same_frequency * std::abs(a), options.same_decay * decay))
        group.push_back(static_cast<int>(b));
    }
  }
  return groups;
}

std::vector<std::vector<int>> groups_of(std::span<const Complex> poles,
                                        const ObservationOptions& options) {
  std::vector<std::vector<int>> chains;
  for (auto joined : group_of_each(poles, options)) {
    std::erase_if(chains, [&](const std::vector<int>& chain) {
      const bool met = std::ranges::find_first_of(chain, joined) != chain.end();
      if (met) joined.insert(joined.end(), chain.begin(), chain.end());
      return met;
    });
    std::ranges::sort(joined);
    joined.erase(std::ranges::unique(joined).begin(), joined.end());
    chains.push_back(joined);
  }
  std::ranges::sort(chains);
  return chains;
}

template <class Matrix>
Matrix regularised(const Matrix& A, double weak) {
  Matrix gram = A.adjoint() * A;
  gram.diagonal().array() += weak * A.colwise().squaredNorm().maxCoeff();
  // so that of a single mode nothing is lost
  return (1.0 + weak) * gram.llt().solve(A.adjoint()).adjoint();
}
template Eigen::MatrixXd regularised(const Eigen::MatrixXd&, double);
template MatrixXcd regularised(const MatrixXcd&, double);

double shape_cost(double shown, double alone, double felt, const ObservationOptions& options) {
  return options.wrong_shape * (1.0 - shown) + options.wrong_member * (1.0 - felt * alone);
}

double frequency_cost(double omega, double wanted, const ObservationOptions& options) {
  const double least = 1e-3 * wanted;  // of modes that have buckled
  return std::pow(std::log(std::max(omega, least) / wanted) / options.frequency_scale, 2);
}

double felt_energy(const ObservedMode& mode, const Matrix6& mass) {
  const Vector6c motion = mode.motion(), momentum = mass.cast<Complex>() * motion;
  return motion.dot(momentum).real();
}

double share_shown(const MatrixXcd& A, const Eigen::VectorXcd& u, double weak) {
  return std::clamp(u.dot(A * (regularised(A, weak).adjoint() * u)).real(), 0.0, 1.0);
}

Matrix6 to_target_point(const dynamics::LinearModel& model, const ModeTarget& target) {
  Matrix6 A = Matrix6::Identity();
  if (target.shape_point)
    A.topRightCorner<3, 3>() = -spatial::skew(model.X_BP * *target.shape_point - model.p_BC);
  return A;
}

Vector6c shape_of(const ModeTarget& target) {
  return target.complex_shape ? target.complex_shape->motion
                              : Vector6c(target.shape->cast<Complex>());
}

double direction_share(const Observation& seen, int k, int direction) {
  const Vector6c motion = seen.modes[static_cast<std::size_t>(k)].motion();
  const Vector6c momentum = seen.mechanics.platform_mass.cast<Complex>() * motion;
  const double all = motion.dot(momentum).real();
  return all < modal::local_mode_energy
             ? 0.0
             : (std::conj(motion[direction]) * momentum[direction]).real() / all;
}

std::optional<int> contradicted_direction(const Observation& seen, int k,
                                          const std::vector<int>& group, int direction,
                                          const ObservationOptions& options) {
  const auto& mass = seen.mechanics.platform_mass;
  const auto energies = [&](int number) -> Vector6 {
    const Vector6c motion = seen.modes[static_cast<std::size_t>(number)].motion();
    const Vector6c momentum = mass.cast<Complex>() * motion;
    return motion.conjugate().cwiseProduct(momentum).real();
  };
  const Vector6 own = energies(k);
  if (own.sum() < options.visible) return std::nullopt;
  for (const int number : group) {
    const Vector6 energy = energies(number);
    const double all = energy.sum();
    if (all >= options.visible && energy[direction] >= options.contradicting * all)
      return std::nullopt;
  }
  int main = 0;
  own.maxCoeff(&main);
  return main == direction ? std::nullopt : std::optional(main);
}

namespace {

bool undamped(const Observation& seen) {
  return seen.modes.empty() || seen.modes.front().input.isZero(0.0);
}

/// The target's shape as motion of the mass centre; real for undamped modes.
Vector6c shape_at_center(const Observation& seen, const ModeTarget& target) {
  Vector6c shape = undamped(seen) ? Vector6c(target.shape->cast<Complex>()) : shape_of(target);
  const auto& model = seen.mechanics;
  if (target.shape_point) {
    const spatial::Vector3 from_center = model.X_BP * *target.shape_point - model.p_BC;
    shape.head<3>() += spatial::skew(from_center).cast<Complex>() * shape.tail<3>();
  }
  return shape;
}

/// A of a group, `map` being the metric of motions of the mass centre.
MatrixXcd shown_motions(const Observation& seen, const std::vector<int>& group,
                        const ModeTarget& target, const Matrix6& map) {
  const auto mode = [&](int k) -> const ObservedMode& {
    return seen.modes[static_cast<std::size_t>(k)];
  };
  const auto motion = [&](int k) -> Vector6c {
    return map.cast<Complex>() * mode(k).motion(target.shape_against);
  };
  if (undamped(seen)) {
    MatrixXcd A(6, group.size());
    for (std::size_t i = 0; i < group.size(); ++i)
      A.col(static_cast<Eigen::Index>(i)) = motion(group[i]);
    return A;
  }
  MatrixXcd A = MatrixXcd::Zero(6, 6);
  for (const int k : group) A += motion(k) * mode(k).input;
  if (!target.complex_shape)
    for (int column = 0; column < 6; ++column) A.col(column) = turned_to_real(A.col(column));
  return A;
}

}  // namespace

Vector6c shown_part(const Observation& seen, const std::vector<int>& group,
                    const ModeTarget& target, const Matrix6& root, const Vector6c& u) {
  const auto A = shown_motions(seen, group, target, root * to_target_point(seen.mechanics, target));
  return A * (regularised(A).adjoint() * u);
}

double shown_mac(const Observation& seen, const std::vector<int>& group, const ModeTarget& target) {
  const Matrix6 root = metric_root(seen.mechanics.platform_mass);
  const Vector6c u = (root.cast<Complex>() * shape_at_center(seen, target)).normalized();
  return share_shown(shown_motions(seen, group, target, root), u, ObservationOptions{}.weak);
}

namespace {

/// Costs of pairs of targets with the modes of one observation; what groups show is computed once.
class PairCosts {
 public:
  PairCosts(const Observation& seen, const ObservationOptions& options)
      : seen_(seen), options_(options), root_(metric_root(seen.mechanics.platform_mass)) {
    for (const auto& mode : seen.modes)
      energy_.push_back(felt_energy(mode, seen.mechanics.platform_mass));
  }

  [[nodiscard]] double of(int k, const std::vector<int>& group, const ModeTarget& target) {
    const double omega = seen_.modes[static_cast<std::size_t>(k)].omega();
    const double cost = frequency_cost(omega, target.omega, options_);
    if (cost > options_.hopeless) return cost + options_.wrong_shape;
    if (target.shape) return cost + of_shape(k, group, target);
    if (!target.direction) return cost;
    return cost + options_.wrong_shape * (1.0 - direction_share(seen_, k, *target.direction));
  }

 private:
  [[nodiscard]] double of_shape(int k, const std::vector<int>& group, const ModeTarget& target) {
    const double energy = energy_[static_cast<std::size_t>(k)];
    if (energy < modal::local_mode_energy) return shape_cost(0.0, 0.0, 0.0, options_);
    double most = 0.0;
    for (const int i : group) most = std::max(most, energy_[static_cast<std::size_t>(i)]);
    const Vector6c u = (root_.cast<Complex>() * shape_at_center(seen_, target)).normalized();
    const double shown = share(group, target, u);
    return shape_cost(shown, group.size() > 1 ? share({k}, target, u) : shown, energy / most,
                      options_);
  }

  double share(const std::vector<int>& modes, const ModeTarget& target, const Vector6c& u) {
    auto& P = shown_[{modes, target.shape_against, target.complex_shape.has_value()}];
    if (P.size() == 0) {
      const auto A = shown_motions(seen_, modes, target, root_);
      P = A * regularised(A, options_.weak).adjoint();
    }
    return std::clamp(u.dot(P * u).real(), 0.0, 1.0);
  }

  const Observation& seen_;
  const ObservationOptions& options_;
  Matrix6 root_;
  std::vector<double> energy_{};
  std::map<std::tuple<std::vector<int>, MotionAgainst, bool>, MatrixXcd> shown_{};
};

/// Gives every target a mode of its own; false where there are too few.
bool pair_among(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
                const std::vector<int>& modes, SeenPoint& point,
                const ObservationOptions& options) {
  if (here.size() > modes.size()) return false;
  if (modes.size() == 1 && here.size() == 1) {
    point.mode_of[here[0]] = modes[0];
    return true;
  }
  PairCosts costs(point.seen, options);
  Eigen::MatrixXd cost(here.size(), modes.size());
  for (std::size_t i = 0; i < here.size(); ++i)
    for (std::size_t k = 0; k < modes.size(); ++k)
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = costs.of(
          modes[k], point.group_of_mode[static_cast<std::size_t>(modes[k])], targets[here[i]]);
  if (!cost.allFinite()) return false;
  const auto chosen = numerics::assign(cost);
  for (std::size_t i = 0; i < here.size(); ++i)
    point.mode_of[here[i]] = modes[static_cast<std::size_t>(chosen[i])];
  return true;
}

}  // namespace

bool pair_seen(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
               SeenPoint& point, const ObservationOptions& options) {
  point.mode_of.assign(targets.size(), -1);
  std::vector<Complex> poles;
  for (const auto& mode : point.seen.modes) poles.push_back(mode.pole);
  point.group_of_mode = group_of_each(poles, options);
  std::vector<int> modes;
  for (std::size_t k = 0; k < poles.size(); ++k)
    if (point.seen.modes[k].damping_ratio() <= options.overdamped)
      modes.push_back(static_cast<int>(k));
  return pair_among(targets, here, modes, point, options);
}

bool pair_again(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
                SeenPoint& point, const ObservationOptions& options) {
  std::vector<std::size_t> left = here;
  while (!left.empty()) {
    // targets whose groups meet have their modes among them
    std::vector<std::size_t> together{left.front()};
    std::vector<int> modes = point.group_of(left.front());
    left.erase(left.begin());
    const auto meets = [&](std::size_t i) {
      const auto& group = point.group_of(i);
      return std::ranges::find_first_of(group, modes) != group.end();
    };
    for (auto i = std::ranges::find_if(left, meets); i != left.end();
         i = std::ranges::find_if(left, meets)) {
      together.push_back(*i);
      const auto& group = point.group_of(*i);
      modes.insert(modes.end(), group.begin(), group.end());
      left.erase(i);
    }
    std::ranges::sort(modes);
    modes.erase(std::ranges::unique(modes).begin(), modes.end());
    if (!pair_among(targets, together, modes, point, options)) return false;
  }
  return true;
}

}  // namespace hydrapod::observation
