#include "hydrapod/simulation/capability.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::simulation {

namespace {

using hydraulics::ServoAxis;
using model::leg_count;
using spatial::Matrix3;
using spatial::Matrix6;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Where the residual, which falls from `low` to `high`, is zero.
template <class Residual>
double root(double low, double high, Residual residual) {
  constexpr int halvings = 80;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (residual(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Steady motion with the spool at `x`: flows, leakage, friction and load in balance.
class OpenValve {
 public:
  OpenValve(const ServoAxis& axis, const model::Supply& supply, double force, double x)
      : axis_(axis), supply_(supply), force_(force), x_(x) {
    const double flow = 4.0 * axis.valve.gain * std::sqrt(supply.pressure);
    fastest_ = flow / std::min(axis.area.piston, axis.area.annulus);
  }

  [[nodiscard]] double speed() const {
    const double vapour = axis_.oil.cavitation_pressure;
    // more pressure on the rod side lets less oil in and more out
    const double p_rod =
        root(0.0, 4.0 * supply_.pressure, [&](double p) { return rod_balance(p); });
    if (p_rod < vapour) return cap_speed(vapour);  // the rod side is not filled any more
    const double v = cap_speed(p_rod);
    if (p_cap(v, p_rod) >= vapour) return v;
    return root(-fastest_, fastest_, [&](double at) {  // nor is the cap side
      const double p = p_rod_under(vapour, at);
      const auto flows = flows_at(vapour, p);
      return -(axis_.area.annulus * at + flows.rod + leakage(vapour, p) - rod_leakage(p));
    });
  }

 private:
  [[nodiscard]] double friction(double v) const {
    return hydraulics::smooth_friction(axis_.friction, v);
  }
  [[nodiscard]] double air() const {
    return hydraulics::atmospheric_pressure * (axis_.area.piston - axis_.area.annulus);
  }
  [[nodiscard]] double p_cap(double v, double p_rod) const {
    return (force_ + friction(v) + air() + p_rod * axis_.area.annulus) / axis_.area.piston;
  }
  [[nodiscard]] double p_rod_under(double p_cap, double v) const {
    return (p_cap * axis_.area.piston - air() - force_ - friction(v)) / axis_.area.annulus;
  }
  [[nodiscard]] hydraulics::PortFlows flows_at(double p_cap, double p_rod) const {
    return hydraulics::valve_flows(axis_.valve, x_,
                                   {supply_.pressure, supply_.return_pressure, p_cap, p_rod});
  }
  [[nodiscard]] double leakage(double p_cap, double p_rod) const {
    return axis_.internal_leakage * (p_cap - p_rod);
  }
  [[nodiscard]] double rod_leakage(double p) const {
    return axis_.external_leakage * (p - hydraulics::atmospheric_pressure);
  }

  /// Speed that the cap side's flow allows; it falls as friction raises the pressure there.
  [[nodiscard]] double cap_speed(double p_rod) const {
    return root(-fastest_, fastest_, [&](double v) {
      const double p = p_cap(v, p_rod);
      return flows_at(p, p_rod).cap - leakage(p, p_rod) -
             axis_.external_leakage * (p - hydraulics::atmospheric_pressure) -
             axis_.area.piston * v;
    });
  }

  [[nodiscard]] double rod_balance(double p_rod) const {
    const double v = cap_speed(p_rod), p = p_cap(v, p_rod);
    return flows_at(p, p_rod).rod + leakage(p, p_rod) - rod_leakage(p_rod) + axis_.area.annulus * v;
  }

  const ServoAxis& axis_;
  const model::Supply& supply_;
  double force_, x_, fastest_{};
};

/// Rate of the oil's force at rest with the spool at `x` [N/s].
double force_rate(const model::Leg& leg, const ServoAxis& axis, const model::Supply& supply,
                  const hydraulics::HydraulicRest& rest, double piston, double x) {
  const auto flows = hydraulics::valve_flows(
      axis.valve, x, {supply.pressure, supply.return_pressure, rest.p_cap, rest.p_rod});
  const double across = axis.internal_leakage * (rest.p_cap - rest.p_rod);
  const auto out = [&](double p) {
    return axis.external_leakage * (p - hydraulics::atmospheric_pressure);
  };
  const auto volume = axis.volumes(piston);
  const double cap_give = volume.cap * hydraulics::compressibility(axis.oil, rest.p_cap);
  const double rod_give = volume.rod * hydraulics::compressibility(axis.oil, rest.p_rod);
  const double A_p = axis.area.piston, A_r = axis.area.annulus;
  const double rate = A_p * (flows.cap - across - out(rest.p_cap)) / cap_give -
                      A_r * (flows.rod + across - out(rest.p_rod)) / rod_give;
  if (!leg.gimbal_stiffness) return rate;
  return rate / (1.0 + (A_p * A_p / cap_give + A_r * A_r / rod_give) / *leg.gimbal_stiffness);
}

/// What the legs do per unit of a motion, and how far that may go on either side of rest.
struct Range {
  double low{}, high{};  ///< ≤ 0 and ≥ 0
  Limit at_low{}, at_high{};
};

Reach reach_within(const Vector6& per_unit, const std::array<Range, leg_count>& ranges, int sign) {
  Reach reach{.value = infinite};
  for (int i = 0; i < leg_count; ++i) {
    const double rate = sign == 0 ? per_unit[i] : -per_unit[i];
    if (rate == 0.0) continue;
    const auto& range = ranges[static_cast<std::size_t>(i)];
    const double value = (rate > 0.0 ? range.high : range.low) / rate;
    if (value < reach.value) reach = {value, rate > 0.0 ? range.at_high : range.at_low, i};
  }
  return reach;
}

/// Calls `see` with the motion of every combination of signs at the limits.
template <class See>
void for_all_signs(const std::array<std::array<Reach, 2>, 6>& reach, See see) {
  for (unsigned signs = 0; signs < 64; ++signs) {
    Vector6 motion;
    for (int d = 0; d < 6; ++d) {
      const auto sign = signs >> static_cast<unsigned>(d) & 1U;
      const double value = reach[static_cast<std::size_t>(d)][sign].value;
      motion[d] = sign == 0 ? value : -value;
    }
    see(motion);
  }
}

/// Share of `reach` that is there in all directions at once; columns of `per_unit` by direction.
double combined_share(const Matrix6& per_unit, const std::array<Range, leg_count>& ranges,
                      const std::array<std::array<Reach, 2>, 6>& reach) {
  double share = 1.0;
  for_all_signs(reach, [&](const Vector6& motion) {
    const Vector6 rates = per_unit * motion;
    for (int i = 0; i < leg_count; ++i) {
      const auto& range = ranges[static_cast<std::size_t>(i)];
      if (rates[i] != 0.0)
        share = std::min(share, (rates[i] > 0.0 ? range.high : range.low) / rates[i]);
    }
  });
  return share;
}

Pose moved(const Pose& X_BP, int direction, double by) {
  Pose X = X_BP;
  if (direction < 3) {
    X.p_BP[direction] += by;
  } else {
    X.R_BP = spatial::rotation_from_rpy(by * spatial::Vector3::Unit(direction - 3)) * X_BP.R_BP;
  }
  return X;
}

/// Looks along one direction for the first limit of the workspace.
class Excursion {
 public:
  Excursion(const model::Machine& machine, const std::array<ServoAxis, leg_count>& axes,
            const Pose& X_BP)
      : machine_(machine), axes_(axes), X_BP_(X_BP) {}

  [[nodiscard]] Reach find(int direction, int sign) const {
    const double size = kinematics::pose_quality(machine_, X_BP_).characteristic_length;
    constexpr int steps = 400;
    const double step = (direction < 3 ? 4.0 * size : std::numbers::pi) / steps;
    const double unit = sign == 0 ? 1.0 : -1.0;
    double last = 0.0;
    for (int k = 1; k <= steps; ++k) {
      if (!beyond(moved(X_BP_, direction, unit * step * k))) {
        last = step * k;
        continue;
      }
      const double value = root(last, step * k, [&](double by) {
        return beyond(moved(X_BP_, direction, unit * by)) ? -1.0 : 1.0;
      });
      auto reach = *beyond(moved(X_BP_, direction, unit * step * k));
      // of several, the one that is met first
      if (const auto first =
              beyond(moved(X_BP_, direction, unit * value * (1.0 + 1e-9) + unit * 1e-12)))
        reach = *first;
      reach.value = value;
      return reach;
    }
    return {.value = last, .limit = Limit::range};
  }

 private:
  [[nodiscard]] std::optional<Reach> beyond(const Pose& X) const {
    const auto lengths = kinematics::leg_lengths(machine_, X);
    for (int i = 0; i < leg_count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double s = lengths[i] - machine_.legs[at].rod.length;
      if (s > axes_[at].stops.high) return Reach{.limit = Limit::stroke_out, .leg = i};
      if (s < axes_[at].stops.low) return Reach{.limit = Limit::stroke_in, .leg = i};
    }
    const auto angles = kinematics::joint_angles(machine_, X);
    for (int i = 0; i < leg_count; ++i) {
      const auto& limits = machine_.legs[static_cast<std::size_t>(i)].joint_limits;
      const auto& at = angles[static_cast<std::size_t>(i)];
      if (limits.base && at.base_tilt > *limits.base)
        return Reach{.limit = Limit::base_joint, .leg = i};
      if (limits.platform && at.platform_tilt > *limits.platform)
        return Reach{.limit = Limit::platform_joint, .leg = i};
    }
    if (kinematics::is_singular(machine_, X))
      return Reach{.limit = Limit::singular};
    return {};
  }

  const model::Machine& machine_;
  const std::array<ServoAxis, leg_count>& axes_;
  Pose X_BP_;
};

/// What the pump can give for good, and what motions of the legs draw.
class PumpFlow {
 public:
  PumpFlow(const model::Supply& supply, const std::array<ServoAxis, leg_count>& axes,
           const std::array<hydraulics::HydraulicRest, leg_count>& rests)
      : axes_(axes), left_(supply.pump_flow.value_or(infinite)) {
    for (std::size_t i = 0; i < leg_count; ++i)
      left_ -= hydraulics::valve_flows(
                   axes[i].valve, rests[i].spool,
                   {supply.pressure, supply.return_pressure, rests[i].p_cap, rests[i].p_rod})
                   .supply;
  }

  /// How many times it can feed these speeds.
  [[nodiscard]] double share(const Vector6& speeds) const {
    double drawn = 0.0;
    for (int i = 0; i < leg_count; ++i) {
      const auto& area = axes_[static_cast<std::size_t>(i)].area;
      drawn += speeds[i] > 0.0 ? speeds[i] * area.piston : -speeds[i] * area.annulus;
    }
    return std::max(0.0, left_) / drawn;
  }

 private:
  const std::array<ServoAxis, leg_count>& axes_;
  double left_{};
};

/// The gain at which the position loop of this controller begins to grow, its integral and damping
/// feedback switched off: a bracket around 2 ζ ω of the least damped oil mode, halved.
std::optional<double> gain_limit(const model::Machine& machine, const Pose& X_BP,
                                 dynamics::ModelKind kind) {
  constexpr double felt = 0.05;      // participation of the platform
  constexpr double drift = 1e-3;     // of the fastest pole that is felt: below, the legs leak
  constexpr double accuracy = 1e-3;  // far beyond what damping is known to
  const auto is_felt = [&](const SystemPole& pole) {
    double platform = 0.0;
    for (std::size_t d = 0; d < 6; ++d) platform += pole.parts[d];
    return pole.oscillates() && platform >= felt;
  };
  const auto open =
      system_poles(linear_system(machine, X_BP, {.kind = kind, .closed = false, .sampled = false}));
  double fastest = 0.0, estimate = infinite;
  for (const auto& pole : open.poles)
    if (is_felt(pole)) fastest = std::max(fastest, pole.omega);
  for (const auto& pole : open.poles)
    if (is_felt(pole) && pole.omega > drift * fastest)
      estimate = std::min(estimate, -2.0 * pole.pole.real());
  if (!(estimate > 0.0) || estimate == infinite) return {};

  auto parameters = tune_controller(machine, X_BP).parameters;
  parameters.feedback = model::DampingFeedback::none;
  parameters.integral_time = 0.0;
  const auto holds = [&](double gain) {
    parameters.gain.setConstant(gain);
    return system_poles(linear_system(machine, X_BP,
                                      {.kind = kind, .sampled = false, .controller = &parameters}))
        .stable;
  };
  constexpr double wide = 8.0;
  double low = estimate / wide, high = estimate * wide;
  if (!holds(low) || holds(high)) return {};
  while (high > low * (1.0 + accuracy)) {
    const double middle = std::sqrt(low * high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

const char* name(Ability ability) {
  constexpr std::array names{"force", "velocity", "acceleration", "jerk", "excursion"};
  return names.at(static_cast<std::size_t>(ability));
}

const char* name(Limit limit) {
  constexpr std::array names{"push",       "pull",           "column",     "extending",
                             "retracting", "pump",           "stroke_out", "stroke_in",
                             "base_joint", "platform_joint", "singular",   "range"};
  static_assert(names.size() == limit_count);
  return names.at(static_cast<std::size_t>(limit));
}

double open_valve_speed(const ServoAxis& axis, const model::Supply& supply, double force,
                        bool extending) {
  return OpenValve(axis, supply, force, extending ? 1.0 : -1.0).speed();
}

std::optional<Capability> capability(const model::Machine& machine, const Pose& X_BP,
                                     dynamics::ModelKind kind, bool with_gain) {
  const auto statics = dynamics::static_equilibrium(machine, X_BP, kind);
  if (statics.status != dynamics::StaticsStatus::converged) return {};
  Capability result;
  const auto& supply = machine.hydraulics.supply;
  const auto geometry = kinematics::inverse_kinematics(machine, X_BP);
  std::array<ServoAxis, leg_count> axes;
  std::array<hydraulics::HydraulicRest, leg_count> rests;
  std::array<Range, leg_count> forces, speeds, rates;
  for (int i = 0; i < leg_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto& leg = machine.legs[at];
    auto& able = result.legs[at];
    auto& axis = axes[at] = hydraulics::servo_axis(machine, i);
    able.force = 0.0 - statics.legs[at].oil_force;
    able.push = axis.force(supply.pressure, supply.return_pressure);
    able.pull = -axis.force(supply.return_pressure, supply.pressure);
    able.column = dynamics::column_strength(leg, geometry[at].length);
    rests[at] = hydraulics::hydraulic_rest(axis, supply, able.force);
    if (!rests[at].found || (able.column && able.force > able.column->strength)) return {};
    able.extending = open_valve_speed(axis, supply, able.force, true);
    able.retracting = -open_valve_speed(axis, supply, able.force, false);
    const double piston = geometry[at].length - leg.rod.length;
    able.force_rate_out = force_rate(leg, axis, supply, rests[at], piston, 1.0);
    able.force_rate_in = -force_rate(leg, axis, supply, rests[at], piston, -1.0);
    const bool buckles = able.column && able.column->strength < able.push;
    forces[at] = {-able.pull - able.force,
                  (buckles ? able.column->strength : able.push) - able.force, Limit::pull,
                  buckles ? Limit::column : Limit::push};
    speeds[at] = {-able.retracting, able.extending, Limit::retracting, Limit::extending};
    rates[at] = {-able.force_rate_in, able.force_rate_out, Limit::retracting, Limit::extending};
  }

  model::Machine held = machine;
  held.base_mount.reset();
  held.payload_modes.clear();
  const auto rigid = dynamics::linear_model(held, X_BP, dynamics::ModelKind::rigid);
  const Matrix6 J = kinematics::leg_jacobian(geometry, kinematics::mass_center(machine, X_BP));
  const Matrix6 per_force = J.transpose().inverse();
  const Matrix6 per_acceleration = per_force * Matrix6(rigid.M);
  const Excursion excursion(machine, axes, X_BP);
  const PumpFlow pump(supply, axes, rests);
  auto& [force, velocity, acceleration, jerk, way] = result.reach;
  for (int d = 0; d < 6; ++d)
    for (int sign = 0; sign < 2; ++sign) {
      const auto i = static_cast<std::size_t>(d), s = static_cast<std::size_t>(sign);
      force[i][s] = reach_within(per_force.col(d), forces, sign);
      velocity[i][s] = reach_within(J.col(d), speeds, sign);
      if (const double fed = pump.share((sign == 0 ? 1.0 : -1.0) * J.col(d));
          fed < velocity[i][s].value)
        velocity[i][s] = {fed, Limit::pump};
      acceleration[i][s] = reach_within(per_acceleration.col(d), forces, sign);
      jerk[i][s] = reach_within(per_acceleration.col(d), rates, sign);
      way[i][s] = excursion.find(d, sign);
    }
  result.combined = {combined_share(per_force, forces, force), combined_share(J, speeds, velocity),
                     combined_share(per_acceleration, forces, acceleration),
                     combined_share(per_acceleration, rates, jerk)};
  for_all_signs(velocity, [&](const Vector6& motion) {
    result.combined[1] = std::min(result.combined[1], pump.share(J * motion));
  });
  if (with_gain) result.gain_limit = gain_limit(machine, X_BP, kind);
  return result;
}

}  // namespace hydrapod::simulation
