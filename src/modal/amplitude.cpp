#include "hydrapod/modal/damped_modes.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::modal {

namespace {

using dynamics::Relaxing;
using dynamics::Vector2;
using dynamics::Vector7;
using Rows2 = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, dynamics::max_dof>;

/// Where a leg is not linear, per coordinate y.
struct LegRows {
  Rows2 chord{};         ///< offset of the rod's chord at the guide sleeve
  Rows2 ring{};          ///< offset of the piston
  ModelVector piston{};  ///< along the case
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
          .ring = rows_of(model, i, ring),
          .piston = dynamics::per_coordinate(model, i, leg.s_x)};
}

/// Stiffness of a seal in series with what bends.
Eigen::Matrix2d in_series(const Eigen::Matrix2d& seal, double bending) {
  return (Eigen::Matrix2d::Identity() + bending * seal).inverse() * seal;
}

/// The guide ring where the rod's chord swings by `chord` and what bends is in series: the seal's
/// amplitude, taken along the chord's, is a share of it that falls as the ring grows stiffer.
dynamics::GuideEquivalent guide_behind(const model::GuideSleeve& sleeve, const Vector2& rest,
                                       const Vector2& chord, double k_s, double bending,
                                       Vector2& amplitude) {
  amplitude = chord;
  if (bending == 0.0) return dynamics::guide_equivalent(sleeve, rest, chord);
  const double whole = chord.norm();
  double low = 0.0, high = 1.0;
  constexpr int halvings = 40;
  for (int n = 0; n < halvings && whole > 0.0; ++n) {
    const double share = 0.5 * (low + high);
    amplitude = share * chord;
    const auto guide = dynamics::guide_equivalent(sleeve, rest, amplitude);
    const Vector2 force = k_s * amplitude + guide.stiffness * amplitude;
    (amplitude.norm() + bending * force.norm() < whole ? low : high) = share;
  }
  return dynamics::guide_equivalent(sleeve, rest, amplitude);
}

/// The linear model with the springs and dampers that stand for its legs at their amplitudes.
class Swinging {
 public:
  Swinging(const model::Machine& machine, const spatial::Pose& X_BP, dynamics::ModelKind kind)
      : machine_(dynamics::with_pressed_seals(machine, kind, X_BP)),
        linear_(dynamics::linear_model(machine_, X_BP, kind)),
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
    Vector2 amplitude;
    const auto guide = guide_behind(sleeve, leg.sleeve_offset, rows_[k].chord * y, leg.k_s,
                                    leg.bending, amplitude);
    point.sleeve = std::max(point.sleeve, amplitude.norm());
    if (sleeve.elastomer) left = dynamics::softened(*sleeve.elastomer, amplitude.norm());
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
        hydraulics::friction_equivalent(friction, std::max(amplitude, least), omega);
    model.K += equivalent.stiffness * rows_[k].piston * rows_[k].piston.transpose();
    model.C += equivalent.damping * rows_[k].piston * rows_[k].piston.transpose();
  }

  model::Machine machine_;
  LinearModel linear_;
  NormalModes modes_;
  std::array<LegRows, model::leg_count> rows_{};
  std::array<hydraulics::Friction, model::leg_count> friction_{};
};

/// What of a motion vibrates as one.
struct Vibration {
  ModelVector shape{};  ///< φᵀ M φ = 1
  double omega2{};
};

/// The mode most like the motion `y`, with those that hardly differ in frequency: any combination
/// of these vibrates nearly as one, and which of them is a mode is decided by next to nothing.
Vibration vibration_in(const NormalModes& modes, const ModelMatrix& M, const ModelMatrix& K,
                       const ModelVector& y) {
  constexpr double together = 1e-3;  // of ω²
  const ModelVector momentum = M * y;
  const ModelVector parts = modes.shapes.transpose() * momentum;
  Eigen::Index best = 0;
  parts.cwiseAbs().maxCoeff(&best);
  ModelVector shape = ModelVector::Zero(y.size());
  for (Eigen::Index k = 0; k < parts.size(); ++k)
    if (std::abs(modes.omega2[k] - modes.omega2[best]) <= together * std::abs(modes.omega2[best]))
      shape += parts[k] * modes.shapes.col(k);
  const double size = shape.dot(M * shape);
  Vibration result{.shape = shape / std::sqrt(size)};
  result.omega2 = result.shape.dot(K * result.shape);
  return result;
}

/// One mode on its way from amplitude to amplitude.
class Follower {
 public:
  Follower(const Swinging& swinging, const AmplitudeOptions& options, int mode)
      : swinging_(swinging),
        options_(options),
        first_(swinging.modes().shapes.col(mode)),
        y_(first_),
        omega_(swinging.modes().omega(mode)) {}

  /// Begins at a small amplitude. 0 where there is no balance, else ω there.
  double begin(double amplitude) {
    ModeAtAmplitude point;
    return step_to(amplitude, point) ? omega_ : 0.0;
  }

  /// To the amplitude of `point`. False where the mode is lost or the iteration does not end. The
  /// steps are as long as the shape stays like that of the step before.
  bool to(ModeAtAmplitude& point) {
    const double wanted = point.amplitude;
    constexpr double shortest = 1.003;  // ratio of two amplitudes
    double ratio = options_.largest_ratio;
    while (amplitude_ < wanted) {
      if (step_to(std::min(amplitude_ * ratio, wanted), point)) {
        ratio = std::min(ratio * ratio, options_.largest_ratio);
      } else if (ratio = std::sqrt(ratio); ratio < shortest) {
        return false;
      }
    }
    return true;
  }

 private:
  /// True where the balance at `amplitude` has a shape like the present one; else nothing changes.
  bool step_to(double amplitude, ModeAtAmplitude& point) {
    const auto& M = swinging_.linear().M;
    const ModelVector before = y_;
    const double omega = omega_, from = std::exchange(amplitude_, amplitude);
    if (balance(point)) {
      const ModelVector momentum = M * before;
      const double mac = std::pow(point.shape.dot(momentum), 2) / before.dot(momentum);
      if (mac >= options_.least_mac) return true;
    }
    y_ = before;
    omega_ = omega;
    amplitude_ = from;
    return false;
  }

  /// Fixed point y = the mode at y, scaled, by Anderson's acceleration (Walker & Ni, SIAM J. Numer.
  /// Anal. 49 (2011) 1715): near the edge of a gap the change itself would jump to and fro.
  bool balance(ModeAtAmplitude& point) {
    const auto& M = swinging_.linear().M;
    constexpr double share = 0.3;  // of the residual
    constexpr Eigen::Index memory = 6;
    const Eigen::VectorXd weight = M.diagonal().cwiseSqrt();
    Eigen::MatrixXd dy(y_.size(), 0), dr(y_.size(), 0);
    Eigen::VectorXd y_before, r_before;
    y_ = swinging_.scaled(y_, amplitude_);
    for (int k = 0; k < options_.most_iterations; ++k) {
      const auto model = swinging_.at(y_, omega_, point);
      const auto modes = normal_modes(model);
      const auto found = vibration_in(modes, M, model.K, y_);
      if (!(found.omega2 > 0.0)) return false;
      const double omega = std::sqrt(found.omega2), change = std::abs(omega - omega_);
      omega_ = omega;
      const ModelVector residual = swinging_.scaled(found.shape, amplitude_) - y_;
      const double size = y_.dot(M * y_), left = residual.dot(M * residual);
      if (change <= options_.tolerance * omega_ && left <= options_.tolerance * size) {
        finish(model, found.shape, point);
        return true;
      }
      const Eigen::VectorXd y = weight.cwiseProduct(Eigen::VectorXd(y_));
      const Eigen::VectorXd r = weight.cwiseProduct(Eigen::VectorXd(residual));
      if (k > 0) {
        append(y - y_before, memory, dy);
        append(r - r_before, memory, dr);
      }
      y_before = y;
      r_before = r;
      Eigen::VectorXd next = y + share * r;
      if (dr.cols() > 0) next -= (dy + share * dr) * dr.colPivHouseholderQr().solve(r);
      y_ = next.cwiseQuotient(weight);
    }
    return false;
  }

  /// `column` as the last of at most `most`.
  static void append(const Eigen::VectorXd& column, Eigen::Index most, Eigen::MatrixXd& columns) {
    if (columns.cols() == most) columns = columns.rightCols(most - 1).eval();
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols<1>() = column;
  }

  void finish(const LinearModel& model, const ModelVector& shape, ModeAtAmplitude& point) const {
    const auto& M = swinging_.linear().M;
    point.shape = shape;
    point.omega = omega_;
    point.damping_ratio = swinging_.damping_ratio(model, shape, omega_);
    point.mac = std::pow(first_.dot(M * shape), 2) / shape.dot(M * shape);
    point.converged = true;
  }

  const Swinging& swinging_;
  const AmplitudeOptions& options_;
  ModelVector first_, y_;
  double omega_, amplitude_{};
};

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
  constexpr double small = 1e-3;  // of the first amplitude: where the way begins
  std::vector<AmplitudeCurve> curves;
  for (int k = 0; k < modes.size(); ++k) {
    const auto& energy = shares[static_cast<std::size_t>(k)];
    if (energy.platform.sum() < options.least_platform || !(modes.omega2[k] > 0.0)) continue;
    Follower follower(swinging, options, k);
    AmplitudeCurve curve{.mode = k, .omega = follower.begin(small * amplitudes.front())};
    energy.platform.maxCoeff(&curve.direction);
    for (const double amplitude : amplitudes) {
      ModeAtAmplitude point{.amplitude = amplitude};
      const bool found = curve.omega > 0.0 && follower.to(point);
      if (!found) point = {.amplitude = amplitude};
      curve.points.push_back(point);
      if (!found) break;
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace hydrapod::modal
