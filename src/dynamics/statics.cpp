#include "hydrapod/dynamics/statics.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/dynamics/linear_model.hpp"
#include "statics_search.hpp"

namespace hydrapod::dynamics {

namespace {

using FlexibleMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;
using FlexibleVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;

/// One leg's answer to a change of its oil force: δ(φ, u) = constant + slope δf, and likewise λ.
struct LegResponse {
  FlexibleVector constant, slope;
  Vector3 force_constant, force_slope;  ///< λ after the step, in B
};

LegResponse leg_response(const BentLeg& leg, int flexible) {
  const Matrix3& R = leg.element.frame.R_BL;
  LegResponse response;
  response.force_constant = leg.joint_force;
  response.force_slope = R * leg.element.s_x.head<3>();
  if (flexible == 0) return response;
  const FlexibleMatrix H = leg.K_without_oil.block(3, 3, flexible, flexible);
  const Eigen::PartialPivLU<FlexibleMatrix> lu(H);
  response.constant = -lu.solve(FlexibleVector(leg.flexible_gradient.head(flexible)));
  response.slope = -lu.solve(FlexibleVector(leg.element.s_x.segment(3, flexible)));
  const auto K_af = leg.K_without_oil.block(0, 3, 3, flexible);
  response.force_constant += R * (K_af * response.constant);
  response.force_slope += R * (K_af * response.slope);
  return response;
}

Vector6 wrench(const Vector3& force, const Vector3& arm) {
  Vector6 w;
  w << force, arm.cross(force);
  return w;
}

/// The machine at one Newton iterate.
struct Iterate {
  std::array<BentLeg, model::leg_count> legs;
  bool exists{true};
  double residual{};
};

struct Problem {
  const model::Machine& machine;
  kinematics::LegGeometries geometry;
  Vector3 C;
  Vector6 platform_weight;
  double weight;
  double rounding;  ///< of the residual
  int flexible;

  Problem(const model::Machine& m, const spatial::Pose& X_BP, ModelKind kind)
      : machine(m),
        geometry(kinematics::inverse_kinematics(m, X_BP)),
        C(kinematics::mass_center(m, X_BP)),
        flexible(flexible_per_leg(kind)) {
    platform_weight << m.platform.mass * m.gravity, Vector3::Zero();
    double mass = m.platform.mass;
    for (const auto& leg : m.legs) mass += leg.cylinder_case.mass + leg.rod.mass;
    weight = std::max(mass * m.gravity.norm(), 1e-300);
    rounding = rounding_of_seal_forces() / weight;
  }

  /// Offsets at the seals are differences of lengths along the leg: they are known to some units of
  /// the last place of its length, which a stiff seal turns into a force [N].
  [[nodiscard]] double rounding_of_seal_forces() const {
    constexpr double units = 16.0 * std::numeric_limits<double>::epsilon();
    double largest = 0.0;
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& leg = machine.legs[i];
      double stiffness = leg.guide_sleeve.stiffness;
      if (leg.guide_sleeve.gap) stiffness += leg.guide_sleeve.guide_stiffness;
      if (leg.piston_ring) stiffness = std::max(stiffness, leg.piston_ring->stiffness);
      largest = std::max(largest, units * geometry[i].length * stiffness);
    }
    return largest;
  }

  [[nodiscard]] Iterate evaluate(const StaticEquilibrium& at) const {
    Iterate now;
    Vector6 balance = platform_weight;
    double worst = 0.0;
    for (int i = 0; i < model::leg_count; ++i) {
      now.legs[i] = bent_leg_without_bow_mass(machine.legs[i], geometry[i].a, machine.flexible_axes,
                                              machine.gravity, at.legs[i]);
      now.exists = now.exists && now.legs[i].exists;
      if (!now.exists) return now;
      balance -= wrench(now.legs[i].joint_force, geometry[i].a - C);
      worst =
          std::max(worst, now.legs[i].flexible_gradient.head(flexible).lpNorm<Eigen::Infinity>());
    }
    now.residual = std::max(worst, balance.lpNorm<Eigen::Infinity>()) / weight;
    return now;
  }

  [[nodiscard]] std::array<BentLeg, model::leg_count> with_bow_masses(
      const Iterate& now, const StaticEquilibrium& at) const {
    auto legs = now.legs;
    for (int i = 0; i < model::leg_count; ++i)
      if (legs[i].element.bending > 0.0)
        legs[i] = bent_leg(machine.legs[i], geometry[i].a, machine.flexible_axes, machine.gravity,
                           at.legs[i]);
    return legs;
  }

  /// Whether every piston is below its guide sleeve. Past its limit load a leg has no equilibrium
  /// near the straight one, and Newton may end at a far one, where the rod has been pulled through
  /// the seal.
  [[nodiscard]] bool guided(const Iterate& now) const {
    return flexible == 0 || std::all_of(now.legs.begin(), now.legs.end(),
                                        [](const BentLeg& leg) { return leg.element.l_mh > 0.0; });
  }

  /// One Newton step; false when the 6×6 system for the oil forces is singular.
  bool step(const Iterate& now, StaticEquilibrium& at) const {
    std::array<LegResponse, model::leg_count> responses;
    Matrix6 A;
    Vector6 b = platform_weight;
    for (int i = 0; i < model::leg_count; ++i) {
      responses[i] = leg_response(now.legs[i], flexible);
      A.col(i) = wrench(responses[i].force_slope, geometry[i].a - C);
      b -= wrench(responses[i].force_constant, geometry[i].a - C);
    }
    const Vector6 df = Eigen::PartialPivLU<Matrix6>(A).solve(b);
    if (!df.allFinite()) return false;
    for (int i = 0; i < model::leg_count; ++i) {
      at.legs[i].oil_force += df[i];
      if (flexible == 0) continue;
      FlexibleVector change = responses[i].constant + df[i] * responses[i].slope;
      constexpr double largest_tilt = 0.2;  // rad per step; offsets follow in proportion
      const double tilt = change.head<2>().norm();
      if (!(tilt < largest_tilt)) change *= largest_tilt / tilt;
      at.legs[i].flexible.head(flexible) += change;
    }
    return true;
  }
};

}  // namespace

StaticEquilibrium static_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind, const StaticsSearch& search,
                                     std::array<BentLeg, model::leg_count>& legs) {
  StaticEquilibrium at;
  if (machine.gravity.isZero(0.0)) {
    at.status = StaticsStatus::converged;
    return at;
  }
  if (search.start) at.legs = search.start->legs;
  const auto& compression = search.options.rod_compression;
  for (int i = 0; i < model::leg_count; ++i)
    at.legs[i].rod_compression = compression ? std::optional((*compression)[i]) : std::nullopt;
  const Problem problem(machine, X_BP, kind);
  double before = std::numeric_limits<double>::infinity();
  for (at.iterations = 0;; ++at.iterations, before = at.residual) {
    const Iterate now = problem.evaluate(at);
    if (!now.exists) {
      at.status = StaticsStatus::folded;
      return at;
    }
    at.residual = now.residual;
    const double tolerance =
        at.iterations > 0 ? search.tolerance_after_step : search.options.tolerance;
    // Newton halves a residual at least twice at each step, also at a limit point: what it does not
    // halve any more is rounding
    const bool ended = now.residual > 0.5 * before && now.residual <= problem.rounding;
    if (now.residual <= tolerance || ended) {
      at.status = problem.guided(now) ? StaticsStatus::converged : StaticsStatus::folded;
      legs = problem.with_bow_masses(now, at);
      return at;
    }
    if (at.iterations == search.options.max_iterations) return at;
    if (!problem.step(now, at)) {
      at.status = StaticsStatus::singular;
      return at;
    }
  }
}

StaticEquilibrium static_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind, const StaticsOptions& options,
                                     const StaticEquilibrium* start) {
  if (kind != ModelKind::rigid && model::has_pressed_seals(machine))
    return static_equilibrium(with_pressed_seals(machine, kind, X_BP), X_BP, kind, options, start);
  std::array<BentLeg, model::leg_count> legs;
  return static_equilibrium(machine, X_BP, kind, {.options = options, .start = start}, legs);
}

}  // namespace hydrapod::dynamics
