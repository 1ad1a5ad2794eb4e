#include "hydrapod/observation/pairing.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "hydrapod/modal/mode_derivatives.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "pair_cost.hpp"

namespace hydrapod::observation {

std::vector<int> assign(const Eigen::MatrixXd& cost) {
  const auto rows = static_cast<int>(cost.rows()), columns = static_cast<int>(cost.cols());
  if (rows > columns)
    throw std::invalid_argument(
        fmt::format("{} targets cannot each have one of {} modes", rows, columns));
  if (!cost.allFinite()) throw std::invalid_argument("the costs of an assignment are not finite");
  // Shortest augmenting paths with potentials u, v; row and column 0 are a sentinel.
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<double> u(rows + 1, 0.0), v(columns + 1, 0.0);
  std::vector<int> row_of(columns + 1, 0), way(columns + 1, 0);
  for (int row = 1; row <= rows; ++row) {
    row_of[0] = row;
    int column = 0;
    std::vector<double> least(columns + 1, far);
    std::vector<bool> used(columns + 1, false);
    do {
      used[column] = true;
      const int from = row_of[column];
      double step = far;
      int next = 0;
      for (int j = 1; j <= columns; ++j) {
        if (used[j]) continue;
        const double reduced = cost(from - 1, j - 1) - u[from] - v[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[j] = column;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        if (used[j]) {
          u[row_of[j]] += step;
          v[j] -= step;
        } else {
          least[j] -= step;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = way[column]) row_of[column] = row_of[way[column]];
  }
  std::vector<int> column_of(rows, -1);
  for (int j = 1; j <= columns; ++j)
    if (row_of[j] != 0) column_of[row_of[j] - 1] = j - 1;
  return column_of;
}

double direction_share(const dynamics::LinearModel& model, const dynamics::NormalModes& modes,
                       int k, int direction) {
  const Vector6 motion = modes.shapes.col(k).head<6>();
  const Vector6 energy = motion.cwiseProduct(model.platform_mass * motion);
  // φᵀ M φ = 1: the sum is the platform's share of the whole
  return energy.sum() < modal::felt_by_platform ? 0.0 : energy[direction] / energy.sum();
}

double platform_mac(const dynamics::LinearModel& model, const dynamics::NormalModes& modes, int k,
                    const Vector6& shape) {
  const Vector6 motion = modes.shapes.col(k).head<6>();
  const Vector6 momentum = model.platform_mass * motion;
  const double own = motion.dot(momentum);
  const double of_shape = shape.dot(model.platform_mass * shape);
  // on its way a fit may try a platform whose inertia no body has
  if (!(own >= modal::felt_by_platform) || !(of_shape > 0.0)) return 0.0;
  return std::min(1.0, std::pow(shape.dot(momentum), 2) / (own * of_shape));
}

namespace {

template <class Matrix>
Matrix regularised_of(const Matrix& A) {
  Matrix gram = A.adjoint() * A;
  gram.diagonal().array() += weak_mode * A.colwise().squaredNorm().maxCoeff();
  // so that of a single mode nothing is lost
  return regularised_gain * gram.llt().solve(A.adjoint()).adjoint();
}

}  // namespace

Eigen::MatrixXd regularised(const Eigen::MatrixXd& A) { return regularised_of(A); }
Eigen::MatrixXcd regularised(const Eigen::MatrixXcd& A) { return regularised_of(A); }

spatial::Matrix6 seen_motion(const dynamics::LinearModel& model, MotionAgainst against) {
  return against == MotionAgainst::base ? model.against_base : spatial::Matrix6::Identity();
}

double resonance_mac(const dynamics::LinearModel& model, const dynamics::NormalModes& modes, int k,
                     const Vector6& shape, MotionAgainst against) {
  if (platform_mac(model, modes, k, modes.shapes.col(k).head<6>()) == 0.0) return 0.0;  // not felt
  const Eigen::LLT<spatial::Matrix6> llt(model.platform_mass);
  if (llt.info() != Eigen::Success) return 0.0;
  const spatial::Matrix6 root = llt.matrixU();
  const spatial::Matrix6 seen = root * seen_motion(model, against);
  const auto members = modal::neighbours(modes, k, seen_as_one);
  Eigen::MatrixXd A(6, members.size());
  for (std::size_t i = 0; i < members.size(); ++i)
    A.col(static_cast<Eigen::Index>(i)) = seen * modes.shapes.col(members[i]).head<6>();
  const Vector6 u = (root * shape).normalized();
  return u.dot(A * (regularised(A).transpose() * u));
}

namespace {

/// The modes in the metric of the platform's mass, looked at once for all targets that see the
/// same.
class ShownModes {
 public:
  ShownModes(const dynamics::LinearModel& model, const dynamics::NormalModes& modes,
             MotionAgainst against)
      : modes_(modes), llt_(model.platform_mass) {
    // on its way a fit may try a platform whose inertia no body has
    sound_ = llt_.info() == Eigen::Success;
    if (sound_)
      motions_ = spatial::Matrix6(llt_.matrixU()) * seen_motion(model, against) *
                 modes.shapes.topRows<6>();
  }

  /// Modes that are seen as one show the shape together; among them the one is meant that the
  /// platform feels most and that is most like it.
  double shape_cost(int k, const Vector6& shape) {
    if (!sound_) return wrong_shape + wrong_mode_of_group;
    const auto& group = group_of(k);
    const auto motion = motions_.col(k);
    if (motion.squaredNorm() < modal::felt_by_platform) return wrong_shape + wrong_mode_of_group;
    const Vector6 u = (llt_.matrixU() * shape).normalized();
    const double together = u.dot(group.A * (group.W.transpose() * u));
    const double own = std::min(1.0, std::pow(u.dot(motion), 2) / motion.squaredNorm());
    const double felt = motion.squaredNorm() / group.most;
    return wrong_shape * (1.0 - together) + wrong_mode_of_group * (1.0 - felt * own);
  }

 private:
  struct Group {
    Eigen::MatrixXd A{}, W{};
    double most{};
  };

  const Group& group_of(int k) {
    auto& group = groups_.try_emplace(k).first->second;
    if (group.A.size() > 0) return group;
    const auto members = modal::neighbours(modes_, k, seen_as_one);
    group.A = motions_(Eigen::all, members);
    group.W = regularised(group.A);
    group.most = group.A.colwise().squaredNorm().maxCoeff();
    return group;
  }

  const dynamics::NormalModes& modes_;
  Eigen::LLT<spatial::Matrix6> llt_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> motions_{};
  std::map<int, Group> groups_{};
  bool sound_{};
};

}  // namespace

Vector6 shape_at_center(const dynamics::LinearModel& model, const ModeTarget& target) {
  Vector6 shape = *target.shape;
  if (!target.shape_point) return shape;
  const spatial::Vector3 to_center = model.p_BC - model.X_BP * *target.shape_point;
  shape.head<3>() += shape.tail<3>().cross(to_center);
  return shape;
}

std::vector<int> pair_modes(const dynamics::LinearModel& model, const dynamics::NormalModes& modes,
                            std::span<const ModeTarget* const> targets) {
  std::map<MotionAgainst, ShownModes> shown;
  for (const auto* target : targets)
    shown.try_emplace(target->shape_against, model, modes, target->shape_against);
  Eigen::MatrixXd cost(targets.size(), modes.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i)
    for (int k = 0; k < modes.size(); ++k) {
      const auto& target = *targets[static_cast<std::size_t>(i)];
      const double omega = std::max(modes.omega(k), 1e-3 * target.omega);
      cost(i, k) = std::pow(std::log(omega / target.omega) / frequency_scale, 2);
      if (cost(i, k) > hopeless) {
        cost(i, k) += wrong_shape;
      } else if (target.shape) {
        cost(i, k) += shown.at(target.shape_against).shape_cost(k, shape_at_center(model, target));
      } else if (target.direction) {
        cost(i, k) += wrong_shape * (1.0 - direction_share(model, modes, k, *target.direction));
      }
    }
  return assign(cost);
}

}  // namespace hydrapod::observation
