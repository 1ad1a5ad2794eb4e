/// The hydraulics of all legs at once.

#include <algorithm>
#include <new>

#include "plant_work.hpp"

namespace hydrapod::simulation {

void Plant::set_oil_constants(const Pose& X_reference) {
  auto constants = std::make_shared<OilConstants>();
  constants->axis = hydraulics::side_by_side(axes_);
  const auto gimbals = [this](int i) -> const auto& { return gimbals_[static_cast<size_t>(i)]; };
  constants->gimbal_compliance = numerics::gather([&](int i) { return gimbals(i).compliance; });
  constants->gimbal_force = numerics::gather([&](int i) { return gimbals(i).force; });
  constants->gimbals = numerics::any_less(0.0, constants->gimbal_compliance);
  constants->bristles = constants->axis.friction.has_bristles();
  // with all friction they slide, or have bristles
  const auto& legs = machine_.legs;
  constants->sticks =
      layout_.pressures >= 0 && options_.friction != Friction::all &&
      std::ranges::any_of(legs, [](const auto& leg) { return leg.stick_stiffness > 0.0; });
  if (constants->sticks) {
    const auto rest = motion_at_rest(X_reference);
    constants->stick_stiffness =
        numerics::gather([&](int i) { return legs[static_cast<size_t>(i)].stick_stiffness; });
    constants->stick_s =
        numerics::gather([&](int i) { return rest.legs[static_cast<size_t>(i)].s; });
  }
  oil_constants_ = std::move(constants);
}

OilState Plant::oil_state(const dynamics::Motion& motion, const double* x,
                          const PlantInput& input) const {
  const auto leg = [&](int i) -> const auto& { return motion.legs[static_cast<size_t>(i)]; };
  const auto at = [&](auto place) { return numerics::gather([&](int i) { return x[place(i)]; }); };
  OilState state;
  state.s = numerics::gather([&](int i) { return leg(i).s; });
  state.s_rate = numerics::gather([&](int i) { return leg(i).s_rate; });
  state.p_cap = at([&](int i) { return layout_.cap(i); });
  state.p_rod = at([&](int i) { return layout_.rod(i); });
  state.spool = at([&](int i) { return layout_.spool(i); });
  state.spool_rate = at([&](int i) { return layout_.spool(i) + 1; });
  state.cap_port = state.p_cap;
  state.rod_port = state.p_rod;
  state.x = x;
  for_lines([&](const auto& line, size_t chamber, int first) {
    const int i = static_cast<int>(chamber / 2);
    const bool cap = chamber % 2 == 0;
    const double pressure = (cap ? state.p_cap : state.p_rod)[i];
    (cap ? state.cap_port : state.rod_port)
        .set(i, hydraulics::valve_pressure(line, x + first, pressure));
  });
  state.bristle = 0.0;
  if (layout_.bristles >= 0) state.bristle = at([&](int i) { return layout_.bristles + i; });
  state.command = numerics::gather([&](int i) { return input.command[i]; });
  state.supply_pressure =
      layout_.supply < 0 ? machine_.hydraulics.supply.pressure : x[layout_.supply];
  return state;
}

/// Chamber, spool and bristle rates; forces on the pistons along s.
OilRates Plant::oil_rates(const OilState& state) const {
  const auto& [axis, compliance, rest_force, stick_stiffness, stick_s, gimbals, bristles, sticks] =
      *oil_constants_;
  const Lanes back = machine_.hydraulics.supply.return_pressure;
  const Lanes atmosphere = hydraulics::atmospheric_pressure;
  OilRates out;
  const auto flows = hydraulics::valve_flows(
      axis.valve, state.spool, {state.supply_pressure, back, state.cap_port, state.rod_port});
  out.cap_inflow = flows.cap;
  out.rod_inflow = flows.rod;
  for_lines([&](const auto& line, size_t chamber, int first) {
    const int i = static_cast<int>(chamber / 2);
    const bool cap = chamber % 2 == 0;
    const double at_valve = (cap ? flows.cap : flows.rod)[i];
    (cap ? out.cap_inflow : out.rod_inflow)
        .set(i, hydraulics::chamber_inflow(line, state.x + first, at_valve));
  });
  out.internal_leakage = axis.internal_leakage * (state.p_cap - state.p_rod);
  const Lanes cap_out = axis.external_leakage * (state.p_cap - atmosphere);
  const Lanes rod_out = axis.external_leakage * (state.p_rod - atmosphere);
  out.external_leakage = cap_out + rod_out;
  out.oil_force = axis.force(state.p_cap, state.p_rod);
  out.piston = state.s + compliance * (out.oil_force - rest_force);
  const Lanes beside = 1.0 + compliance * stick_stiffness;
  const Lanes bent = (state.s - stick_s + compliance * (out.oil_force - rest_force)) / beside;
  if (sticks) out.piston = stick_s + bent;
  const auto volume = axis.volumes(out.piston);
  const Lanes cap_in = out.cap_inflow - out.internal_leakage - cap_out;
  const Lanes rod_in = out.rod_inflow + out.internal_leakage - rod_out;
  const Lanes cap_give =
      volume.cap * hydraulics::compressibility(axis.oil, state.p_cap) + axis.cap_line_compliance;
  const Lanes rod_give =
      volume.rod * hydraulics::compressibility(axis.oil, state.p_rod) + axis.rod_line_compliance;
  out.piston_rate = state.s_rate;
  if (gimbals) {
    const Lanes &A_p = axis.area.piston, &A_r = axis.area.annulus;
    const Lanes by_flows = A_p * cap_in / cap_give - A_r * rod_in / rod_give;
    const Lanes stiffness = A_p * A_p / cap_give + A_r * A_r / rod_give;
    out.piston_rate = (state.s_rate + compliance * by_flows) / (beside + compliance * stiffness);
  }
  out.p_cap = (cap_in - axis.area.piston * out.piston_rate) / cap_give;
  out.p_rod = (rod_in + axis.area.annulus * out.piston_rate) / rod_give;
  out.spool_rate =
      hydraulics::spool_acceleration(axis.valve, state.spool, state.spool_rate, state.command);
  out.friction_force = -hydraulics::smooth_friction(axis.friction, state.s_rate);
  out.bristle = 0.0;
  if (bristles) {
    const auto bent = hydraulics::bristle_friction(axis.friction, state.s_rate, state.bristle);
    const Lanes& have = axis.friction.bristle_stiffness;
    out.friction_force = numerics::where_less(0.0, have, -bent.force, out.friction_force);
    out.bristle = numerics::where_less(0.0, have, bent.rate, 0.0);
  }
  if (sticks) out.friction_force -= stick_stiffness * bent;
  out.stop_force = hydraulics::stop_force(axis.stops, state.s, state.s_rate);
  out.cap_flow = flows.cap;
  out.rod_flow = flows.rod;
  out.supply_flow = flows.supply;
  out.return_flow = flows.back;
  return out;
}

/// Evaluates the oil and writes its rates; the axial forces on the pistons go into `axial`.
void Plant::oil_side(const double* x, const PlantInput& input, double* rate, Vector6& axial,
                     Work& work) const {
  // Made where they stay: they are two kilobytes.
  ::new (&work.oil_state) OilState(oil_state(work.motion, x, input));
  ::new (&work.oil) OilRates(oil_rates(work.oil_state));
  const auto& oil = work.oil;
  const Lanes force = oil.oil_force + oil.friction_force + oil.stop_force;
  for (int i = 0; i < model::leg_count; ++i) {
    rate[layout_.cap(i)] = oil.p_cap[i];
    rate[layout_.rod(i)] = oil.p_rod[i];
    rate[layout_.spool(i)] = work.oil_state.spool_rate[i];
    rate[layout_.spool(i) + 1] = oil.spool_rate[i];
    if (layout_.bristles >= 0) rate[layout_.bristles + i] = oil.bristle[i];
    axial[i] = force[i];
  }
  lines_side(x, rate, work);
  work.supply_flow = oil.supply_flow.sum();
  work.return_flow = oil.return_flow.sum();
}

void Plant::supply_side(const double* x, double* rate, Work& work) const {
  const auto& supply = machine_.hydraulics.supply;
  work.supply_pressure = supply.pressure;
  work.pump_flow = work.supply_flow;
  if (layout_.supply < 0) return;
  const double p = x[layout_.supply];
  work.supply_pressure = p;
  work.pump_flow = hydraulics::pump_flow(supply, p);
  const double capacity =
      hydraulics::supply_capacity(supply, p, hydraulics::compressibility(axes_[0].oil, p));
  rate[layout_.supply] = (work.pump_flow - work.supply_flow) / capacity;
}

LegOutput Plant::oil_output(int i, const Work& work) {
  const auto& [state, oil] = std::tie(work.oil_state, work.oil);
  LegOutput out;
  out.cap_pressure = state.p_cap[i];
  out.rod_pressure = state.p_rod[i];
  out.spool = state.spool[i];
  out.spool_rate = state.spool_rate[i];
  out.cap_flow = oil.cap_flow[i];
  out.rod_flow = oil.rod_flow[i];
  out.cap_valve_pressure = state.cap_port[i];
  out.rod_valve_pressure = state.rod_port[i];
  out.cap_inflow = oil.cap_inflow[i];
  out.rod_inflow = oil.rod_inflow[i];
  out.supply_flow = oil.supply_flow[i];
  out.return_flow = oil.return_flow[i];
  out.internal_leakage = oil.internal_leakage[i];
  out.external_leakage = oil.external_leakage[i];
  out.piston = oil.piston[i];
  out.piston_rate = oil.piston_rate[i];
  out.oil_force = oil.oil_force[i];
  out.friction_force = oil.friction_force[i];
  out.stop_force = oil.stop_force[i];
  return out;
}

}  // namespace hydrapod::simulation
