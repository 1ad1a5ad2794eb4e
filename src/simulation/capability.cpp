#include "hydrapod/simulation/capability.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hydrapod/base/error.hpp"
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
      : machine_(machine), axes_(axes), X_BP_(X_BP), side_(determinant(X_BP)) {}

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
    // a step may pass a singular pose
    if (kinematics::is_singular(machine_, X) || !(determinant(X) * side_ > 0.0))
      return Reach{.limit = Limit::singular};
    return {};
  }
  [[nodiscard]] double determinant(const Pose& X) const {
    return kinematics::leg_jacobian(kinematics::inverse_kinematics(machine_, X), X.p_BP)
        .determinant();
  }

  const model::Machine& machine_;
  const std::array<ServoAxis, leg_count>& axes_;
  Pose X_BP_;
  double side_;  ///< sign of the determinant where it begins
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

/// None where the loop has nothing to start from: beyond stops that the file does not state.
std::optional<double> gain_limit_if_any(const model::Machine& machine, const Pose& X_BP,
                                        dynamics::ModelKind kind) {
  try {
    return gain_limit(machine, X_BP, kind);
  } catch (const base::ComputationError&) {
    return {};
  }
}

}  // namespace

const char* name(Ability ability) {
  constexpr std::array names{"force", "velocity", "acceleration", "jerk", "excursion"};
  return names.at(static_cast<std::size_t>(ability));
}

const char* name(Limit limit) {
  constexpr std::array names{"push",     "pull",       "column",    "extending",  "retracting",
                             "pump",     "stroke_out", "stroke_in", "base_joint", "platform_joint",
                             "singular", "range",      "torque",    "motor_speed"};
  static_assert(names.size() == limit_count);
  return names.at(static_cast<std::size_t>(limit));
}

double open_valve_speed(const ServoAxis& axis, const model::Supply& supply, double force,
                        bool extending) {
  return OpenValve(axis, supply, force, extending ? 1.0 : -1.0).speed();
}

namespace {

/// Force and speed of an electric cylinder at rest under `able.force`; false where its motor does
/// not move it.
bool set_screw(const model::Screw& screw, LegAbility& able, Range& forces, Range& speeds) {
  const double turns = screw.ratio(), free = *screw.torque_limit - screw.friction_torque;
  able.push = able.pull = turns * free;
  if (std::abs(able.force) >= able.push) return false;
  forces = {-able.pull - able.force, able.push - able.force, Limit::torque, Limit::torque};
  // beside the load, viscous friction uses up the torque at a speed
  const auto fastest = [&](double load, Limit& limit) {
    const double left = free - load / turns, viscous = screw.viscous_friction;
    const bool by_torque = viscous * *screw.speed_limit > left;
    limit = by_torque ? Limit::torque : Limit::motor_speed;
    return (by_torque ? left / viscous : *screw.speed_limit) / turns;
  };
  able.extending = fastest(able.force, speeds.at_high);
  able.retracting = fastest(-able.force, speeds.at_low);
  speeds.high = able.extending;
  speeds.low = -able.retracting;
  return true;
}

/// What the legs can do about rest.
struct Abilities {
  std::array<ServoAxis, leg_count> axes{};
  std::array<Range, leg_count> forces{}, speeds{}, rates{};
  std::array<Range, leg_count> columns{};  ///< of the rods' forces
  Vector6 motors{Vector6::Zero()};         ///< along the legs, accelerated with the platform [kg]
};

/// The rod as a column under its load at rest; false where it buckles.
bool set_column(const model::Leg& leg, double length, LegAbility& able, Range& column) {
  able.column = dynamics::column_strength(leg, length);
  column = {-infinite, able.column ? able.column->strength - able.force : infinite, Limit::column,
            Limit::column};
  return column.high >= 0.0;
}

/// None: a leg cannot hold its load.
std::optional<Abilities> of_screws(const model::Machine& machine,
                                   const kinematics::LegGeometries& geometry,
                                   std::array<LegAbility, leg_count>& able) {
  Abilities legs;
  for (std::size_t i = 0; i < leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const auto& screw = *leg.screw;
    if (!screw.torque_limit || !screw.speed_limit) return {};
    if (!set_column(leg, geometry[i].length, able[i], legs.columns[i]) ||
        !set_screw(screw, able[i], legs.forces[i], legs.speeds[i]))
      return {};
    able[i].force_rate_out = able[i].force_rate_in = infinite;
    legs.rates[i] = {-infinite, infinite, Limit::torque, Limit::torque};
    legs.axes[i].stops = hydraulics::mechanical_stops(leg);
    legs.motors[static_cast<Eigen::Index>(i)] = screw.reflected_mass();
  }
  return legs;
}

std::optional<Abilities> of_cylinders(const model::Machine& machine,
                                      const kinematics::LegGeometries& geometry,
                                      std::array<LegAbility, leg_count>& abilities,
                                      std::array<hydraulics::HydraulicRest, leg_count>& rests) {
  const auto& supply = machine.hydraulics.supply;
  Abilities legs;
  for (std::size_t i = 0; i < leg_count; ++i) {
    const auto& leg = machine.legs[i];
    auto& able = abilities[i];
    auto& axis = legs.axes[i] = hydraulics::servo_axis(machine, static_cast<int>(i));
    able.push = axis.force(supply.pressure, supply.return_pressure);
    able.pull = -axis.force(supply.return_pressure, supply.pressure);
    rests[i] = hydraulics::hydraulic_rest(axis, supply, able.force);
    if (!rests[i].found || !set_column(leg, geometry[i].length, able, legs.columns[i])) return {};
    able.extending = open_valve_speed(axis, supply, able.force, true);
    able.retracting = -open_valve_speed(axis, supply, able.force, false);
    const double piston = geometry[i].length - leg.rod.length;
    able.force_rate_out = force_rate(leg, axis, supply, rests[i], piston, 1.0);
    able.force_rate_in = -force_rate(leg, axis, supply, rests[i], piston, -1.0);
    legs.forces[i] = {-able.pull - able.force, able.push - able.force, Limit::pull, Limit::push};
    legs.speeds[i] = {-able.retracting, able.extending, Limit::retracting, Limit::extending};
    legs.rates[i] = {-able.force_rate_in, able.force_rate_out, Limit::retracting, Limit::extending};
  }
  return legs;
}

/// Of the platform on such legs. Motors accelerate themselves as well: M + Jᵀ m_r J; their rods do
/// not feel it. `pump`: null where none feeds the legs.
void set_reach(const model::Machine& machine, const Pose& X_BP,
               const kinematics::LegGeometries& geometry, const Abilities& legs,
               const PumpFlow* pump, Capability& result) {
  model::Machine held = machine;
  held.base_mount.reset();
  held.payload_modes.clear();
  const auto rigid = dynamics::linear_model(held, X_BP, dynamics::ModelKind::rigid);
  const Matrix6 J = kinematics::leg_jacobian(geometry, kinematics::mass_center(machine, X_BP));
  const Matrix6 per_force = J.transpose().inverse();
  const Matrix6 rods = per_force * Matrix6(rigid.M);  // forces per acceleration
  const Matrix6 per_acceleration = rods + legs.motors.asDiagonal() * J;
  const auto least = [](const Reach& a, const Reach& b) { return b.value < a.value ? b : a; };
  const bool jerks = std::isfinite(legs.rates[0].high);
  const Excursion excursion(machine, legs.axes, X_BP);
  auto& [force, velocity, acceleration, jerk, way] = result.reach;
  for (int d = 0; d < 6; ++d)
    for (int sign = 0; sign < 2; ++sign) {
      const auto i = static_cast<std::size_t>(d), s = static_cast<std::size_t>(sign);
      force[i][s] = least(reach_within(per_force.col(d), legs.forces, sign),
                          reach_within(per_force.col(d), legs.columns, sign));
      velocity[i][s] = reach_within(J.col(d), legs.speeds, sign);
      const double fed =
          pump != nullptr ? pump->share((sign == 0 ? 1.0 : -1.0) * J.col(d)) : infinite;
      if (fed < velocity[i][s].value) velocity[i][s] = {fed, Limit::pump};
      acceleration[i][s] = least(reach_within(per_acceleration.col(d), legs.forces, sign),
                                 reach_within(rods.col(d), legs.columns, sign));
      jerk[i][s] = jerks ? reach_within(per_acceleration.col(d), legs.rates, sign)
                         : Reach{.value = infinite, .limit = Limit::range};
      way[i][s] = excursion.find(d, sign);
    }
  result.combined = {std::min(combined_share(per_force, legs.forces, force),
                              combined_share(per_force, legs.columns, force)),
                     combined_share(J, legs.speeds, velocity),
                     std::min(combined_share(per_acceleration, legs.forces, acceleration),
                              combined_share(rods, legs.columns, acceleration)),
                     jerks ? combined_share(per_acceleration, legs.rates, jerk) : 1.0};
  if (pump == nullptr) return;
  for_all_signs(velocity, [&](const Vector6& motion) {
    result.combined[1] = std::min(result.combined[1], pump->share(J * motion));
  });
}

}  // namespace

std::optional<Capability> capability(const model::Machine& machine, const Pose& X_BP,
                                     dynamics::ModelKind kind, bool with_gain) {
  const bool screws = model::leg_type(machine) == model::LegType::screw;
  if (!screws) hydraulics::require_hydraulics(machine);
  const auto statics = dynamics::static_equilibrium(machine, X_BP, kind);
  if (statics.status != dynamics::StaticsStatus::converged) return {};
  Capability result;
  for (std::size_t i = 0; i < leg_count; ++i)
    result.legs[i].force = 0.0 - statics.legs[i].oil_force;
  const auto geometry = kinematics::inverse_kinematics(machine, X_BP);
  std::array<hydraulics::HydraulicRest, leg_count> rests{};
  const auto legs = screws ? of_screws(machine, geometry, result.legs)
                           : of_cylinders(machine, geometry, result.legs, rests);
  if (!legs) return {};
  std::optional<PumpFlow> pump;
  if (!screws) pump.emplace(machine.hydraulics.supply, legs->axes, rests);
  set_reach(machine, X_BP, geometry, *legs, pump ? &*pump : nullptr, result);
  if (with_gain && !screws) result.gain_limit = gain_limit_if_any(machine, X_BP, kind);
  return result;
}

}  // namespace hydrapod::simulation
