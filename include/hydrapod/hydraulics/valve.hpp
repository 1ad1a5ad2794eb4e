#pragma once
/// Four-edge servo valve: turbulent orifices with a smooth laminar transition, overlap, leakage.
///
///     Q_A = K [ o(x) q(p_s − p_A) − o(−x) q(p_A − p_r) ]         into the cap-side chamber
///     Q_B = K [ o(−x) q(p_s − p_B) − o(x) q(p_B − p_r) ]         into the rod-side chamber
///
///     q(Δp) = Δp / (Δp² + p_t²)^(1/4)       ±√|Δp| far from zero, Δp/√p_t near it; the flow is
///                                           less than the turbulent one by p_t² / 4Δp² of it
///     o(x)  = ½ [ x − x_o + √((x − x_o)² + ε²) ]        opening of an edge, fraction of full
///
/// x ∈ [−1, 1] spool position, x_o overlap (negative: underlap). ε rounds the edge's corner so that
/// the spool's middle leaks what the valve's null leakage is; without leakage the corner is sharp.
/// Flows are [m³/s], pressures [Pa]. All functions are smooth in the pressures.

#include <algorithm>
#include <cmath>

namespace hydrapod::hydraulics {

/// A valve with everything resolved; made by servo_axis().
struct Valve {
  double gain{};              ///< K [m³/(s √Pa)] at full opening
  double overlap{};           ///< x_o
  double rounding{};          ///< ε
  double laminar_pressure{};  ///< p_t [Pa]
  double natural_frequency{};
  double damping_ratio{};
  double rate_limit{};
};

/// q(Δp) [√Pa].
inline double orifice(double drop, double laminar_pressure) {
  return drop / std::sqrt(std::sqrt(drop * drop + laminar_pressure * laminar_pressure));
}

/// ∂q/∂Δp.
inline double orifice_slope(double drop, double laminar_pressure) {
  const double square = drop * drop + laminar_pressure * laminar_pressure;
  return (0.5 * drop * drop + laminar_pressure * laminar_pressure) /
         (square * std::sqrt(std::sqrt(square)));
}

/// o(x).
inline double opening(const Valve& valve, double x) {
  const double over = x - valve.overlap;
  return 0.5 * (over + std::sqrt(over * over + valve.rounding * valve.rounding));
}

/// ∂o/∂x; one half at a sharp corner.
inline double opening_slope(const Valve& valve, double x) {
  const double over = x - valve.overlap;
  const double root = std::sqrt(over * over + valve.rounding * valve.rounding);
  return root > 0.0 ? 0.5 * (1.0 + over / root) : 0.5;
}

/// Pressures around a valve [Pa].
struct PortPressures {
  double supply{}, back{}, cap{}, rod{};
};

/// Flows of a valve [m³/s]: into both chambers, out of the supply, into the return.
struct PortFlows {
  double cap{}, rod{}, supply{}, back{};
};

/// Flows at spool position `x`; beyond full travel nothing opens further.
inline PortFlows valve_flows(const Valve& valve, double x, const PortPressures& p) {
  const double at = std::clamp(x, -1.0, 1.0);
  const double open_forward = valve.gain * opening(valve, at);
  const double open_backward = valve.gain * opening(valve, -at);
  const double supply_cap = open_forward * orifice(p.supply - p.cap, valve.laminar_pressure);
  const double cap_back = open_backward * orifice(p.cap - p.back, valve.laminar_pressure);
  const double supply_rod = open_backward * orifice(p.supply - p.rod, valve.laminar_pressure);
  const double rod_back = open_forward * orifice(p.rod - p.back, valve.laminar_pressure);
  return {supply_cap - cap_back, supply_rod - rod_back, supply_cap + supply_rod,
          cap_back + rod_back};
}

/// Slopes of the flows into the chambers, by spool position and by the chamber's own pressure.
struct PortFlowSlopes {
  double cap_x{}, cap_p{}, rod_x{}, rod_p{};
};
PortFlowSlopes valve_flow_slopes(const Valve& valve, double x, const PortPressures& p);

/// Flow through the spool's middle [m³/s], both ports blocked: what a data sheet calls null
/// leakage.
double null_leakage(const Valve& valve, double supply, double back);

/// ẍ of the spool for a command u ∈ [−1, 1]: a lag of second order with limited rate,
///     ẍ = 2ζω [ sat(ω (u − x) / 2ζ) − ẋ ],     |sat| ≤ rate limit,
/// whose rate never passes the limit and which is ω²(u − x) − 2ζω ẋ below it.
inline double spool_acceleration(const Valve& valve, double x, double rate, double command) {
  const double aim =
      0.5 * valve.natural_frequency / valve.damping_ratio * (std::clamp(command, -1.0, 1.0) - x);
  return 2.0 * valve.damping_ratio * valve.natural_frequency *
         (std::clamp(aim, -valve.rate_limit, valve.rate_limit) - rate);
}

}  // namespace hydrapod::hydraulics
