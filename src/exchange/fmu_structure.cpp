/// What depends on what. The equations are those of simulation/plant.hpp, term by term.

#include <algorithm>

#include "fmu_outputs.hpp"

namespace hydrapod::exchange {

namespace {

using model::leg_count;
using simulation::Plant;

/// Where the states of a seal stand, −1 for what it has not.
struct Seal {
  static constexpr int arm_states = simulation::StateLayout::arm_states;
  static constexpr int softening_states = simulation::StateLayout::softening_states;

  int leg{};
  bool sleeve{};  ///< else the piston ring
  int arms{}, softening{};

  Seal(const simulation::StateLayout& layout, int of_leg, bool of_sleeve)
      : leg(of_leg),
        sleeve(of_sleeve),
        arms((sleeve ? layout.sleeve_arms : layout.ring_arms)[static_cast<std::size_t>(leg)]),
        softening((sleeve ? layout.sleeve_softening
                          : layout.ring_softening)[static_cast<std::size_t>(leg)]) {}
  [[nodiscard]] bool has_arm(int k) const {
    return arms >= 0 && k >= arms && k < arms + arm_states;
  }
  [[nodiscard]] bool has_softening(int k) const {
    return softening >= 0 && k >= softening && k < softening + softening_states;
  }
};

bool has_modal_lines(const Plant& plant) { return plant.machine().hydraulics.lines.modes > 0.0; }

/// Do the joints of leg `i` have bristles?
bool sticks(const Plant& plant, int i) {
  const auto& joints = plant.machine().legs[static_cast<std::size_t>(i)].hydraulics.joint_friction;
  return plant.layout().joints >= 0 && joints.coulomb > 0.0 && joints.bristle_stiffness;
}

/// Knowns of an unknown, as they are collected.
class Knowns {
 public:
  Knowns(const FmuInterface& interface, const Plant& plant)
      : plant_(plant),
        layout_(plant.layout()),
        first_state_(interface.first(FmuRole::state)),
        first_input_(interface.first(FmuRole::input)),
        first_wrench_(first_input_ + interface.wrench_input),
        controlled_(interface.controlled) {}

  void state(int index, bool constant = false) {
    found_.push_back({first_state_ + index, constant});
  }
  void states(int first, int count) {
    for (int k = 0; k < count; ++k) state(first + k);
  }
  /// What flows into a chamber, numbered as in StateLayout::lines: out of its line, or out of the
  /// valve, which sees its pressure.
  void inflow(int chamber) {
    const int line = layout_.lines.at(static_cast<std::size_t>(chamber));
    if (line >= 0 && !has_modal_lines(plant_)) return state(line + layout_.line_states - 1);
    if (line >= 0) states(line + layout_.line_states / 2, layout_.line_states / 2);
    port(chamber);
  }
  /// What flows out of the valve towards a chamber.
  void port(int chamber) {
    const int line = layout_.lines.at(static_cast<std::size_t>(chamber));
    if (line >= 0) state(line);
    if (line < 0 || has_modal_lines(plant_)) state(layout_.pressures + chamber);
    state(layout_.spool(chamber / 2));
    if (layout_.supply >= 0) state(layout_.supply);
  }
  void input(int index) { found_.push_back({first_input_ + index, false}); }

  /// `leg` −1: all legs. `coordinate`: of own_coordinate.
  void parts(unsigned parts, int leg, int coordinate = 0) {
    if ((parts & part::own_coordinate) != 0) state(coordinate, true);
    if ((parts & part::position) != 0) states(0, 3);
    if ((parts & part::orientation) != 0) states(3, 4);
    if ((parts & part::velocity) != 0) states(layout_.velocity(), 3);
    if ((parts & part::turning) != 0) states(layout_.velocity() + 3, 3);
    for (int i = 0; i < leg_count; ++i)
      if (leg < 0 || leg == i) of_leg(parts, i);
    if ((parts & part::supply) != 0 && layout_.supply >= 0) state(layout_.supply);
    if ((parts & part::payload) != 0)
      for (const int end : {layout_.positions, layout_.positions + layout_.velocities})
        states(end - layout_.payload, layout_.payload);
    const int base = plant_.base().count;
    if ((parts & part::base) != 0) states(layout_.base, base);
    if ((parts & part::base_rate) != 0) states(layout_.base + base, base);
    if ((parts & part::wrench) != 0)
      for (int k = 0; k < 6; ++k) found_.push_back({first_wrench_ + k, false});
  }

  [[nodiscard]] std::vector<FmuDependency> sorted() {
    std::ranges::sort(found_, {}, &FmuDependency::variable);
    const auto twice = std::ranges::unique(found_, {}, &FmuDependency::variable);
    found_.erase(twice.begin(), twice.end());
    return found_;
  }

 private:
  void of_leg(unsigned parts, int i) {
    const int flexible = plant_.mechanics().flexible();
    const bool oil = layout_.pressures >= 0, drives = layout_.nuts >= 0;
    if ((parts & part::flexible) != 0) states(7 + flexible * i, flexible);
    if ((parts & part::flexible_rate) != 0) states(layout_.velocity() + 6 + flexible * i, flexible);
    if ((parts & part::pressure) != 0 && oil) states(layout_.cap(i), 2);
    if ((parts & part::spool) != 0 && oil) state(layout_.spool(i));
    if ((parts & part::inflow) != 0 && oil)
      for (const int chamber : {2 * i, 2 * i + 1}) inflow(chamber);
    if ((parts & part::spool_rate) != 0 && oil) state(layout_.spool(i) + 1);
    if ((parts & part::bristle) != 0 && plant_.axis(i).friction.has_bristles() && oil)
      state(layout_.bristles + i);
    if ((parts & part::joints) != 0 && sticks(plant_, i)) states(layout_.joint(i, false), 4);
    if ((parts & part::arms) != 0)
      for (const bool sleeve : {true, false}) {
        const Seal seal(layout_, i, sleeve);
        if (seal.arms >= 0) states(seal.arms, Seal::arm_states);
        if (seal.softening >= 0) state(seal.softening);
      }
    if ((parts & part::nut) != 0 && drives) state(layout_.nut(i));
    if ((parts & part::nut_rate) != 0 && drives) state(layout_.nut(i) + 1);
    if ((parts & part::torque_integral) != 0 && drives) state(layout_.nut(i) + 2);
    if ((parts & part::valve) != 0 && (oil || drives) && !controlled_) input(i);
    if ((parts & part::axial) != 0 && !oil && !drives) input(i);
  }

  const Plant& plant_;
  const simulation::StateLayout& layout_;
  int first_state_, first_input_, first_wrench_;
  bool controlled_;
  std::vector<FmuDependency> found_{};
};

void of_position_rate(int k, const simulation::StateLayout& layout, Knowns& knowns) {
  constexpr int quaternion = 3, end = 7;
  if (k >= quaternion && k < end) {  // ½ (0, ω) q has no q_k in its own row
    for (int other = quaternion; other < end; ++other)
      if (other != k) knowns.state(other);
    knowns.parts(part::turning, -1);
    return;
  }
  knowns.state(layout.velocity() + (k < quaternion ? k : k - 1), true);
}

/// The piston moves by what flows into both chambers where the gimbals give way.
void of_pressure(int chamber, const Plant& plant, Knowns& knowns) {
  const int leg = chamber / 2;
  knowns.parts(fmu_speed_parts() | part::pressure, leg);
  knowns.inflow(chamber);
  if (plant.machine().legs[static_cast<std::size_t>(leg)].gimbal_stiffness)
    knowns.inflow(chamber ^ 1);
}

/// s_n, ṡ_n or T_i.
void of_drive(int k, const Plant& plant, Knowns& knowns) {
  const int leg = (k - plant.layout().nuts) / 3, which = (k - plant.layout().nuts) % 3;
  if (which == 0) return knowns.state(k + 1, true);
  knowns.parts(fmu_torque_parts(), leg);
  if (which == 1) knowns.parts(fmu_speed_parts() | part::nut, leg);
}

/// State `k` of a line: pressures p_0, …, p_{N−1}, then flows q_1, …, q_N.
void of_line(int k, int chamber, const simulation::StateLayout& layout, Knowns& knowns) {
  const int first = layout.lines.at(static_cast<std::size_t>(chamber));
  const int segments = layout.line_states / 2, flows = first + segments;
  if (k < segments) {
    knowns.state(first + k);
    knowns.state(flows + k);
    if (k > 0) return knowns.state(flows + k - 1);
    return knowns.port(chamber);
  }
  const int j = k - segments;  // between the nodes j and j + 1
  knowns.state(first + j);
  knowns.state(j + 1 < segments ? first + j + 1 : layout.pressures + chamber);
  knowns.state(first + k);
}

/// State `k` of a line in modes: pressures p_w, P_1, …, then flows q_0, …. Its oil is compressed as
/// the chamber's.
void of_modal_line(int k, int chamber, const simulation::StateLayout& layout, Knowns& knowns) {
  const int first = layout.lines.at(static_cast<std::size_t>(chamber));
  const int modes = layout.line_states / 2, flows = first + modes, mode = k % modes;
  knowns.state(layout.pressures + chamber);
  if (k == 0) {
    knowns.states(flows, modes);
    return knowns.port(chamber);
  }
  knowns.state(flows + mode);
  if (k < modes) return;
  knowns.state(first);
  knowns.state(first + mode);
}

/// The offset along an axis at a seal, which its own force moves where rod and case bend.
void of_offset(const Seal& seal, int axis, const Plant& plant, Knowns& knowns) {
  if (!seal.sleeve) {
    const int flexible = plant.mechanics().flexible();
    return knowns.state(7 + flexible * seal.leg + 2 + axis);
  }
  knowns.parts(fmu_stretch_parts(), seal.leg);
  const bool bends = plant.machine().legs[static_cast<std::size_t>(seal.leg)].bending ==
                     model::LegBending::elastic;
  if (!bends || seal.softening < 0) return;
  for (int j = 0; j < Seal::arm_states; j += 2) knowns.state(seal.arms + j + axis);
  knowns.state(seal.softening);
}

/// State `k`, along one axis of a frame that turns against the case with transverse axes.
void of_seal(int k, const Seal& seal, const Plant& plant, Knowns& knowns) {
  knowns.state(k);
  if (k == seal.softening) {
    knowns.states(k + 1, 2);
    for (const int axis : {0, 1}) of_offset(seal, axis, plant, knowns);
    return;
  }
  const int axis = (k - (seal.has_arm(k) ? seal.arms : seal.softening + 1)) % 2;
  of_offset(seal, axis, plant, knowns);
  if (plant.machine().flexible_axes == model::FlexibleAxes::gimbal) return;
  knowns.state(axis == 0 ? k + 1 : k - 1);
  knowns.parts(fmu_speed_parts(), seal.leg);
}

void of_derivative(int k, const Plant& plant, Knowns& knowns) {
  const auto& layout = plant.layout();
  const int base = plant.base().count;
  if (k < layout.velocity()) return of_position_rate(k, layout, knowns);
  if (k < layout.velocity() + layout.velocities) return knowns.parts(fmu_acceleration_parts(), -1);
  if (layout.pressures >= 0 && k >= layout.pressures && k < layout.pressures + 2 * leg_count)
    return of_pressure(k - layout.pressures, plant, knowns);
  if (layout.spools >= 0 && k >= layout.spools && k < layout.spools + 2 * leg_count) {
    const int leg = (k - layout.spools) / 2;
    if (k == layout.spool(leg)) return knowns.state(k + 1, true);
    return knowns.parts(part::spool | part::spool_rate | part::valve, leg);
  }
  if (layout.nuts >= 0 && k >= layout.nuts && k < layout.nuts + 3 * leg_count)
    return of_drive(k, plant, knowns);
  if (k == layout.supply) {
    knowns.state(k);
    for (int chamber = 0; chamber < 2 * leg_count; ++chamber) knowns.port(chamber);
    return;
  }
  if (layout.bristles >= 0 && k >= layout.bristles && k < layout.bristles + leg_count) {
    const int leg = k - layout.bristles;
    if (plant.axis(leg).friction.has_bristles())
      knowns.parts(fmu_speed_parts() | part::bristle, leg);
    return;
  }
  if (layout.joints >= 0 && k >= layout.joints && k < layout.joints + 4 * leg_count) {
    const int at = k - layout.joints;
    if (sticks(plant, at / 4)) {
      knowns.states(k - at % 2, 2);
      knowns.parts(fmu_speed_parts(), at / 4);
    }
    return;
  }
  for (int chamber = 0; chamber < 2 * leg_count; ++chamber) {
    const int first = layout.lines.at(static_cast<std::size_t>(chamber));
    if (first < 0 || k < first || k >= first + layout.line_states) continue;
    return has_modal_lines(plant) ? of_modal_line(k - first, chamber, layout, knowns)
                                  : of_line(k - first, chamber, layout, knowns);
  }
  for (int leg = 0; leg < leg_count; ++leg)
    for (const bool sleeve : {true, false})
      if (const Seal seal(layout, leg, sleeve); seal.has_arm(k) || seal.has_softening(k))
        return of_seal(k, seal, plant, knowns);
  if (k < layout.base + base) return knowns.state(k + base, true);
  knowns.parts(fmu_acceleration_parts(), -1);
}

void of_indicator(int event, const simulation::StateLayout& layout, Knowns& knowns) {
  const int leg = event / Plant::events_per_leg;
  switch (static_cast<Plant::Event>(event % Plant::events_per_leg)) {
    case Plant::Event::cavitation_cap:
      return knowns.state(layout.cap(leg), true);
    case Plant::Event::cavitation_rod:
      return knowns.state(layout.rod(leg), true);
    default:
      return knowns.parts(fmu_stretch_parts(), leg);
  }
}

}  // namespace

std::vector<FmuDependency> fmu_dependencies(const FmuInterface& interface, const Plant& plant,
                                            int variable) {
  const auto& of = interface.variables[static_cast<std::size_t>(variable)];
  Knowns knowns(interface, plant);
  if (of.role == FmuRole::state) knowns.state(of.index, true);
  if (of.role == FmuRole::derivative) of_derivative(of.index, plant, knowns);
  if (of.role == FmuRole::indicator)
    of_indicator(interface.indicators[static_cast<std::size_t>(of.index)], plant.layout(), knowns);
  if (of.role == FmuRole::output) {
    const auto one = fmu_output_table(plant)[static_cast<std::size_t>(of.index)];
    knowns.parts(one.parts, one.leg, one.element);
  }
  return knowns.sorted();
}

}  // namespace hydrapod::exchange
