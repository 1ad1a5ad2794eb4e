#include "hydrapod/observation/seen.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "pair_cost.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;
using spatial::Matrix6;

/// Turned so that the sum of the squares of the real parts is largest, and real.
Vector6c turned_to_real(const Vector6c& motion) {
  const Complex sum = motion.cwiseProduct(motion).sum();
  return (motion * std::polar(1.0, -0.5 * std::arg(sum))).real().cast<Complex>();
}

double felt_energy(const Observation& seen, int k) {
  const Vector6c motion = seen.modes[static_cast<std::size_t>(k)].motion();
  const Vector6c momentum = seen.mechanics.platform_mass.cast<Complex>() * motion;
  return motion.dot(momentum).real();
}

double direction_cost(const Observation& seen, int k, int direction) {
  const Vector6c motion = seen.modes[static_cast<std::size_t>(k)].motion();
  const Vector6c momentum = seen.mechanics.platform_mass.cast<Complex>() * motion;
  const double all = motion.dot(momentum).real();
  return all < modal::felt_by_platform
             ? 1.0
             : 1.0 - (std::conj(motion[direction]) * momentum[direction]).real() / all;
}

double shape_cost(const Observation& seen, int k, const std::vector<int>& group,
                  const ModeTarget& target) {
  double most = 0.0;
  for (const int i : group) most = std::max(most, felt_energy(seen, i));
  if (most < modal::felt_by_platform) return wrong_shape + wrong_mode_of_group;
  const double felt = felt_energy(seen, k) / most;
  return wrong_shape * (1.0 - shown_mac(seen, group, target)) +
         wrong_mode_of_group * (1.0 - felt * shown_mac(seen, {k}, target));
}

double pair_cost(const Observation& seen, int k, const std::vector<int>& group,
                 const ModeTarget& target) {
  const double omega = seen.modes[static_cast<std::size_t>(k)].omega();
  double cost = std::pow(std::log(omega / target.omega) / frequency_scale, 2);
  if (cost > hopeless) return cost + wrong_shape;
  if (target.shape)
    cost += shape_cost(seen, k, group, target);
  else if (target.direction)
    cost += wrong_shape * direction_cost(seen, k, *target.direction);
  return cost;
}

/// Gives every target a mode of its own; false where there are too few.
bool pair_among(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
                const std::vector<int>& modes, const std::vector<const std::vector<int>*>& groups,
                SeenPoint& point) {
  if (here.size() > modes.size()) return false;
  Eigen::MatrixXd cost(here.size(), modes.size());
  for (std::size_t i = 0; i < here.size(); ++i)
    for (std::size_t k = 0; k < modes.size(); ++k)
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          pair_cost(point.seen, modes[k], *groups[k], targets[here[i]]);
  if (!cost.allFinite()) return false;
  const auto chosen = assign(cost);
  for (std::size_t i = 0; i < here.size(); ++i) {
    const auto k = static_cast<std::size_t>(chosen[i]);
    point.mode_of[here[i]] = modes[k];
    point.group_of[here[i]] = *groups[k];
  }
  return true;
}

}  // namespace

std::vector<std::vector<int>> groups_of(const std::vector<ObservedMode>& modes) {
  constexpr double within_decay = 0.2;
  std::vector<std::vector<int>> groups;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto one = [&](int i) {
      const Complex a = modes[static_cast<std::size_t>(i)].pole, b = modes[k].pole;
      const double decay = std::min(std::abs(a.real()), std::abs(b.real()));
      return std::abs(a - b) <= std::max(0.5 * seen_as_one * std::abs(b), within_decay * decay);
    };
    std::vector<int> joined{static_cast<int>(k)};
    std::erase_if(groups, [&](const std::vector<int>& group) {
      if (std::ranges::none_of(group, one)) return false;
      joined.insert(joined.end(), group.begin(), group.end());
      return true;
    });
    groups.push_back(joined);
  }
  return groups;
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

Vector6c shown_part(const Observation& seen, const std::vector<int>& modes,
                    const ModeTarget& target, const Matrix6& root, const Vector6c& u) {
  const Eigen::Matrix<Complex, 6, 6> map =
      (root * to_target_point(seen.mechanics, target)).cast<Complex>();
  // poles that nearly coincide have vectors that are nearly one; their sum of residues has them all
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(6, 6);
  for (const int k : modes) {
    const auto& mode = seen.modes[static_cast<std::size_t>(k)];
    A += map * mode.motion(target.shape_against) * mode.input;
  }
  if (!target.complex_shape)
    for (int column = 0; column < 6; ++column) A.col(column) = turned_to_real(A.col(column));
  return A * (regularised(A).adjoint() * u);
}

double shown_mac(const Observation& seen, const std::vector<int>& modes, const ModeTarget& target) {
  const Eigen::LLT<Matrix6> llt(seen.mechanics.platform_mass);
  if (llt.info() != Eigen::Success) return 0.0;
  // the metric of the mass centre, for motions of the target's point
  const Matrix6 root = Matrix6(llt.matrixU()) * to_target_point(seen.mechanics, target).inverse();
  const Vector6c u = (root.cast<Complex>() * shape_of(target)).normalized();
  return std::clamp(u.dot(shown_part(seen, modes, target, root, u)).real(), 0.0, 1.0);
}

bool pair_seen(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
               SeenPoint& point) {
  point.mode_of.assign(targets.size(), -1);
  point.group_of.assign(targets.size(), {});
  const auto groups = groups_of(point.seen.modes);
  std::vector<int> modes;
  std::vector<const std::vector<int>*> group_of_mode;
  for (const auto& group : groups)
    for (const int k : group) {
      if (point.seen.modes[static_cast<std::size_t>(k)].damping_ratio() > overdamped) continue;
      modes.push_back(k);
      group_of_mode.push_back(&group);
    }
  return pair_among(targets, here, modes, group_of_mode, point);
}

bool follow_seen(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
                 const SeenPoint& center, SeenPoint& point) {
  point.mode_of.assign(targets.size(), -1);
  point.group_of.assign(targets.size(), {});
  // modes of the centre's groups, and which they are now
  std::vector<int> old;
  for (const auto i : here)
    for (const int k : center.group_of[i])
      if (std::ranges::find(old, k) == old.end()) old.push_back(k);
  const auto& before = center.seen.modes;
  const auto& now = point.seen.modes;
  if (old.size() > now.size()) return false;
  Eigen::MatrixXd cost(old.size(), now.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i)
    for (Eigen::Index k = 0; k < cost.cols(); ++k) {
      const Complex pole = before[static_cast<std::size_t>(old[static_cast<std::size_t>(i)])].pole;
      cost(i, k) = std::abs(now[static_cast<std::size_t>(k)].pole - pole) / std::abs(pole);
    }
  if (!cost.allFinite()) return false;
  const auto became = assign(cost);
  std::vector<bool> done(targets.size(), false);
  for (const auto i : here) {
    if (done[i]) continue;
    std::vector<std::size_t> together;  // targets in the same group
    for (const auto other : here)
      if (center.group_of[other] == center.group_of[i]) {
        together.push_back(other);
        done[other] = true;
      }
    std::vector<int> group;
    for (const int k : center.group_of[i])
      group.push_back(became[static_cast<std::size_t>(std::ranges::find(old, k) - old.begin())]);
    const std::vector<const std::vector<int>*> same(group.size(), &group);
    if (!pair_among(targets, together, group, same, point)) return false;
  }
  return true;
}

int nearest_mode(const Observation& seen, const ObservedMode& mode) {
  const auto modes = modal::normal_modes(seen.mechanics);
  const Eigen::VectorXcd momentum = seen.mechanics.M.cast<Complex>() * mode.shape;
  Eigen::Index nearest = 0;
  (modes.shapes.transpose().cast<Complex>() * momentum).cwiseAbs().maxCoeff(&nearest);
  return static_cast<int>(nearest);
}

}  // namespace hydrapod::observation
