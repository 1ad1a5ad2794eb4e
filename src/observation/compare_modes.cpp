#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/modal/mode_table.hpp"
#include "pair_cost.hpp"

namespace hydrapod::observation {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double band_margin = 0.2;  // a model's mode this far outside may be a measured one
constexpr double unseen = 1e-6;      // of the largest motion that the outputs see
constexpr double hides_nothing = 1e-12;

bool is_angle(const data::Channel& channel) { return channel.unit.starts_with("rad"); }

/// Outputs that see the platform's motion, in their metric.
struct Comparable {
  std::vector<int> outputs{};
  std::vector<bool> against_ground{};
  MatrixXd map{};   ///< outputs × 6
  MatrixXd root{};  ///< of the metric
};

Comparable comparable(const std::vector<data::Channel>& channels, const ComparisonFrame& frame) {
  const MatrixXd all = output_map(channels, frame);
  Comparable some;
  for (Index o = 0; o < all.rows(); ++o) {
    if (!all.row(o).allFinite()) continue;
    some.outputs.push_back(static_cast<int>(o));
    some.against_ground.push_back(data::against_ground(channels[static_cast<std::size_t>(o)]));
  }
  some.map = all(some.outputs, Eigen::all);
  if (!some.outputs.empty())
    some.root = output_metric(
        some.map, platform_metric(frame.machine, frame.X_BP, frame.machine.platform.mass_center));
  return some;
}

/// Both sides on the comparable outputs, in their metric.
struct Shapes {
  MatrixXcd measured{}, model{};  ///< column per mode
  std::vector<double> energy{};   ///< of the platform, per model mode
  std::vector<bool> seen{};       ///< model modes that the outputs see
};

Shapes shapes_of(const data::ModalResults& found, const std::vector<ObservedMode>& model,
                 const Comparable& some, const ComparisonFrame& frame) {
  const Index rows = some.map.rows();
  Shapes shapes{.measured = MatrixXcd(rows, static_cast<Index>(found.modes.size())),
                .model = MatrixXcd(rows, static_cast<Index>(model.size()))};
  for (std::size_t r = 0; r < found.modes.size(); ++r)
    shapes.measured.col(static_cast<Index>(r)) = found.modes[r].shape(some.outputs);
  for (std::size_t m = 0; m < model.size(); ++m)
    for (Index k = 0; k < rows; ++k)
      shapes.model(k, static_cast<Index>(m)) =
          some.map.row(k).cast<std::complex<double>>() *
          model[m].motion(some.against_ground[static_cast<std::size_t>(k)] ? MotionAgainst::ground
                                                                           : MotionAgainst::base);
  const spatial::Matrix6 root =
      platform_metric(frame.machine, frame.X_BP, frame.machine.platform.mass_center);
  for (std::size_t m = 0; m < model.size(); ++m) {
    const double whole = model[m].motion().norm() * some.map.norm();
    shapes.energy.push_back(felt_energy(model[m], root.transpose() * root));
    shapes.seen.push_back(
        shapes.energy.back() >= modal::local_mode_energy &&
        (rows == 0 || shapes.model.col(static_cast<Index>(m)).norm() > unseen * whole));
  }
  if (rows == 0) return shapes;
  shapes.measured = some.root * shapes.measured;
  shapes.model = some.root * shapes.model;
  return shapes;
}

bool may_be_measured(const ObservedMode& mode, const data::ModalResults& found,
                     double highest_damping) {
  const double f = mode.omega() / base::two_pi;
  return mode.damping_ratio() <= highest_damping && f >= found.from * (1.0 - band_margin) &&
         f <= found.to * (1.0 + band_margin);
}

void list_left(const data::ModalResults& found, double highest_damping, const Shapes& shapes,
               const std::vector<bool>& taken, ModeComparison& result) {
  for (std::size_t m = 0; m < result.model.size(); ++m) {
    const auto& mode = result.model[m];
    const double f = mode.omega() / base::two_pi;
    if (taken[m] || mode.damping_ratio() > highest_damping || f < found.from || f > found.to)
      continue;
    const auto reason = shapes.energy[m] < modal::local_mode_energy ? Unpaired::not_felt
                        : !shapes.seen[m]                           ? Unpaired::not_seen
                                                                    : Unpaired::not_found;
    result.model_left.push_back({static_cast<int>(m), reason});
  }
}

/// Costs of pairs, measured × (model, then a column per measured mode that stays alone), and the
/// MAC of measured modes with the groups of model modes.
struct Costs {
  MatrixXd cost{}, shown{};
};

/// Per model mode its group, of those that the outputs see.
std::vector<std::vector<int>> groups_seen(const std::vector<ObservedMode>& model,
                                          const Shapes& shapes, const ObservationOptions& options) {
  std::vector<std::complex<double>> poles;
  std::vector<int> number;
  for (std::size_t m = 0; m < model.size(); ++m)
    if (shapes.seen[m]) {
      poles.push_back(model[m].pole);
      number.push_back(static_cast<int>(m));
    }
  std::vector<std::vector<int>> group_of(model.size());
  const auto groups = group_of_each(poles, options);
  for (std::size_t i = 0; i < groups.size(); ++i)
    for (const int k : groups[i])
      group_of[static_cast<std::size_t>(number[i])].push_back(number[static_cast<std::size_t>(k)]);
  return group_of;
}

Costs pair_costs(const data::ModalResults& found, const Shapes& shapes, double highest_damping,
                 const ObservationOptions& options, ModeComparison& result) {
  constexpr double impossible = 1e6;
  const auto measured = static_cast<Index>(found.modes.size());
  const auto models = static_cast<Index>(result.model.size());
  const bool with_shapes = !result.outputs.empty();
  Costs costs{.cost = MatrixXd::Constant(measured, models + measured, impossible)};
  costs.cost.rightCols(measured).setConstant(options.no_partner);
  if (with_shapes) {
    costs.shown = MatrixXd::Zero(measured, models);
    result.mac.resize(measured, models);
  }
  const auto groups = groups_seen(result.model, shapes, options);
  const MatrixXcd columns = shapes.model.colwise().normalized();
  for (Index m = 0; m < models; ++m) {
    const auto number = static_cast<std::size_t>(m);
    const auto& group = groups[number];
    double most = 0.0;
    for (const int k : group) most = std::max(most, shapes.energy[static_cast<std::size_t>(k)]);
    const bool possible =
        shapes.seen[number] && may_be_measured(result.model[number], found, highest_damping);
    for (Index r = 0; r < measured; ++r) {
      const VectorXcd u = shapes.measured.col(r).normalized();
      if (with_shapes) result.mac(r, m) = data::mac(u, shapes.model.col(m));
      if (with_shapes && shapes.seen[number])
        costs.shown(r, m) = share_shown(columns(Eigen::all, group), u, hides_nothing);
      if (!possible) continue;
      costs.cost(r, m) = frequency_cost(found.modes[static_cast<std::size_t>(r)].omega(),
                                        result.model[number].omega(), options);
      if (with_shapes)
        costs.cost(r, m) +=
            shape_cost(costs.shown(r, m), result.mac(r, m), shapes.energy[number] / most, options);
    }
  }
  return costs;
}

/// Numbers of measuring points of outputs with a direction of the platform.
std::set<int> points_of(const std::vector<data::Channel>& outputs) {
  std::set<int> points;
  for (const auto& channel : outputs) {
    const int code = std::abs(static_cast<int>(channel.direction));
    if (code >= 1 && code <= 6) points.insert(channel.point);
  }
  return points;
}

}  // namespace

MatrixXd output_metric(const MatrixXd& S, const spatial::Matrix6& root) {
  const MatrixXd half = S * root.inverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(half * half.transpose());
  constexpr double rounding = 1e-12;
  VectorXd weight = solver.eigenvalues();
  const double none = rounding * weight.maxCoeff();
  for (double& w : weight) w = w > none ? 1.0 / std::sqrt(w) : 0.0;
  return solver.eigenvectors() * weight.asDiagonal() * solver.eigenvectors().transpose();
}

MatrixXd output_map(const std::vector<data::Channel>& outputs, const ComparisonFrame& frame) {
  const auto p_BC = kinematics::mass_center(frame.machine, frame.X_BP);
  spatial::Matrix6 point = spatial::Matrix6::Identity();  // motion of Q from that of C
  point.topRightCorner<3, 3>() = -spatial::skew(frame.p_BQ - p_BC);
  const auto J =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(frame.machine, frame.X_BP), p_BC);
  MatrixXd map = MatrixXd::Constant(static_cast<Index>(outputs.size()), 6,
                                    std::numeric_limits<double>::quiet_NaN());
  const bool one_point = points_of(outputs).size() == 1;
  for (Index o = 0; o < map.rows(); ++o) {
    const auto& channel = outputs[static_cast<std::size_t>(o)];
    const int code = static_cast<int>(channel.direction);
    constexpr int first_leg = static_cast<int>(data::Direction::leg1);
    const bool turns = std::abs(code) > 3;
    if (code >= first_leg) {
      if (channel.unit.starts_with("m")) map.row(o) = J.row(code - first_leg);
    } else if (code != 0 && is_angle(channel) == turns && one_point) {
      map.row(o) = (code < 0 ? -1.0 : 1.0) * point.row(std::abs(code) - 1);
    }
  }
  return map;
}

ModeComparison compare_modes(const data::ModalResults& found, std::vector<ObservedMode> model,
                             const ComparisonFrame& frame, double highest_damping,
                             const ObservationOptions& options) {
  ModeComparison result{.model = std::move(model)};
  const Comparable some = comparable(found.outputs, frame);
  result.outputs = some.outputs;
  const Shapes shapes = shapes_of(found, result.model, some, frame);
  const auto costs = pair_costs(found, shapes, highest_damping, options, result);
  const auto partner = numerics::assign(costs.cost);
  std::vector<bool> taken(result.model.size(), false);
  for (std::size_t r = 0; r < partner.size(); ++r) {
    const auto m = static_cast<std::size_t>(partner[r]);
    if (m >= result.model.size()) {
      result.measured_left.push_back(static_cast<int>(r));
      continue;
    }
    taken[m] = true;
    const auto& one = found.modes[r];
    const auto& mode = result.model[m];
    ModePair pair{.measured = static_cast<int>(r),
                  .model = partner[r],
                  .frequency_difference = one.omega() / mode.omega() - 1.0,
                  .damping_difference = one.damping_ratio() / mode.damping_ratio() - 1.0};
    if (costs.shown.size() > 0) pair.mac = costs.shown(static_cast<Index>(r), partner[r]);
    result.pairs.push_back(pair);
  }
  list_left(found, highest_damping, shapes, taken, result);
  return result;
}

}  // namespace hydrapod::observation
