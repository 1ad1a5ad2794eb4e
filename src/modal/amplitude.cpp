#include "hydrapod/modal/amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hydrapod/dynamics/equivalent.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/modal/mode_table.hpp"

namespace hydrapod::modal {

namespace {

using dynamics::Relaxing;
using dynamics::Vector2;
using dynamics::Vector7;
using Rows2 = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, dynamics::max_dof>;

/// Where a leg is not linear, per coordinate y.
struct LegRows {
  Rows2 chord{};        ///< offset of the rod's chord at the guide sleeve
  Rows2 seal{};         ///< of the rod at the seal; the chord's where nothing bends
  Rows2 ring{};         ///< offset of the piston
  ModelVector piston{}; ///< along the case
};

Rows2 rows_of(const LinearModel& model, int leg,
              const Eigen::Matrix<double, 2, dynamics::leg_coordinates>& per_x) {
  Rows2 rows(2, model.dof());
  for (int k = 0; k < 2; ++k) rows.row(k) = dynamics::per_coordinate(model, leg, per_x.row(k));
  return rows;
}

LegRows leg_rows(const LinearModel& model, int i) {
  const auto& leg = model.legs[static_cast<std::size_t>(i)];
  Eigen::Matrix<double, 2, dynamics::leg_coordinates> ring;
  ring.setZero();
  ring(0, 5) = ring(1, 6) = 1.0;
  return {.chord = rows_of(model, i, leg.d_x + leg.bending * leg.F_x),
          .seal = rows_of(model, i, leg.d_x),
          .ring = rows_of(model, i, ring),
          .piston = dynamics::per_coordinate(model, i, leg.s_x)};
}

/// Stiffness of a seal in series with what bends.
Eigen::Matrix2d in_series(const Eigen::Matrix2d& seal, double bending) {
  return (Eigen::Matrix2d::Identity() + bending * seal).inverse() * seal;
}

/// The linear model with the springs and dampers that stand for its legs at their amplitudes.
class Swinging {
 public:
  Swinging(const model::Machine& machine, const spatial::Pose& X_BP, dynamics::ModelKind kind)
      : machine_(machine),
        linear_(dynamics::linear_model(machine, X_BP, kind)),
        modes_(normal_modes(linear_)) {
    for (int i = 0; i < model::leg_count; ++i) {
      rows_[static_cast<std::size_t>(i)] = leg_rows(linear_, i);
      friction_[static_cast<std::size_t>(i)] = hydraulics::servo_axis(machine, i).friction;
    }
  }

  [[nodiscard]] const LinearModel& linear() const { return linear_; }
  [[nodiscard]] const NormalModes& modes() const { return modes_; }

  /// `shape` scaled to the amplitude of the platform joint that moves most.
  [[nodiscard]] ModelVector scaled(const ModelVector& shape, double amplitude) const {
    double largest = 0.0;
    for (const auto& J : linear_.J)
      largest = std::max(largest, (J * (linear_.against_base * shape)).norm());
    return shape * (amplitude / largest);
  }

  /// The model at the motion `y` and ω; what is said of the legs into `point`.
  LinearModel at(const ModelVector& y, double omega, ModeAtAmplitude& point) const {
    LinearModel model = linear_;
    point.sleeve = point.piston = 0.0;
    point.legs_on_guide = 0;
    std::array<double, model::leg_count> of_sleeve, of_ring;  // what softening leaves
    for (int i = 0; i < model::leg_count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      add_sleeve(i, y, of_sleeve[k], point, model);
      add_ring(i, y, of_ring[k], model);
      add_friction(i, y, omega, point, model);
    }
    for (const auto& arm : linear_.arms) {
      const auto k = static_cast<std::size_t>(arm.leg);
      const double left = arm.what == Relaxing::sleeve ? of_sleeve[k]
                          : arm.what == Relaxing::ring ? of_ring[k]
                                                       : 1.0;
      model.K -= left * softening_at(arm, omega) * arm.s_y * arm.s_y.transpose();
      model.C += left * damper_at(arm, omega) * arm.s_y * arm.s_y.transpose();
    }
    return model;
  }

  /// ζ of a shape at ω.
  [[nodiscard]] double damping_ratio(const LinearModel& model, const ModelVector& phi,
                                     double omega) const {
    return model::modal_ratio(machine_).value + phi.dot(model.C * phi) / (2.0 * omega);
  }

 private:
  /// Guide ring and softened seal in place of what the linear model has.
  void add_sleeve(int i, const ModelVector& y, double& left, ModeAtAmplitude& point,
                  LinearModel& model) const {
    left = 1.0;
    if (linear_.kind == dynamics::ModelKind::rigid) return;
    const auto k = static_cast<std::size_t>(i);
    const auto& leg = linear_.legs[k];
    const auto& sleeve = machine_.legs[k].guide_sleeve;
    const Vector2 amplitude = rows_[k].seal * y;
    point.sleeve = std::max(point.sleeve, amplitude.norm());
    if (sleeve.elastomer) left = dynamics::softened(*sleeve.elastomer, amplitude.norm());
    const auto guide = dynamics::guide_equivalent(sleeve, leg.sleeve_offset, amplitude);
    if (guide.touches) ++point.legs_on_guide;
    if (!sleeve.gap && left == 1.0) return;
    const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d before =
        (leg.k_s + leg.k_contact) * one + leg.contact_root * leg.contact_root.transpose();
    const Eigen::Matrix2d now = left * leg.k_s * one + guide.stiffness;
    const Eigen::Matrix2d change = in_series(now, leg.bending) - in_series(before, leg.bending);
    model.K += rows_[k].chord.transpose() * change * rows_[k].chord;
  }

  void add_ring(int i, const ModelVector& y, double& left, LinearModel& model) const {
    left = 1.0;
    if (linear_.kind != dynamics::ModelKind::full) return;
    const auto k = static_cast<std::size_t>(i);
    const auto& ring = *machine_.legs[k].piston_ring;
    if (!ring.elastomer) return;
    const Vector2 amplitude = rows_[k].ring * y;
    left = dynamics::softened(*ring.elastomer, amplitude.norm());
    model.K -= (1.0 - left) * linear_.legs[k].k_g * rows_[k].ring.transpose() * rows_[k].ring;
  }

  void add_friction(int i, const ModelVector& y, double omega, ModeAtAmplitude& point,
                    LinearModel& model) const {
    const auto k = static_cast<std::size_t>(i);
    const auto& friction = friction_[k];
    const double amplitude = std::abs(rows_[k].piston.dot(y));
    point.piston = std::max(point.piston, amplitude);
    // A motion of less than atoms: the limit of bristles that only stick.
    constexpr double least = 1e-12;
    if (friction.breakaway == 0.0) return;
    const auto equivalent =
        dynamics::friction_equivalent(friction, std::max(amplitude, least), omega);
    model.K += equivalent.stiffness * rows_[k].piston * rows_[k].piston.transpose();
    model.C += equivalent.damping * rows_[k].piston * rows_[k].piston.transpose();
  }

  model::Machine machine_;
  LinearModel linear_;
  NormalModes modes_;
  std::array<LegRows, model::leg_count> rows_{};
  std::array<hydraulics::Friction, model::leg_count> friction_{};
};

/// The mode of `modes` most like `shape`, and its MAC in the metric of M.
std::pair<int, double> most_like(const NormalModes& modes, const ModelMatrix& M,
                                 const ModelVector& shape) {
  const ModelVector momentum = M * shape;
  const Eigen::VectorXd mac =
      (modes.shapes.transpose() * momentum).cwiseAbs2() / shape.dot(momentum);
  Eigen::Index best = 0;
  const double most = mac.maxCoeff(&best);
  return {static_cast<int>(best), most};
}

/// Follows one mode to the amplitude of `point`; `shape` and `omega` are where it begins and ends.
void follow(const Swinging& swinging, const AmplitudeOptions& options, ModelVector& shape,
            double& omega, ModeAtAmplitude& point) {
  const auto& M = swinging.linear().M;
  // Half of each step: a shape that jumps to and fro over the edge of a gap comes to rest.
  constexpr double share = 0.5;
  ModelVector y = swinging.scaled(shape, point.amplitude);
  for (int k = 0; k < options.most_iterations; ++k) {
    const auto model = swinging.at(y, omega, point);
    const auto modes = normal_modes(model);
    const auto [mode, mac] = most_like(modes, M, y);
    if (mac < options.least_mac || !(modes.omega2[mode] > 0.0)) return;
    ModelVector found = modes.shapes.col(mode);
    if (found.dot(M * y) < 0.0) found = -found;
    const double change = std::abs(modes.omega(mode) - omega);
    omega = modes.omega(mode);
    y += share * (swinging.scaled(found, point.amplitude) - y);
    y = swinging.scaled(y, point.amplitude);
    if (change > options.tolerance * omega) continue;
    shape = point.shape = found;
    point.omega = omega;
    point.damping_ratio = swinging.damping_ratio(model, found, omega);
    point.converged = true;
    return;
  }
}

}  // namespace

std::vector<AmplitudeCurve> modes_at_amplitudes(const model::Machine& machine,
                                                const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                                std::span<const double> amplitudes,
                                                const AmplitudeOptions& options) {
  if (amplitudes.empty() || !(amplitudes.front() > 0.0) ||
      std::ranges::adjacent_find(amplitudes, std::greater_equal{}) != amplitudes.end())
    throw std::invalid_argument("amplitudes must be above 0 and ascend");
  const Swinging swinging(machine, X_BP, kind);
  const auto& linear = swinging.linear();
  const auto& modes = swinging.modes();
  const auto shares = energy_shares(linear, modes.shapes);
  std::vector<AmplitudeCurve> curves;
  for (int k = 0; k < modes.size(); ++k) {
    const auto& energy = shares[static_cast<std::size_t>(k)];
    if (energy.platform.sum() < local_mode_energy || !(modes.omega2[k] > 0.0)) continue;
    AmplitudeCurve curve{.mode = k, .omega = modes.omega(k)};
    energy.platform.maxCoeff(&curve.direction);
    const ModelVector first = modes.shapes.col(k);
    ModelVector shape = first;
    double omega = curve.omega;
    for (const double amplitude : amplitudes) {
      ModeAtAmplitude point{.mode = k, .amplitude = amplitude};
      follow(swinging, options, shape, omega, point);
      if (point.converged)
        point.mac = std::pow(first.dot(linear.M * shape), 2) / shape.dot(linear.M * shape);
      curve.points.push_back(point);
      if (!point.converged) break;
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace hydrapod::modal
