#include "hydrapod/comparison/compare_modes.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/identification/directions.hpp"
#include "hydrapod/kinematics/inverse.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::comparison {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double frequency_scale = 0.1;
constexpr double wrong_shape = 25.0;
constexpr double no_partner = 16.0;
constexpr double same_pole = 0.05;  // of the decay rate
constexpr double band_margin = 0.2;
constexpr double unseen = 1e-6;  // of the largest motion that the outputs see
using base::two_pi;

bool is_angle(const data::Channel& channel) { return channel.unit.starts_with("rad"); }

/// Outputs that see the platform's motion, and their weights.
struct Comparable {
  std::vector<int> outputs{};
  std::vector<bool> against_ground{};
  MatrixXd map{};  ///< weighted: outputs × 6
  VectorXd weight{};
};

Comparable comparable(const std::vector<data::Channel>& channels, const ComparisonFrame& frame) {
  const MatrixXd all = output_map(channels, frame);
  const auto& platform = frame.machine.platform;
  const double gyration = std::sqrt(platform.inertia.trace() / (3.0 * platform.mass));
  Comparable some;
  for (Index o = 0; o < all.rows(); ++o)
    if (all.row(o).allFinite()) some.outputs.push_back(static_cast<int>(o));
  const auto count = static_cast<Index>(some.outputs.size());
  some.map.resize(count, 6);
  some.weight.resize(count);
  for (Index k = 0; k < count; ++k) {
    const int o = some.outputs[static_cast<std::size_t>(k)];
    some.against_ground.push_back(
        identification::against_ground(channels[static_cast<std::size_t>(o)]));
    some.weight[k] = is_angle(channels[static_cast<std::size_t>(o)]) ? gyration : 1.0;
    some.map.row(k) = some.weight[k] * all.row(o);
  }
  return some;
}

/// Share of |a|² in the space of the columns of `space`.
double share_in(const VectorXcd& a, const MatrixXcd& space) {
  Eigen::ColPivHouseholderQR<MatrixXcd> qr(space);
  qr.setThreshold(1e-6);
  const Index rank = qr.rank();
  if (rank == 0 || a.squaredNorm() == 0.0) return 0.0;
  const MatrixXcd Q = qr.householderQ() * MatrixXcd::Identity(space.rows(), rank);
  return (Q.adjoint() * a).squaredNorm() / a.squaredNorm();
}

/// Shapes of model modes `k` and of all whose poles can hardly be told from it, unit columns.
MatrixXcd space_of(std::size_t k, const std::vector<ModelMode>& model, const MatrixXcd& shapes,
                   const std::vector<bool>& seen) {
  std::vector<Index> members{static_cast<Index>(k)};
  const double near = same_pole * std::abs(model[k].pole.real()) + 1e-6 * model[k].omega();
  for (std::size_t j = 0; j < model.size(); ++j)
    if (j != k && seen[j] && std::abs(model[j].pole - model[k].pole) <= near)
      members.push_back(static_cast<Index>(j));
  MatrixXcd space(shapes.rows(), static_cast<Index>(members.size()));
  for (std::size_t j = 0; j < members.size(); ++j)
    space.col(static_cast<Index>(j)) = shapes.col(members[j]).normalized();
  return space;
}

/// Both sides on the comparable outputs.
struct Shapes {
  MatrixXcd measured{}, model{};  ///< column per mode
  std::vector<bool> seen{};       ///< model modes that the outputs see
};

Shapes shapes_of(const identification::Identification& found, const std::vector<ModelMode>& model,
                 const Comparable& some) {
  const Index rows = some.map.rows();
  Shapes shapes{MatrixXcd(rows, static_cast<Index>(found.modes.size())),
                MatrixXcd(rows, static_cast<Index>(model.size())),
                {}};
  for (std::size_t r = 0; r < found.modes.size(); ++r)
    for (Index k = 0; k < rows; ++k)
      shapes.measured(k, static_cast<Index>(r)) =
          some.weight[k] * found.modes[r].displacement[some.outputs[static_cast<std::size_t>(k)]];
  for (std::size_t m = 0; m < model.size(); ++m)
    for (Index k = 0; k < rows; ++k)
      shapes.model(k, static_cast<Index>(m)) =
          some.map.row(k).cast<std::complex<double>>() *
          (some.against_ground[static_cast<std::size_t>(k)] ? model[m].motion
                                                            : model[m].against_base);
  for (std::size_t m = 0; m < model.size(); ++m) {
    const double whole = model[m].motion.norm() * some.map.norm();
    shapes.seen.push_back(
        model[m].felt &&
        (rows == 0 || shapes.model.col(static_cast<Index>(m)).norm() > unseen * whole));
  }
  return shapes;
}

bool may_be_measured(const ModelMode& mode, const identification::Identification& found,
                     double highest_damping) {
  const double f = mode.omega() / two_pi;
  return mode.damping_ratio() <= highest_damping && f >= found.from * (1.0 - band_margin) &&
         f <= found.to * (1.0 + band_margin);
}

void list_left(const identification::Identification& found, double highest_damping,
               const Shapes& shapes, const std::vector<bool>& taken, ModeComparison& result) {
  for (std::size_t m = 0; m < result.model.size(); ++m) {
    const auto& mode = result.model[m];
    const double f = mode.omega() / two_pi;
    if (taken[m] || mode.damping_ratio() > highest_damping || f < found.from || f > found.to)
      continue;
    result.model_left.push_back({static_cast<int>(m), !mode.felt ? "the platform does not feel it"
                                                      : !shapes.seen[m]
                                                          ? "the outputs do not see it"
                                                          : "not found"});
  }
}

/// Costs of pairs, measured × (model, then a column per measured mode that stays alone).
MatrixXd pair_costs(const identification::Identification& found, const ModeComparison& result,
                    const Shapes& shapes, const MatrixXd& likeness, double highest_damping) {
  constexpr double impossible = 1e6;
  const auto measured = static_cast<Index>(found.modes.size());
  const auto models = static_cast<Index>(result.model.size());
  MatrixXd cost = MatrixXd::Constant(measured, models + measured, impossible);
  cost.rightCols(measured).setConstant(no_partner);
  for (Index m = 0; m < models; ++m) {
    const auto& mode = result.model[static_cast<std::size_t>(m)];
    if (!shapes.seen[static_cast<std::size_t>(m)] || !may_be_measured(mode, found, highest_damping))
      continue;
    for (Index r = 0; r < measured; ++r) {
      const double omega = found.modes[static_cast<std::size_t>(r)].fit.omega();
      const double apart = std::log(omega / mode.omega()) / frequency_scale;
      cost(r, m) = apart * apart;
      if (likeness.size() > 0) cost(r, m) += wrong_shape * (1.0 - likeness(r, m));
    }
  }
  return cost;
}

/// MAC of single shapes, and likeness of measured shapes with the spaces of nearly equal poles.
MatrixXd compare_shapes(const Shapes& shapes, ModeComparison& result) {
  const Index measured = shapes.measured.cols(), models = shapes.model.cols();
  MatrixXd likeness(measured, models);
  result.mac.resize(measured, models);
  for (Index m = 0; m < models; ++m) {
    const MatrixXcd space =
        space_of(static_cast<std::size_t>(m), result.model, shapes.model, shapes.seen);
    for (Index r = 0; r < measured; ++r) {
      result.mac(r, m) = identification::mac(shapes.measured.col(r), shapes.model.col(m));
      likeness(r, m) = share_in(shapes.measured.col(r), space);
    }
  }
  return likeness;
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

ModeComparison compare_modes(const identification::Identification& found,
                             std::vector<ModelMode> model, const ComparisonFrame& frame,
                             double highest_damping) {
  ModeComparison result{.model = std::move(model)};
  const Comparable some = comparable(found.responses.outputs, frame);
  result.outputs = some.outputs;
  const Shapes shapes = shapes_of(found, result.model, some);
  const MatrixXd likeness = some.outputs.empty() ? MatrixXd() : compare_shapes(shapes, result);
  const auto partner =
      observation::assign(pair_costs(found, result, shapes, likeness, highest_damping));
  std::vector<bool> taken(result.model.size(), false);
  for (std::size_t r = 0; r < partner.size(); ++r) {
    const auto m = static_cast<std::size_t>(partner[r]);
    if (m >= result.model.size()) {
      result.measured_left.push_back(static_cast<int>(r));
      continue;
    }
    taken[m] = true;
    const auto& fit = found.modes[r].fit;
    const auto& mode = result.model[m];
    ModePair pair{.measured = static_cast<int>(r),
                  .model = partner[r],
                  .frequency_difference = fit.omega() / mode.omega() - 1.0,
                  .damping_difference = fit.damping_ratio() / mode.damping_ratio() - 1.0};
    if (likeness.size() > 0) pair.mac = likeness(static_cast<Index>(r), partner[r]);
    result.pairs.push_back(pair);
  }
  list_left(found, highest_damping, shapes, taken, result);
  return result;
}

}  // namespace hydrapod::comparison
