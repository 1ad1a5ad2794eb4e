#pragma once
/// Everything a simulation needs to know of one leg's hydraulics, with every default resolved.
///
/// What a machine file leaves out follows from the machine; the rules, in this order:
/// - Cylinder. With `oil_spring.cylinder`: its areas, and its chambers (`volumes = "chambers"`) or
///   two chambers that hold `control_volume` at mid stroke ("equal"). With `oil_spring.stiffness`
///   k_h alone, an equivalent cylinder: area ratio e; a piston area A_p on which a sixth of the
///   supply pressure carries the leg's share F = m g_0 l / (6 h) of platform and payload (h the
///   leg's rise at the neutral pose; also without gravity); both chambers hold
///   V_0 = β_e (1 + e²) A_p² / k_h at mid stroke, so that Eq. 16 gives k_h there exactly. Without a
///   stroke, mid stroke is where the piston stands at the neutral pose.
/// - Stroke. Without a `stroke` the piston may go 90 % of the way to where a chamber would be
///   empty, it would leave the guide sleeve or the sleeve the rod, or it would reach the base
///   joint.
/// - Valve: moves the piston at 0.5 m/s at the rated flow; null leakage 1 % of that.
/// - Leakage past the piston: 1 % of the rated flow at the supply pressure.
/// - Seals: F_c is 1 % of A_p p_s, F_s = 1.5 F_c, b = 10 F_c per m/s.
/// - End stops: 20 times as stiff as the oil spring at mid stroke.
///
/// Oil in a chamber: how its pressure follows from the flow into it.
///
///     ṗ = β(p) / V · (Q − V̇)
///     1/β(p) = [(1 − α)/β + α x/(n p)] / [(1 − α) + α x] + 0.001 exp(−(p − p_c)/p_w) / p_w
///     x = (p_0 / p)^(1/n),   p_w = p_c / 10
///
/// The first part is oil of modulus β with the share α of air at atmospheric pressure p_0 (exponent
/// n), at the pressure that the chamber has now. The second is vapour: at the cavitation pressure
/// p_c it fills 0.1 % of the chamber, which can then be torn open to twenty times its volume before
/// the pressure is zero. It gives back what it took, and is lost in rounding from p_c + 40 p_w on.
///
/// Friction of a cylinder's seals along its axis, in two ways.
///
/// Smooth (Stribeck):   F = [F_c + (F_s − F_c) exp(−(v/v_s)²)] tanh(v/v_0) + b v
/// Bristles (LuGre; Canudas de Wit et al., IEEE TAC 1995):
///     ż = v − σ0 |v| z / g(v),   g = F_c + (F_s − F_c) exp(−(v/v_s)²)
///     F = σ0 z + σ1 ż + b v
///
/// F [N] is the force against the motion v [m/s]. The smooth law creeps under a load below F_s with
/// a velocity of about v_0; bristles stick.
///
/// Supply pressure: a pump with limited flow, the oil between pump and valves, an accumulator.
///
///     ṗ_s = (Q_pump − Q_drawn) / C,    C = V_line / β + V_gas(p_s) / (n p_s)
///     V_gas(p) = V_0 (p_0 / p)^(1/n) above the precharge p_0, none below
///     Q_pump = Q_max sat((p_set + b/2 − p_s) / b)       pressure-controlled pump, band b = 2 %
///     p_set
///
/// p_set is the pressure at which the pump gives half of its flow. Without a pump flow the supply
/// keeps its pressure and has no state.
///
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
///
/// The oil column of a double-acting cylinder as an axial spring.
///
///     k_h = β_e (A_p² / V_1 + (e A_p)² / V_2)                     chambers at the present
///     extension k_h = β_e (1 + e²) A_p² / V_0                               (Eq. 16), equal
///     volumes
///
/// A_p piston area, e = (A_p − A_rod) / A_p the area ratio, V_1 the chamber on the base side, V_2
/// the one around the rod, both with dead and line volumes. Valves are closed: no oil leaves. A
/// hose adds the compliance of its wall, 1/β_e becomes 1/β_e + c_line/V.
///
/// Entrained air, share α of the volume at atmospheric pressure p_0, at chamber pressure p,
/// exponent n:
///
///     β_e = [(1 − α) + α x] / [(1 − α) / β + α x / (n p)],   x = (p_0 / p)^(1/n)
///
/// (springs in series: the oil's own compressibility and that of the air compressed to p).

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::hydraulics {

inline constexpr double atmospheric_pressure = 101325.0;  ///< p_0 [Pa]

/// β_e [Pa] with the air that `cylinder` carries.
double effective_bulk_modulus(const model::Cylinder& cylinder);

struct CylinderAreas {
  double piston{};                                                 ///< A_p [m²]
  double annulus{};                                                ///< e A_p [m²]
  [[nodiscard]] double ratio() const { return annulus / piston; }  ///< e
};
CylinderAreas areas(const model::Cylinder& cylinder);

struct ChamberVolumes {
  double cap{};  ///< V_1 [m³]
  double rod{};  ///< V_2 [m³]
};
/// Volumes with the piston at `l_m` [m] from the base joint. The leg must have a stroke.
ChamberVolumes chamber_volumes(const model::Cylinder& cylinder, const model::Stroke& stroke,
                               double l_m);

/// V_0 [m³] of Eq. 16: `control_volume`, or the mean of both chambers at mid stroke.
double control_volume(const model::Leg& leg);

/// Inertia of the oil in both lines, seen at the piston at `l_m` [m]:
///     Σ ρ L A_c²/A · σ²/3,   σ = (V_line/β_e + c_line) / (V/β_e + c_line)
/// The valve is closed: a line is a dead end, and its oil moves in proportion to the distance from
/// that end; σ is the share of the compression that is in the line. 0 without line lengths.
double line_inertia(const model::Leg& leg, double l_m);

/// k_h [N/m] of `leg` with the piston at `l_m` [m] from the base joint.
/// Throws std::invalid_argument when the leg has no oil spring or lacks the stroke that it needs.
double oil_stiffness(const model::Leg& leg, double l_m);

/// What holds a leg along its axis: the oil spring, and in series the gimbals where they give way.
struct AxialSpring {
  double stiffness{};  ///< k_h k_j / (k_h + k_j) [N/m]
  /// c_h (k_j / (k_h + k_j))² [N s/m]: the share of the motion that the oil's damper sees, as long
  /// as the damper's force is small beside the spring's.
  double damping{};
};
AxialSpring axial_spring(const model::Leg& leg, double l_m);

/// A liquid with everything resolved; made by servo_axis().
struct Oil {
  double bulk_modulus{};         ///< β [Pa] without air
  double air_fraction{};         ///< α
  double air_exponent{1.4};      ///< n
  double cavitation_pressure{};  ///< p_c [Pa]
};

/// Compressibility 1/β(p) [1/Pa] at the absolute pressure `p` [Pa].
inline double compressibility(const Oil& oil, double p) {
  constexpr double widths = 40.0;  // from here on vapour is lost in rounding
  constexpr double share = 1e-3;   // of the chamber, at the cavitation pressure
  const double width = oil.cavitation_pressure / 10.0;
  double sum = 1.0 / oil.bulk_modulus;
  if (oil.air_fraction > 0.0) {
    // Below the cavitation pressure the air is taken to stay as it is there.
    const double at = std::max(p, oil.cavitation_pressure);
    const double x = oil.air_fraction * std::pow(atmospheric_pressure / at, 1.0 / oil.air_exponent);
    const double liquid = 1.0 - oil.air_fraction;
    sum = (liquid / oil.bulk_modulus + x / (oil.air_exponent * at)) / (liquid + x);
  }
  const double above = (p - oil.cavitation_pressure) / width;
  return above > widths ? sum : sum + share * std::exp(-above) / width;
}

/// Friction with everything resolved; made by servo_axis().
struct Friction {
  double coulomb{};              ///< F_c [N]
  double breakaway{};            ///< F_s [N]
  double stribeck_velocity{1};   ///< v_s [m/s]
  double smoothing_velocity{1};  ///< v_0 [m/s]
  double viscous{};              ///< b [N s/m]
  double bristle_stiffness{};    ///< σ0 [N/m]; 0: the smooth law
  double bristle_damping{};      ///< σ1 [N s/m]

  [[nodiscard]] bool has_bristles() const { return bristle_stiffness > 0.0; }
};

/// g(v) [N]: what sliding takes at the velocity `v`.
inline double sliding_force(const Friction& friction, double v) {
  if (friction.breakaway == friction.coulomb) return friction.coulomb;
  const double ratio = v / friction.stribeck_velocity;
  return friction.coulomb + (friction.breakaway - friction.coulomb) * std::exp(-ratio * ratio);
}

/// F [N] of the smooth law.
inline double smooth_friction(const Friction& friction, double v) {
  if (friction.breakaway == 0.0) return friction.viscous * v;
  return sliding_force(friction, v) * std::tanh(v / friction.smoothing_velocity) +
         friction.viscous * v;
}

/// ż [m/s] and F [N] of bristles bent by `z` [m].
struct BristleFriction {
  double rate{}, force{};
};
inline BristleFriction bristle_friction(const Friction& friction, double v, double z) {
  const double sliding = sliding_force(friction, v);
  const double rate =
      sliding > 0.0 ? v - friction.bristle_stiffness * std::abs(v) * z / sliding : 0.0;
  return {rate,
          friction.bristle_stiffness * z + friction.bristle_damping * rate + friction.viscous * v};
}

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

/// Stops at both ends: against a piston δ beyond an end, N = k δ (1 + d δ̇), never pulling.
struct Stops {
  double low{}, high{};  ///< [m] piston positions s where they touch
  double stiffness{};    ///< k [N/m]
  double damping{};      ///< d [s/m]
};

/// Force of the stops on the piston along s [N].
inline double stop_force(const Stops& stops, double s, double rate) {
  if (s < stops.low)
    return std::max(0.0, stops.stiffness * (stops.low - s) * (1.0 - stops.damping * rate));
  if (s > stops.high)
    return -std::max(0.0, stops.stiffness * (s - stops.high) * (1.0 + stops.damping * rate));
  return 0.0;
}

struct ServoAxis {
  CylinderAreas area{};      ///< A_p, e A_p [m²]
  ChamberVolumes volume{};   ///< V_1, V_2 [m³] with the piston at s_mid
  double s_mid{};            ///< [m] from the base joint
  double smallest_volume{};  ///< [m³] chambers are never taken for smaller
  double cap_line_compliance{}, rod_line_compliance{};  ///< [m³/Pa] of the lines' walls
  Oil oil{};
  Valve valve{};
  double internal_leakage{};  ///< [m³/(s Pa)]
  double external_leakage{};  ///< [m³/(s Pa)]
  Friction friction{};
  Stops stops{};

  /// V_1 and V_2 [m³] with the piston at `s` [m].
  [[nodiscard]] ChamberVolumes volumes(double s) const {
    return {std::max(volume.cap + area.piston * (s - s_mid), smallest_volume),
            std::max(volume.rod - area.annulus * (s - s_mid), smallest_volume)};
  }
  /// Force of the oil on the piston [N] along s (it pushes the leg out), the air's on the rod taken
  /// off.
  [[nodiscard]] double force(double p_cap, double p_rod) const {
    return p_cap * area.piston - p_rod * area.annulus -
           atmospheric_pressure * (area.piston - area.annulus);
  }
};

/// Leg `i` (from 0). The machine must be sound (model::validate).
ServoAxis servo_axis(const model::Machine& machine, int i);

/// What was assumed, for people: one entry for all legs where they agree.
struct Assumption {
  std::string key{};   ///< the key that would say it, for instance "legs.valve.rated_flow"
  std::string text{};  ///< "29.1 l/min: 0.5 m/s at the rated flow"
};
std::vector<Assumption> hydraulic_assumptions(const model::Machine& machine);

/// Pressures and spool position at which a piston at rest carries a load.
struct HydraulicRest {
  double p_cap{}, p_rod{};  ///< [Pa]
  double spool{};           ///< x
  bool found{};             ///< false: the supply cannot carry the load
};
/// `force` [N] is what the oil must push with along s. Where closed edges and tight seals leave the
/// pressures open, their sum is taken as that of a leaking valve.
HydraulicRest hydraulic_rest(const ServoAxis& axis, const model::Supply& supply, double force);

/// Both chambers of a cylinder (cap, rod) for small changes about rest, the spool held:
///     C δṗ + G δp = −(A_p, −e A_p) δṡ
struct SmallChambers {
  Eigen::Vector2d capacity{};     ///< diagonal of C [m³/Pa]: oil and the line's wall
  Eigen::Matrix2d conductance{};  ///< G [m³/(s Pa)]: leakage and valve
  Eigen::Vector2d area{};         ///< A_p, −e A_p [m²]
};
SmallChambers small_chambers(const ServoAxis& axis, const model::Supply& supply,
                             const HydraulicRest& rest, double s);

/// Chambers as a spring along s: two springs in parallel, each in series with a damper. The force
/// on the piston for δs is −Σ κ_j iω/(iω + λ_j) δs.
///     (A_p, −e A_p) (C + G/iω)⁻¹ (A_p, −e A_p)ᵀ,  with G u = λ C u, uᵀ C u = 1, κ = (u·a)²
/// A `compliance` 1/k_j [m/N] in series (gimbals) makes C + a aᵀ/k_j of C.
struct RelaxingSpring {
  std::array<double, 2> stiffness{};  ///< κ [N/m]
  std::array<double, 2> rate{};       ///< λ [1/s], 0: a spring alone
  /// What closed chambers have, k_h.
  [[nodiscard]] double closed() const { return stiffness[0] + stiffness[1]; }
};
RelaxingSpring relaxing_spring(const SmallChambers& chambers, double compliance);

}  // namespace hydrapod::hydraulics
