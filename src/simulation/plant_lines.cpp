/// The plant's lines whose oil moves by itself.

#include "plant_work.hpp"

namespace hydrapod::simulation {

using model::leg_count;

namespace {

/// Its pressure falls evenly from the valve to the chamber.
void steady_line(const hydraulics::SegmentedLine& line, double at_valve, double in_chamber,
                 double flow, double* state) {
  for (int j = 0; j < line.segments; ++j) {
    state[j] = at_valve + (in_chamber - at_valve) * j / line.segments;
    state[line.segments + j] = flow;
  }
}

}  // namespace

template <class Each>
void Plant::for_lines(const Each& each) const {
  if (layout_.line_states == 0) return;
  const bool modal = machine_.hydraulics.lines.modes > 0.0;
  for (size_t k = 0; k < layout_.lines.size(); ++k) {
    const int first = layout_.lines[k];
    if (first < 0) continue;
    const bool cap = k % 2 == 0;
    const auto& segmented = lines_[k / 2];
    const auto& of_modes = modal_lines_[k / 2];
    if (modal)
      each(cap ? of_modes.cap : of_modes.rod, k, first);
    else
      each(cap ? segmented.cap : segmented.rod, k, first);
  }
}

/// After pressures, spools, supply and bristles in the state.
void Plant::set_lines() {
  if (layout_.pressures < 0) return;
  for (size_t i = 0; i < leg_count; ++i) {
    lines_[i] = hydraulics::segmented_lines(machine_, static_cast<int>(i));
    hydraulics::take_out_lines(lines_[i], axes_[i]);
    modal_lines_[i] = hydraulics::modal_lines(machine_, static_cast<int>(i));
    hydraulics::take_out_lines(modal_lines_[i], axes_[i]);
    const std::array states{lines_[i].cap.states() + modal_lines_[i].cap.states(),
                            lines_[i].rod.states() + modal_lines_[i].rod.states()};
    for (const size_t side : {0, 1}) {
      if (states[side] == 0) continue;
      layout_.lines[2 * i + side] = layout_.size;
      layout_.line_states = states[side];
      layout_.size += states[side];
    }
  }
}

void Plant::lines_side(const double* x, double* rate, const Work& work) const {
  for_lines([&](const auto& line, size_t chamber, int first) {
    const int leg = static_cast<int>(chamber / 2);
    const auto& flow = chamber % 2 == 0 ? work.oil.cap_flow : work.oil.rod_flow;
    hydraulics::line_rates(line, axes_[chamber / 2].oil, x + first, flow[leg],
                           x[layout_.pressures + static_cast<int>(chamber)], rate + first);
  });
}

void Plant::lines_outputs(const double* x, PlantOutput& out) const {
  for_lines([&](const auto& line, size_t, int first) {
    out.line_kinetic_energy += hydraulics::line_kinetic_energy(line, x + first);
    out.line_dissipation += hydraulics::line_dissipation(line, x + first);
  });
}

void Plant::lines_at_rest(int leg, const hydraulics::HydraulicRest& oil,
                          const hydraulics::PortFlows& flows, Eigen::VectorXd& x) const {
  for_lines([&](const auto& line, size_t chamber, int first) {
    if (static_cast<int>(chamber / 2) != leg) return;
    const bool cap = chamber % 2 == 0;
    steady_line(line, cap ? oil.valve_pressure.cap : oil.valve_pressure.rod,
                cap ? oil.p_cap : oil.p_rod, cap ? flows.cap : flows.rod, x.data() + first);
  });
}

}  // namespace hydrapod::simulation
