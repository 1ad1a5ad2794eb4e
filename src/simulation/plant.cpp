#include "hydrapod/simulation/plant.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "plant_work.hpp"

namespace hydrapod::simulation {

namespace {

using dynamics::LegMotion;
using dynamics::Motion;
using model::leg_count;

bool bristles_anywhere(const std::array<hydraulics::ServoAxis, leg_count>& axes) {
  return std::any_of(axes.begin(), axes.end(),
                     [](const auto& axis) { return axis.friction.has_bristles(); });
}

StateLayout make_layout(const dynamics::NonlinearModel& mechanics, const PlantOptions& options,
                        const std::array<hydraulics::ServoAxis, leg_count>& axes) {
  StateLayout layout{.positions = mechanics.positions(),
                     .velocities = mechanics.velocities(),
                     .payload = mechanics.payload_count()};
  layout.size = layout.positions + layout.velocities;
  const auto append = [&](int& first, int count) {
    first = layout.size;
    layout.size += count;
  };
  if (!options.hydraulics) return layout;
  if (model::leg_type(mechanics.machine()) == model::LegType::screw) {
    append(layout.nuts, 3 * leg_count);
    return layout;
  }
  append(layout.pressures, 2 * leg_count);
  append(layout.spools, 2 * leg_count);
  if (hydraulics::is_dynamic(mechanics.machine().hydraulics.supply)) append(layout.supply, 1);
  if (bristles_anywhere(axes)) append(layout.bristles, leg_count);
  return layout;
}

void reduce_friction(Friction friction, hydraulics::Friction& seal) {
  if (friction == Friction::all) return;
  seal.coulomb = seal.breakaway = 0.0;
  seal.bristle_stiffness = 0.0;
  if (friction == Friction::none) seal.viscous = 0.0;
}

model::Machine with_friction(model::Machine machine, Friction friction) {
  for (auto& leg : machine.legs) {
    auto& joints = leg.hydraulics.joint_friction;
    // bristles are the plant's
    if (friction != Friction::all || joints.bristle_stiffness) joints.coulomb = 0.0;
    if (friction == Friction::none) joints.viscous = 0.0;
  }
  return machine;
}

/// Oil that moves by itself is no inertia of the legs.
model::Machine with_lines(const model::Machine& machine, const PlantOptions& options) {
  const auto& lines = machine.hydraulics.lines;
  const bool waves = options.hydraulics && (lines.segments > 0.0 || lines.modes > 0.0);
  return waves ? hydraulics::without_line_inertia(machine) : machine;
}

bool finite(const double* x, int size) {
  std::array<double, 8> sums{};  // not finite as soon as one of theirs is not; side by side
  int k = 0;
  for (; k + 8 <= size; k += 8)
    for (int j = 0; j < 8; ++j) sums[j] += 0.0 * x[k + j];
  for (; k < size; ++k) sums[0] += 0.0 * x[k];
  return std::ranges::all_of(sums, [](double sum) { return sum == 0.0; });
}

}  // namespace

Plant::Plant(const model::Machine& machine, ModelKind kind, const PlantOptions& options)
    : Plant(machine, kind, options, machine.neutral()) {}

Plant::Plant(const model::Machine& machine, ModelKind kind, const PlantOptions& options,
             const Pose& X_reference)
    : machine_(machine),
      mechanics_(dynamics::with_seal_dampers(
                     with_friction(dynamics::with_pressed_seals(with_lines(machine, options), kind,
                                                                X_reference),
                                   options.friction),
                     kind, X_reference),
                 kind, X_reference),
      options_(options) {
  const auto type = model::leg_type(machine);
  const bool oil = type == model::LegType::cylinder ||
                   (options.hydraulics && type != model::LegType::screw);  // struts are refused
  for (int i = 0; i < leg_count; ++i) {
    if (oil)
      axes_[i] = hydraulics::servo_axis(machine, i);
    else
      axes_[i].stops = hydraulics::mechanical_stops(machine.legs[i]);
    reduce_friction(options.friction, axes_[i].friction);
  }
  layout_ = make_layout(mechanics_, options, axes_);
  set_lines();
  set_joints(X_reference);
  set_base(X_reference);
  set_arms(X_reference);
  set_gimbals(X_reference);
  if (!options.hydraulics) set_springs(X_reference);
  if (layout_.nuts >= 0) set_drives();
  set_oil_constants(X_reference);
}

/// Valves closed in the equilibrium at the reference pose. Without hydraulics the cylinder is not
/// known, so only a stroke that is given has ends.
void Plant::set_springs(const Pose& X_reference) {
  for (int i = 0; i < leg_count; ++i) {
    if (machine_.legs[i].stroke) continue;
    axes_[i].stops.low = -std::numeric_limits<double>::infinity();
    axes_[i].stops.high = std::numeric_limits<double>::infinity();
  }
  if (!options_.oil_springs) return;
  const auto rest = equilibrium(X_reference);
  Motion motion;
  mechanics_.motion(rest.x.data(), rest.x.data() + layout_.velocity(), motion);
  const auto statics = mechanics_.equilibrium(X_reference);
  for (int i = 0; i < leg_count; ++i) {
    const double s = motion.legs[i].s;
    const auto axial = hydraulics::axial_spring(machine_.legs[i], s);
    springs_[i] = {statics.legs[i].oil_force, axial.stiffness,
                   axial.damping + machine_.damping.rayleigh_stiffness * axial.stiffness, s};
  }
}

double Plant::spring_side(int i, const LegMotion& motion, const PlantInput& input,
                          LegOutput& out) const {
  const auto& spring = springs_[i];
  const auto& gimbals = gimbals_[i];
  out.oil_force = options_.oil_springs ? -spring.force - spring.stiffness * (motion.s - spring.s)
                                       : input.axial[i];
  out.piston = motion.s + gimbals.compliance * (out.oil_force - gimbals.force);
  out.piston_rate = motion.s_rate * (1.0 - gimbals.compliance * spring.stiffness);
  out.friction_force = -spring.damping * motion.s_rate;
  out.stop_force = hydraulics::stop_force(axes_[i].stops, motion.s, motion.s_rate);
  return out.oil_force + out.friction_force + out.stop_force;
}

bool Plant::evaluate(const double* x, const PlantInput& input, double* rate, Work& work) const {
  const double* v = x + layout_.velocity();
  mechanics_.motion(x, v, work.motion);
  if (!work.motion.exists()) return false;
  mechanics_.rates(x, v, rate);
  dynamics::Loads loads{.wrench = input.wrench};
  if (layout_.nuts >= 0) {
    drives_side(x, input, rate, loads.axial, work);
  } else if (options_.hydraulics) {
    oil_side(x, input, rate, loads.axial, work);
    supply_side(x, rate, work);
  } else {
    for (int i = 0; i < leg_count; ++i)
      loads.axial[i] = spring_side(i, work.motion.legs[i], input, work.legs[i]);
  }
  arms_side(x, rate, loads, work);
  joints_side(x, rate, loads, work);
  double* v_rate = rate + layout_.velocity();
  if (base_.count > 0)
    base_side(x, loads, rate, work);
  else
    mechanics_.accelerations(work.motion, loads, v_rate);
  const double alpha = machine_.damping.rayleigh_mass;
  if (alpha != 0.0)
    for (int k = 0; k < layout_.velocities; ++k) v_rate[k] -= alpha * v[k];
  return true;
}

bool Plant::derivative(double /*t*/, const double* x, const PlantInput& input, double* rate) const {
  Work work;
  return evaluate(x, input, rate, work) && finite(rate, layout_.size);
}

dynamics::Motion Plant::motion(const double* x) const {
  Motion motion;
  mechanics_.motion(x, x + layout_.velocity(), motion);
  return motion;
}

PlantOutput Plant::outputs(const double* x, const PlantInput& input) const {
  Work work;
  StateOnStack rate(layout_.size);
  PlantOutput out;
  if (!evaluate(x, input, rate.data(), work))
    throw base::ComputationError("a leg does not close in this state");
  out.X_BP = work.motion.X_BP;
  out.p_BC = work.motion.p_BC;
  out.twist = work.motion.twist;
  out.acceleration = rate.segment<6>(layout_.velocity());
  out.ground_acceleration =
      out.acceleration + dynamics::carried(work.base_acceleration, work.motion.p_BC);
  for (int i = 0; i < leg_count; ++i)
    out.legs[i] = layout_.pressures >= 0 ? oil_output(i, work) : work.legs[i];
  out.supply_pressure = work.supply_pressure;
  out.pump_flow = work.pump_flow;
  out.supply_flow = work.supply_flow;
  out.return_flow = work.return_flow;
  out.energies = mechanics_.energies(work.motion);
  out.dissipation = mechanics_.dissipation(work.motion);
  base_outputs(x, work, out);
  arms_outputs(x, work, out);
  joints_outputs(x, work, out);
  lines_outputs(x, out);
  if (layout_.nuts >= 0) drives_outputs(x, work, out);
  for (int i = 0; i < leg_count; ++i) {
    const auto& motion = work.motion.legs[i];
    auto& leg = out.legs[i];
    leg.length = motion.length;
    leg.length_rate = motion.length_rate;
    leg.flexible = motion.flexible;
    leg.sleeve_offset = motion.sleeve_offset;
    out.dissipation -= leg.friction_force * motion.s_rate;
    if (layout_.nuts >= 0) continue;
    if (options_.hydraulics) {
      out.gimbal_energy += 0.5 * gimbals_[i].compliance * leg.oil_force * leg.oil_force;
      continue;
    }
    const double stretch = motion.s - springs_[i].s;
    out.oil_spring_energy += (springs_[i].force + 0.5 * springs_[i].stiffness * stretch) * stretch;
  }
  out.dissipation +=
      2.0 * machine_.damping.rayleigh_mass *
      (out.energies.platform + out.energies.legs + out.base.kinetic_energy + out.motor_energy);
  return out;
}

Pose Plant::pose(const double* x) const {
  const Eigen::Quaterniond q(x[3], x[4], x[5], x[6]);
  Pose X_BP{.R_BP = q.normalized().toRotationMatrix()};
  X_BP.p_BP = Vector3(x[0], x[1], x[2]) - X_BP.R_BP * machine_.platform.mass_center;
  return X_BP;
}

Vector6 Plant::leg_lengths(const double* x) const {
  return kinematics::leg_lengths(machine_, pose(x));
}

void Plant::events(const double* x, double* values) const {
  const Motion now = motion(x);
  for (int i = 0; i < leg_count; ++i) {
    const auto& leg = now.legs[i];
    const auto& stops = axes_[i].stops;
    double* of_leg = values + events_per_leg * i;
    const bool has_stops = std::isfinite(stops.low);
    of_leg[0] = has_stops ? leg.s - stops.low : 1.0;
    of_leg[1] = has_stops ? stops.high - leg.s : 1.0;
    const double p_c = machine_.hydraulics.cavitation_pressure;
    of_leg[2] = layout_.pressures < 0 ? 1.0 : x[layout_.cap(i)] - p_c;
    of_leg[3] = layout_.pressures < 0 ? 1.0 : x[layout_.rod(i)] - p_c;
    of_leg[4] = machine_.legs[i].strut ? 1.0 : machine_.legs[i].guide_sleeve.position - leg.s;
  }
}

const char* Plant::name(Event event) {
  constexpr std::array<const char*, events_per_leg> names{
      "piston at the stop, retracted", "piston at the stop, extended", "cavitation on the cap side",
      "cavitation on the rod side", "piston leaves the guide sleeve"};
  return names[static_cast<size_t>(event)];
}

}  // namespace hydrapod::simulation
