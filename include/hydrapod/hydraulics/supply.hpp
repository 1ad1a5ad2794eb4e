#pragma once
/// Supply pressure: a pump with limited flow, the oil between pump and valves, an accumulator.
///
///     ṗ_s = (Q_pump − Q_drawn) / C,    C = V_line / β + V_gas(p_s) / (n p_s)
///     V_gas(p) = V_0 (p_0 / p)^(1/n) above the precharge p_0, none below
///     Q_pump = Q_max sat((p_set + b/2 − p_s) / b)       pressure-controlled pump, band b = 2 %
///     p_set
///
/// p_set is the pressure at which the pump gives half of its flow. Without a pump flow the supply
/// keeps its pressure and has no state.

#include <algorithm>
#include <cmath>

#include "hydrapod/model/hydraulics.hpp"

namespace hydrapod::hydraulics {

/// Whether the supply pressure is a state.
inline bool is_dynamic(const model::Supply& supply) { return supply.pump_flow.has_value(); }

inline constexpr double pump_band = 0.02;  ///< b / p_set

/// Q_pump [m³/s].
inline double pump_flow(const model::Supply& supply, double p) {
  const double open = (supply.pressure - p) / (pump_band * supply.pressure) + 0.5;
  return supply.pump_flow.value_or(0.0) * std::clamp(open, 0.0, 1.0);
}

/// The pressure [Pa] at which the pump gives `flow` [m³/s], between nothing and all it has.
inline double pressure_at_flow(const model::Supply& supply, double flow) {
  return supply.pressure * (1.0 + pump_band * (0.5 - flow / supply.pump_flow.value_or(flow)));
}

/// C [m³/Pa]; `compressibility` [1/Pa] is that of the oil.
inline double supply_capacity(const model::Supply& supply, double p, double compressibility) {
  double capacity = supply.line_volume * compressibility;
  if (supply.accumulator && p > supply.accumulator->precharge) {
    const auto& gas = *supply.accumulator;
    capacity +=
        gas.gas_volume * std::pow(gas.precharge / p, 1.0 / gas.polytropic) / (gas.polytropic * p);
  }
  return capacity;
}

}  // namespace hydrapod::hydraulics
