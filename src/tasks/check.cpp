#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "hydrapod/base/error.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::tasks {

namespace {

using report::LegCheck;
using report::PoseCheck;
using Kind = report::PoseWarning::Kind;

LegCheck check_leg(const model::Leg& leg, double length, const kinematics::JointAngles& angles) {
  LegCheck result{.length = length, .piston = length - leg.rod.length};
  result.guided_length = leg.guide_sleeve.position - result.piston;
  result.oil_stiffness = hydraulics::oil_stiffness(leg, result.piston);
  if (leg.strut)
    result.piston = result.guided_length = result.largest_push = result.largest_pull =
        std::numeric_limits<double>::quiet_NaN();
  result.base_tilt = angles.base_tilt;
  result.platform_tilt = angles.platform_tilt;
  if (leg.stroke) {
    result.retract_left = result.piston - leg.stroke->retracted;
    result.extend_left = leg.stroke->retracted + leg.stroke->length - result.piston;
  }
  return result;
}

/// Where the rod stands off the axis of the case, at the guide sleeve and in the piston ring.
void add_offsets(const model::Machine& machine, int i, const dynamics::LegState& state,
                 dynamics::ModelKind kind, PoseCheck& result) {
  const auto& leg = machine.legs[i];
  const auto bent = dynamics::bent_leg(leg, result.pose.X_BP * leg.platform_joint,
                                       machine.flexible_axes, machine.gravity, state);
  result.legs[i].oil_stiffness = hydraulics::oil_stiffness(leg, bent.element.l_m);  // as in K
  result.legs[i].sleeve_offset = bent.element.sleeve_offset.norm();
  if (kind == dynamics::ModelKind::full)
    result.legs[i].ring_offset = state.flexible.tail<2>().norm();
  result.legs[i].gap = leg.guide_sleeve.gap;
  result.legs[i].on_guide = bent.element.k_contact > 0.0;
  const auto& element = bent.element;
  if (kind == dynamics::ModelKind::rigid || !(element.bending > 0.0)) return;
  result.legs[i].bending = element.bending;
  result.legs[i].bow = element.bending * element.bending_force.norm();
  auto unloaded = state;
  unloaded.rod_compression = 0.0;
  const auto free = dynamics::bent_leg(leg, result.pose.X_BP * leg.platform_joint,
                                       machine.flexible_axes, machine.gravity, unloaded);
  result.legs[i].bow_growth = element.bending / free.element.bending;
}

/// The legs whose rods the seals let down on their guide rings.
void warn_of_contact(PoseCheck& result) {
  report::PoseWarning on_guide{.kind = Kind::rod_on_guide};
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = result.legs[i];
    if (!leg.on_guide) continue;
    if (on_guide.legs.empty() || leg.sleeve_offset > on_guide.value) {
      on_guide.value = leg.sleeve_offset;
      on_guide.ratio = *leg.gap;
    }
    on_guide.legs.push_back(i);
  }
  if (!on_guide.legs.empty()) result.warnings.push_back(on_guide);
}

void add_statics(const model::Machine& of_file, dynamics::ModelKind kind, PoseCheck& result) {
  const auto machine = dynamics::with_pressed_seals(of_file, kind, result.pose.X_BP);
  const auto statics = dynamics::static_equilibrium(machine, result.pose.X_BP, kind);
  result.equilibrium = statics.status == dynamics::StaticsStatus::converged;
  for (int i = 0; i < model::leg_count; ++i) {
    result.legs[i].axial_force = 0.0 - statics.legs[i].oil_force;  // no -0 without a load
    result.legs[i].tilt = statics.legs[i].flexible.head<2>().norm();
    if (result.equilibrium) add_offsets(machine, i, statics.legs[i], kind, result);
  }
}

void add_buckling(const model::Machine& machine, dynamics::ModelKind kind, PoseCheck& result) {
  result.buckling_sought = kind != dynamics::ModelKind::rigid && !machine.gravity.isZero(0.0);
  if (!result.buckling_sought) return;
  result.buckling = dynamics::buckling_payload(machine, result.pose.X_BP, kind);
  if (result.buckling.status != dynamics::BucklingStatus::found) return;
  model::Machine loaded = machine;
  loaded.damping.oil = model::OilDamping::viscous;                        // as in the search
  const double just_below = 1.0 - dynamics::BucklingOptions{}.tolerance;  // of the bracketed load
  loaded.platform.mass = just_below * (machine.platform.mass + result.buckling.payload);
  auto model = dynamics::linear_model(loaded, result.pose.X_BP, kind, &result.buckling.last);
  model.K = dynamics::slow_stiffness(model);  // the load stays: elastomers relax under it
  result.lowest_at_buckling = modal::normal_modes(model).omega(0);
}

/// Do the oil springs alone hold the platform, with legs that cannot fold on a base that does not
/// move?
bool oil_holds(const model::Machine& machine, const spatial::Pose& X_BP) {
  const auto rigid = dynamics::linear_model(diagnosis::without_mount_and_gimbals(machine), X_BP,
                                            dynamics::ModelKind::rigid);
  return modal::normal_modes(rigid).omega2[0] > 0.0;
}

void warn_of_load(const model::Machine& machine, PoseCheck& result) {
  const auto& buckling = result.buckling;
  const double payload = buckling.payload, mass = machine.platform.mass;
  if (!machine.gravity.isZero(0.0) && !oil_holds(machine, result.pose.X_BP)) {
    const auto rigid =
        dynamics::buckling_payload(machine, result.pose.X_BP, dynamics::ModelKind::rigid);
    const bool known = rigid.status == dynamics::BucklingStatus::buckled;
    constexpr std::array soft{Kind::soft_oil, Kind::soft_struts, Kind::soft_screws};
    result.warnings.push_back({.kind = soft.at(static_cast<std::size_t>(model::leg_type(machine))),
                               .value = known ? -rigid.payload : 0.0});
  } else if (buckling.status == dynamics::BucklingStatus::buckled)
    result.warnings.push_back({.kind = Kind::buckled, .value = -payload});
  else if (buckling.status == dynamics::BucklingStatus::found && payload < mass)
    result.warnings.push_back(
        {.kind = Kind::near_buckling, .value = payload, .ratio = 1.0 + payload / mass});
  else if (!result.equilibrium)
    result.warnings.push_back({.kind = Kind::no_equilibrium});
}

/// One warning for all legs whose `value` lies below its limit, with the lowest of them.
template <class Value, class Limit>
void warn_below(PoseCheck& result, Kind kind, Value value, Limit limit) {
  report::PoseWarning warning{.kind = kind};
  for (int i = 0; i < model::leg_count; ++i) {
    if (!(value(i) < limit(i))) continue;
    warning.value = warning.legs.empty() ? value(i) : std::min(warning.value, value(i));
    warning.legs.push_back(i);
  }
  if (!warning.legs.empty()) result.warnings.push_back(warning);
}

/// The same of those above their limit, with the highest.
template <class Value, class Limit>
void warn_above(PoseCheck& result, Kind kind, Value value, Limit limit) {
  const auto before = result.warnings.size();
  warn_below(
      result, kind, [&](int i) { return -value(i); }, [&](int i) { return -limit(i); });
  if (result.warnings.size() > before) result.warnings.back().value *= -1.0;
}

/// Chamber pressures at rest, and what the oil can push and pull.
void add_pressures(const model::Machine& machine, PoseCheck& result) {
  if (model::leg_type(machine) != model::LegType::cylinder) return;
  const auto& supply = machine.hydraulics.supply;
  report::PoseWarning weak{.kind = Kind::weak_supply}, pump{.kind = Kind::weak_pump};
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = result.legs[i];
    const auto axis = hydraulics::servo_axis(machine, i);
    leg.largest_push = axis.force(supply.pressure, supply.return_pressure);
    leg.largest_pull = -axis.force(supply.return_pressure, supply.pressure);
    if (!result.equilibrium) continue;
    const auto rest = hydraulics::hydraulic_rest(axis, supply, leg.axial_force);
    if (rest.found) {
      leg.cap_pressure = rest.p_cap;
      leg.rod_pressure = rest.p_rod;
      pump.ratio +=
          hydraulics::valve_flows(axis.valve, rest.spool,
                                  {supply.pressure, supply.return_pressure, rest.p_cap, rest.p_rod})
              .supply;
      continue;
    }
    const double force = std::abs(leg.axial_force);
    if (weak.legs.empty() || force > weak.value) {  // the worst leg
      weak.value = force;
      weak.ratio = leg.axial_force > 0.0 ? leg.largest_push : leg.largest_pull;
    }
    weak.legs.push_back(i);
  }
  if (!weak.legs.empty()) result.warnings.push_back(weak);
  pump.value = supply.pump_flow.value_or(std::numeric_limits<double>::infinity());
  if (pump.ratio >= pump.value) result.warnings.push_back(pump);
}

/// What motors of electric cylinders hold, and can move.
void add_motors(const model::Machine& machine, PoseCheck& result) {
  report::PoseWarning weak{.kind = Kind::weak_motor};
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& screw = machine.legs[i].screw;
    if (!screw) return;
    auto& leg = result.legs[i];
    const double force = std::abs(leg.axial_force);
    leg.torque_limit = screw->torque_limit;
    if (screw->speed_limit) leg.largest_speed = *screw->speed_limit / screw->ratio();
    leg.largest_push = leg.largest_pull = std::numeric_limits<double>::infinity();
    if (result.equilibrium) leg.holding_torque = force / screw->ratio();
    if (!screw->torque_limit) continue;
    leg.largest_push = leg.largest_pull =
        screw->ratio() * (*screw->torque_limit - screw->friction_torque);
    if (!result.equilibrium || force < leg.largest_push) continue;
    if (weak.legs.empty() || force / leg.largest_push > weak.value / weak.ratio) {
      weak.value = force;
      weak.ratio = leg.largest_push;
    }
    weak.legs.push_back(i);
  }
  if (!weak.legs.empty()) result.warnings.push_back(weak);
}

/// What a leg has to overcome before its piston moves, beside what the oil can give; of the legs
/// the worst one.
void warn_of_friction(const model::Machine& machine, const CheckOptions& options,
                      PoseCheck& result) {
  if (model::leg_type(machine) != model::LegType::cylinder) return;
  report::PoseWarning stuck{.kind = Kind::stuck}, much{.kind = Kind::much_friction};
  const auto add = [](report::PoseWarning& warning, int leg, double friction, double limit) {
    if (warning.legs.empty() || limit / friction < warning.ratio / warning.value) {
      warning.value = friction;
      warning.ratio = limit;
    }
    warning.legs.push_back(leg);
  };
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = result.legs[i];
    const double friction = hydraulics::servo_axis(machine, i).friction.breakaway;
    if (!leg.cap_pressure || !(friction > 0.0)) continue;
    const double room =
        std::min(leg.largest_push - leg.axial_force, leg.largest_pull + leg.axial_force);
    if (friction >= room)
      add(stuck, i, friction, room);
    else if (friction > options.much_friction * leg.largest_push)
      add(much, i, friction, leg.largest_push);
  }
  for (const auto* warning : {&stuck, &much})
    if (!warning->legs.empty()) result.warnings.push_back(*warning);
}

/// The rods as columns; of a leg the gravest finding.
void add_columns(const model::Machine& machine, const CheckOptions& options, PoseCheck& result) {
  if (model::leg_type(machine) == model::LegType::strut) return;
  report::PoseWarning buckles{.kind = Kind::rod_buckles}, reserve{.kind = Kind::little_reserve},
      slender{.kind = model::leg_type(machine) == model::LegType::screw ? Kind::slender_screw
                                                                        : Kind::slender_rod};
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = result.legs[i];
    leg.column = dynamics::column_strength(machine.legs[i], leg.length);
    if (!leg.column) continue;
    const double strength = leg.column->strength;
    const double force = result.equilibrium ? leg.axial_force : 0.0;
    const auto add = [&](report::PoseWarning& warning, double value, double ratio, bool worse) {
      if (warning.legs.empty() || worse) {
        warning.value = value;
        warning.ratio = ratio;
      }
      warning.legs.push_back(i);
    };
    if (force > strength)
      add(buckles, force, strength, force / strength > buckles.value / buckles.ratio);
    else if (force * options.column_reserve > strength)
      add(reserve, strength / force, 0.0, strength / force < reserve.value);
    else if (leg.largest_push > strength && std::isfinite(leg.largest_push))
      add(slender, leg.largest_push, strength,
          leg.largest_push / strength > slender.value / slender.ratio);
  }
  for (const auto* warning : {&buckles, &reserve, &slender})
    if (!warning->legs.empty()) result.warnings.push_back(*warning);
}

/// ω² of the lowest mode; none where the static stiffness of the seals does not carry the load,
/// which a warning says by now.
std::optional<double> lowest_square(const model::Machine& machine, dynamics::ModelKind kind,
                                    const PoseCheck& result) {
  try {
    const auto model = dynamics::linear_model(machine, result.pose.X_BP, kind);
    return modal::modes_with_elastomers(machine, model).omega2[0];
  } catch (const base::ComputationError&) {
    if (report::is_sound(result)) throw;
    return {};
  }
}

/// Modes and motions: only where the machine stands.
void add_abilities(const model::Machine& machine, dynamics::ModelKind kind, PoseCheck& result) {
  if (!result.equilibrium) return;
  const auto square = lowest_square(machine, kind, result);
  if (!square || *square <= 0.0) return;
  result.first_resonance =
      modal::mode_table(machine, result.pose.X_BP, kind).real.modes.front().mode.omega;
  if (model::leg_type(machine) == model::LegType::strut) return;  // nothing moves the platform
  if (std::ranges::find(result.warnings, Kind::weak_pump, &report::PoseWarning::kind) !=
      result.warnings.end())
    return;  // the supply pressure falls
  result.capability = simulation::capability(machine, result.pose.X_BP, kind);
}

/// Air that is stated at a pressure at which the chambers are not is another spring.
void warn_of_air(const model::Machine& machine, const CheckOptions& options, PoseCheck& result) {
  report::PoseWarning other{.kind = Kind::air_pressure};
  double most = std::log(options.other_pressure);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = result.legs[i];
    const auto& cylinder = machine.legs[i].oil_spring.cylinder;
    if (!leg.cap_pressure || !cylinder || !cylinder->air || cylinder->air->fraction == 0.0)
      continue;
    const double mean = 0.5 * (*leg.cap_pressure + *leg.rod_pressure),
                 stated = cylinder->air->pressure, apart = std::abs(std::log(mean / stated));
    if (apart < std::log(options.other_pressure)) continue;
    other.legs.push_back(i);
    if (apart < most) continue;
    most = apart;
    other.value = mean;
    other.ratio = stated;
  }
  if (!other.legs.empty()) result.warnings.push_back(other);
}

void warn_of_legs(const model::Machine& machine, const CheckOptions& options, PoseCheck& result) {
  const auto& legs = result.legs;
  warn_below(
      result, Kind::little_stroke,
      [&](int i) {
        return machine.legs[i].stroke ? std::min(*legs[i].retract_left, *legs[i].extend_left) : 0.0;
      },
      [&](int i) {
        return machine.legs[i].stroke ? options.little_stroke * machine.legs[i].stroke->length
                                      : -1.0;
      });
  warn_below(
      result, Kind::short_guide, [&](int i) { return legs[i].guided_length; },
      [&](int i) { return options.short_guide * machine.legs[i].rod.length; });
  if (!result.equilibrium) return;
  warn_of_contact(result);
  constexpr double stated = std::numeric_limits<double>::infinity();
  warn_above(
      result, Kind::no_gap_stated, [&](int i) { return legs[i].sleeve_offset; },
      [&](int i) { return legs[i].gap ? stated : options.large_offset; });
  warn_above(
      result, Kind::tilted_rod, [&](int i) { return legs[i].tilt; },
      [&](int) { return options.large_tilt; });
}

PoseCheck check_pose(const model::Machine& machine, const model::NamedPose& pose,
                     dynamics::ModelKind kind, const CheckOptions& options) {
  PoseCheck result{.pose = pose, .quality = kinematics::pose_quality(machine, pose.X_BP)};
  const auto lengths = kinematics::leg_lengths(machine, pose.X_BP);
  const auto angles = kinematics::joint_angles(machine, pose.X_BP);
  for (int i = 0; i < model::leg_count; ++i)
    result.legs[i] = check_leg(machine.legs[i], lengths[i], angles[i]);
  add_statics(machine, kind, result);
  add_buckling(machine, kind, result);
  warn_of_load(machine, result);
  add_pressures(machine, result);
  add_motors(machine, result);
  warn_of_friction(machine, options, result);
  add_columns(machine, options, result);
  add_abilities(machine, kind, result);
  warn_of_air(machine, options, result);
  warn_of_legs(machine, options, result);
  if (result.quality.condition > options.poor_condition)
    result.warnings.push_back({.kind = Kind::near_singular, .value = result.quality.condition});
  return result;
}

}  // namespace

std::vector<PoseCheck> check(const Machine& machine, const std::vector<model::NamedPose>& poses,
                             const CheckOptions& options) {
  std::vector<PoseCheck> results;
  for (const auto& pose : poses.empty() ? std::vector{machine.pose} : poses)
    results.push_back(check_pose(machine.file.machine, pose, machine.kind, options));
  return results;
}

}  // namespace hydrapod::tasks
