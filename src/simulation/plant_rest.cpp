#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

namespace {

using model::leg_count;

constexpr double litres_per_minute = 6e4;  // in a m³/s

void require_statics(const dynamics::StaticEquilibrium& statics) {
  if (statics.status == dynamics::StaticsStatus::converged) return;
  throw base::ComputationError(
      fmt::format("no static equilibrium to start from at this pose ({} iterations, residual "
                  "{:.2g} of the weight): the legs may be past buckling (see `hydrapod check`)",
                  statics.iterations, statics.residual));
}

void require_stroke(int i, double s, const hydraulics::Stops& stops) {
  if (s >= stops.low && s <= stops.high) return;
  throw base::ComputationError(fmt::format(
      "leg {}: at this pose the piston stands at {:.4g} m from the base joint, outside its stroke "
      "of {:.4g} to {:.4g} m",
      i + 1, s, stops.low, stops.high));
}

void require_rest(int i, const hydraulics::HydraulicRest& rest, double force, double supply) {
  if (rest.found) return;
  throw base::ComputationError(fmt::format(
      "leg {}: a supply of {:.4g} MPa cannot hold the static force of {:.4g} N at this pose; "
      "expected a higher `supply.pressure` or a larger cylinder",
      i + 1, 1e-6 * supply, force));
}

}  // namespace

/// Where mechanics rest at a pose: y.
Eigen::VectorXd Plant::mechanics_at_rest(const Pose& X_BP) const {
  const auto statics = mechanics_.equilibrium(X_BP);
  require_statics(statics);
  Eigen::VectorXd y(layout_.positions);
  mechanics_.configuration(X_BP, statics.legs, y.data());
  return y;
}

dynamics::Motion Plant::motion_at_rest(const Pose& X_BP) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(layout_.size);
  x.head(layout_.positions) = mechanics_at_rest(X_BP);
  return motion(x.data());
}

/// The file's lengths hold under the load at rest at the reference pose.
void Plant::set_gimbals(const Pose& X_reference) {
  const auto& legs = machine_.legs;
  if (std::none_of(legs.begin(), legs.end(),
                   [](const auto& leg) { return leg.gimbal_stiffness.has_value(); }))
    return;
  const auto statics = mechanics_.equilibrium(X_reference);
  require_statics(statics);
  for (int i = 0; i < leg_count; ++i)
    if (legs[i].gimbal_stiffness)
      gimbals_[i] = {1.0 / *legs[i].gimbal_stiffness, -statics.legs[i].oil_force};
}

/// Pressures and spools at the supply pressure of `supply`, into `rest`; returns the flow drawn.
double Plant::hold(const dynamics::StaticEquilibrium& statics, const model::Supply& supply,
                   Rest& rest) const {
  double drawn = 0.0;
  for (int i = 0; i < leg_count; ++i) {
    const double force = 0.0 - statics.legs[i].oil_force;
    const auto oil = hydraulics::hydraulic_rest(
        axes_[i], supply, force,
        {hydraulics::loss(lines_[i].cap), hydraulics::loss(lines_[i].rod)});
    require_rest(i, oil, force, supply.pressure);
    rest.x[layout_.cap(i)] = oil.p_cap;
    rest.x[layout_.rod(i)] = oil.p_rod;
    rest.x[layout_.spool(i)] = oil.spool;
    rest.input.command[i] = oil.spool;
    const auto flows = hydraulics::valve_flows(
        axes_[i].valve, oil.spool,
        {supply.pressure, supply.return_pressure, oil.valve_pressure.cap, oil.valve_pressure.rod});
    lines_at_rest(i, oil, flows, rest.x);
    drawn += flows.supply;
  }
  return drawn;
}

Plant::Rest Plant::equilibrium(const Pose& X_BP) const {
  Rest rest;
  rest.x.setZero(layout_.size);
  const auto statics = mechanics_.equilibrium(X_BP);
  require_statics(statics);
  mechanics_.configuration(X_BP, statics.legs, rest.x.data());
  arms_at_rest(rest.x);
  if (!options_.hydraulics) {
    for (int i = 0; i < leg_count && !options_.oil_springs; ++i)
      rest.input.axial[i] = 0.0 - statics.legs[i].oil_force;
    return rest;
  }
  const auto now = motion(rest.x.data());
  for (int i = 0; i < leg_count; ++i) require_stroke(i, now.legs[i].s, axes_[i].stops);
  if (layout_.nuts >= 0) {
    hold_by_drives(statics, now, rest);
    return rest;
  }

  const auto& given = machine_.hydraulics.supply;
  auto supply = given;
  double drawn = hold(statics, supply, rest);
  if (layout_.supply < 0) return rest;
  constexpr int most_iterations = 50;  // the pressure moves within the pump's narrow band
  for (int k = 0; k < most_iterations && drawn < *given.pump_flow; ++k) {
    const double before = supply.pressure;
    supply.pressure = hydraulics::pressure_at_flow(given, drawn);
    drawn = hold(statics, supply, rest);
    if (std::abs(supply.pressure - before) < 1e-12 * before) break;
  }
  if (drawn >= *given.pump_flow)
    throw base::ComputationError(fmt::format(
        "the pump gives {:.4g} l/min and the valves leak {:.4g} l/min at rest; expected "
        "a larger `supply.pump_flow` or less leakage",
        litres_per_minute * *given.pump_flow, litres_per_minute * drawn));
  rest.x[layout_.supply] = supply.pressure;
  return rest;
}

}  // namespace hydrapod::simulation
