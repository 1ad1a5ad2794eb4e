#include "hydrapod/dynamics/linear_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"

namespace hydrapod::dynamics {

namespace {

/// The machine with growing load; follows the equilibrium from one stable load to the next, so that
/// no other branch (legs folded the other way) is taken for it.
class LoadPath {
 public:
  LoadPath(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind)
      : of_file_(machine), machine_(machine), X_BP_(X_BP), kind_(kind) {
    // where the supply holds no more is no buckling: the oil springs of the file carry any load
    machine_.damping.oil = model::OilDamping::viscous;
  }

  /// True when it stands stably with this platform mass: an equilibrium, and K positive definite.
  bool stands(double mass) {
    machine_.platform.mass = mass;
    // What swings grows with the platform, up to what the file says.
    const double share = std::min(1.0, mass / of_file_.platform.mass);
    for (std::size_t k = 0; k < machine_.payload_modes.size(); ++k) {
      const auto& whole = of_file_.payload_modes[k];
      auto& mode = machine_.payload_modes[k];
      if (whole.mass) mode.mass = share * *whole.mass;
      if (whole.participation) mode.participation = std::sqrt(share) * *whole.participation;
      mode.participation_moment = std::sqrt(share) * whole.participation_moment;
    }
    try {
      const auto model = linear_model(machine_, X_BP_, kind_, on_path_ ? &last_ : nullptr);
      const double lowest = lowest_stiffness(model);
      if (!(lowest > 0.0)) return false;
      if (!on_path_) unloaded_ = lowest;
      loaded_ = lowest;
      last_ = model.statics;
      on_path_ = true;
      return true;
    } catch (const base::ComputationError&) {
      return false;  // no equilibrium near the last one
    }
  }

  /// True when the stiffness was not about to vanish at the last load that stood.
  [[nodiscard]] bool ends_at_limit_point() const {
    constexpr double vanishing =
        1e-3;  // far above what the bisection leaves of a mode that goes to zero
    return loaded_ > vanishing * unloaded_;
  }
  [[nodiscard]] const StaticEquilibrium& last() const { return last_; }

 private:
  const model::Machine& of_file_;
  model::Machine machine_;
  spatial::Pose X_BP_;
  ModelKind kind_;
  StaticEquilibrium last_{};
  double unloaded_{},
      loaded_{};  ///< lowest stiffness without load, and at the last load that stood
  bool on_path_{};

  /// Smallest eigenvalue of K in the masses' metric, ω² of the lowest mode.
  static double lowest_stiffness(const LinearModel& model) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<ModelMatrix>(slow_stiffness(model), model.M,
                                                                 Eigen::EigenvaluesOnly)
        .eigenvalues()[0];
  }
};

}  // namespace

Buckling buckling_payload(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                          const BucklingOptions& options) {
  if (machine.gravity.isZero(0.0)) return {};
  LoadPath path(machine, X_BP, kind);
  const double mass = machine.platform.mass;
  // From next to nothing upwards: small steps, so that no narrow unstable range is stepped over.
  constexpr int steps_to_now = 50;
  constexpr double next_to_nothing =
      1e-3;  // of the mass; nothing at all has no scale to converge by
  double low = next_to_nothing * mass, high = mass / steps_to_now;
  if (!path.stands(low)) return {.status = BucklingStatus::buckled, .payload = -mass};
  while (path.stands(high)) {
    low = high;
    high += std::max(mass / steps_to_now, 0.02 * high);
    if (high > options.largest_factor * mass) return {};
  }
  while (high - low > options.tolerance * high) {
    const double middle = 0.5 * (low + high);
    (path.stands(middle) ? low : high) = middle;
  }
  const double payload = 0.5 * (low + high) - mass;
  return {payload < 0.0 ? BucklingStatus::buckled : BucklingStatus::found, payload,
          path.ends_at_limit_point(), path.last()};
}

}  // namespace hydrapod::dynamics
