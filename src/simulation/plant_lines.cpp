/// The plant's lines whose oil moves by itself.

#include "plant_work.hpp"

namespace hydrapod::simulation {

using model::leg_count;

/// After pressures, spools, supply and bristles in the state.
void Plant::set_lines() {
  if (layout_.pressures < 0) return;
  for (size_t i = 0; i < leg_count; ++i) {
    lines_[i] = hydraulics::leg_lines(machine_, static_cast<int>(i));
    hydraulics::take_out_lines(lines_[i], axes_[i]);
    for (const size_t side : {0, 1}) {
      const int states = hydraulics::states(side == 0 ? lines_[i].cap : lines_[i].rod);
      if (states == 0) continue;
      layout_.lines[2 * i + side] = layout_.size;
      layout_.line_states = states;
      layout_.size += states;
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
    hydraulics::steady_line(line, cap ? oil.valve_pressure.cap : oil.valve_pressure.rod,
                            cap ? oil.p_cap : oil.p_rod, cap ? flows.cap : flows.rod,
                            x.data() + first);
  });
}

}  // namespace hydrapod::simulation
