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
///
/// Laws that a simulation evaluates are templates: of one leg (double), or of all legs at once
/// (numerics::Lanes), which takes a third of the time.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "hydrapod/model/machine.hpp"
#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::hydraulics {

inline constexpr double atmospheric_pressure = 101325.0;  ///< p_0 [Pa]

/// β_e [Pa] with the air that `cylinder` carries.
double effective_bulk_modulus(const model::Cylinder& cylinder);

template <class Scalar>
struct CylinderAreasOf {
  Scalar piston{};                                                 ///< A_p [m²]
  Scalar annulus{};                                                ///< e A_p [m²]
  [[nodiscard]] Scalar ratio() const { return annulus / piston; }  ///< e
};
using CylinderAreas = CylinderAreasOf<double>;
CylinderAreas areas(const model::Cylinder& cylinder);

template <class Scalar>
struct ChamberVolumesOf {
  Scalar cap{};  ///< V_1 [m³]
  Scalar rod{};  ///< V_2 [m³]
};
using ChamberVolumes = ChamberVolumesOf<double>;
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

/// k_h [N/m] of `leg` with the piston at `l_m` [m] from the base joint; k of a strut, k_a of a
/// screw. Throws std::invalid_argument when the leg has no oil spring or lacks the stroke that it
/// needs.
double oil_stiffness(const model::Leg& leg, double l_m);

/// What holds a leg along its axis: the oil spring, the strut or the screw with seals that stick
/// beside it, and in series compliant gimbals.
struct AxialSpring {
  double stiffness{};  ///< (k_h + k_b) k_j / (k_h + k_b + k_j) [N/m]
  /// c_h (k_j / (k_h + k_b + k_j))² [N s/m]: the share of the motion that the oil's damper sees, as long
  /// as the damper's force is small beside the spring's.
  double damping{};
};
AxialSpring axial_spring(const model::Leg& leg, double l_m);

/// A liquid with everything resolved; made by servo_axis().
template <class Scalar>
struct OilOf {
  Scalar bulk_modulus{};         ///< β [Pa] without air
  Scalar air_fraction{};         ///< α
  Scalar air_exponent{1.4};      ///< n
  Scalar cavitation_pressure{};  ///< p_c [Pa]
};
using Oil = OilOf<double>;

/// An argument that does not say which Scalar a law is evaluated with.
template <class Scalar>
using Given = std::type_identity_t<const Scalar&>;

/// Compressibility 1/β(p) [1/Pa] at the absolute pressure `p` [Pa].
template <class Scalar>
Scalar compressibility(const OilOf<Scalar>& oil, Given<Scalar> p) {
  using numerics::any_less;
  using std::exp, std::pow, std::max;
  const Scalar widths = 40.0;     // from here on vapour is lost in rounding
  constexpr double share = 1e-3;  // of the chamber, at the cavitation pressure
  const Scalar width = oil.cavitation_pressure / 10.0;
  Scalar sum = 1.0 / oil.bulk_modulus;
  if (any_less(Scalar(0.0), oil.air_fraction)) {
    // Below the cavitation pressure the air is taken to stay as it is there.
    const Scalar at = max(p, oil.cavitation_pressure);
    const Scalar x =
        oil.air_fraction * pow(Scalar(atmospheric_pressure / at), Scalar(1.0 / oil.air_exponent));
    const Scalar liquid = 1.0 - oil.air_fraction;
    sum = (liquid / oil.bulk_modulus + x / (oil.air_exponent * at)) / (liquid + x);
  }
  const Scalar above = (p - oil.cavitation_pressure) / width;
  return any_less(above, widths) ? Scalar(sum + share * exp(Scalar(-above)) / width) : sum;
}

/// Friction with everything resolved; made by servo_axis().
template <class Scalar>
struct FrictionOf {
  Scalar coulomb{};              ///< F_c [N]
  Scalar breakaway{};            ///< F_s [N]
  Scalar stribeck_velocity{1};   ///< v_s [m/s]
  Scalar smoothing_velocity{1};  ///< v_0 [m/s] of tanh(v / v_0); not used with bristles
  Scalar viscous{};              ///< b [N s/m]
  Scalar bristle_stiffness{};    ///< σ0 [N/m]; 0: the smooth law
  Scalar bristle_damping{};      ///< σ1 [N s/m]

  [[nodiscard]] bool has_bristles() const {
    return numerics::any_less(Scalar(0.0), bristle_stiffness);
  }
};
using Friction = FrictionOf<double>;

/// g(v) [N]: what sliding takes at the velocity `v`.
template <class Scalar>
Scalar sliding_force(const FrictionOf<Scalar>& friction, Given<Scalar> v) {
  using std::exp;
  if (!numerics::any_less(friction.coulomb, friction.breakaway) &&
      !numerics::any_less(friction.breakaway, friction.coulomb))
    return friction.coulomb;
  const Scalar ratio = v / friction.stribeck_velocity;
  return friction.coulomb + (friction.breakaway - friction.coulomb) * exp(Scalar(-ratio * ratio));
}

/// F [N] of the smooth law.
template <class Scalar>
Scalar smooth_friction(const FrictionOf<Scalar>& friction, Given<Scalar> v) {
  using std::tanh;
  if (!numerics::any_less(Scalar(0.0), friction.breakaway)) return friction.viscous * v;
  return sliding_force(friction, v) * tanh(Scalar(v / friction.smoothing_velocity)) +
         friction.viscous * v;
}

/// ż [m/s] and F [N] of bristles bent by `z` [m].
template <class Scalar>
struct BristleFrictionOf {
  Scalar rate{}, force{};
};
template <class Scalar>
BristleFrictionOf<Scalar> bristle_friction(const FrictionOf<Scalar>& friction, Given<Scalar> v,
                                           Given<Scalar> z) {
  using std::abs;
  const Scalar sliding = sliding_force(friction, v);
  const Scalar rate = numerics::where_less(
      Scalar(0.0), sliding, v - friction.bristle_stiffness * abs(v) * z / sliding, Scalar(0.0));
  return {rate,
          friction.bristle_stiffness * z + friction.bristle_damping * rate + friction.viscous * v};
}

/// A spring and a damper that stand for a force f(x, ẋ) which is not linear, for the motion x = A
/// cos ωt (harmonic balance, docs/theory/amplitude.md): the part of f at ω is k A cos ωt − c ω A
/// sin ωt.
struct Equivalent {
  double stiffness{};  ///< k [N/m]
  double damping{};    ///< c [N s/m]
};

/// Of the friction of a cylinder's seals along the leg at the amplitude A [m] > 0 and ω [rad/s]:
/// bristles, which are a spring while they stick, or the smooth law. Its viscous part is left out.
/// Of a joint, with N m and rad in the place of N and m.
Equivalent friction_equivalent(Friction friction, double amplitude, double omega);

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
template <class Scalar>
struct ValveOf {
  Scalar gain{};              ///< K [m³/(s √Pa)] at full opening
  Scalar overlap{};           ///< x_o
  Scalar rounding{};          ///< ε
  Scalar laminar_pressure{};  ///< p_t [Pa]
  Scalar natural_frequency{};
  Scalar damping_ratio{};
  Scalar rate_limit{};
};
using Valve = ValveOf<double>;

/// q(Δp) [√Pa].
template <class Scalar>
Scalar orifice(const Scalar& drop, Given<Scalar> laminar_pressure) {
  using std::sqrt;
  return drop / sqrt(sqrt(Scalar(drop * drop + laminar_pressure * laminar_pressure)));
}

/// ∂q/∂Δp.
inline double orifice_slope(double drop, double laminar_pressure) {
  const double square = drop * drop + laminar_pressure * laminar_pressure;
  return (0.5 * drop * drop + laminar_pressure * laminar_pressure) /
         (square * std::sqrt(std::sqrt(square)));
}

/// o(x).
template <class Scalar>
Scalar opening(const ValveOf<Scalar>& valve, Given<Scalar> x) {
  using std::sqrt;
  const Scalar over = x - valve.overlap;
  return 0.5 * (over + sqrt(Scalar(over * over + valve.rounding * valve.rounding)));
}

/// ∂o/∂x; one half at a sharp corner.
inline double opening_slope(const Valve& valve, double x) {
  const double over = x - valve.overlap;
  const double root = std::sqrt(over * over + valve.rounding * valve.rounding);
  return root > 0.0 ? 0.5 * (1.0 + over / root) : 0.5;
}

/// Pressures around a valve [Pa].
template <class Scalar>
struct PortPressuresOf {
  Scalar supply{}, back{}, cap{}, rod{};
};
using PortPressures = PortPressuresOf<double>;

/// Flows of a valve [m³/s]: into both chambers, out of the supply, into the return.
template <class Scalar>
struct PortFlowsOf {
  Scalar cap{}, rod{}, supply{}, back{};
};
using PortFlows = PortFlowsOf<double>;

/// Flows at spool position `x`; beyond full travel nothing opens further.
template <class Scalar>
PortFlowsOf<Scalar> valve_flows(const ValveOf<Scalar>& valve, Given<Scalar> x,
                                std::type_identity_t<const PortPressuresOf<Scalar>&> p) {
  using std::clamp;
  const Scalar at = clamp(x, Scalar(-1.0), Scalar(1.0));
  const Scalar open_forward = valve.gain * opening(valve, at);
  const Scalar open_backward = valve.gain * opening(valve, Scalar(-at));
  const auto through = [&](const Scalar& open, const Scalar& drop) -> Scalar {
    return open * orifice(drop, valve.laminar_pressure);
  };
  const Scalar supply_cap = through(open_forward, p.supply - p.cap);
  const Scalar cap_back = through(open_backward, p.cap - p.back);
  const Scalar supply_rod = through(open_backward, p.supply - p.rod);
  const Scalar rod_back = through(open_forward, p.rod - p.back);
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
template <class Scalar>
Scalar spool_acceleration(const ValveOf<Scalar>& valve, Given<Scalar> x, Given<Scalar> rate,
                          Given<Scalar> command) {
  using std::clamp;
  const Scalar aim = 0.5 * valve.natural_frequency / valve.damping_ratio *
                     (clamp(command, Scalar(-1.0), Scalar(1.0)) - x);
  return 2.0 * valve.damping_ratio * valve.natural_frequency *
         (clamp(aim, Scalar(-valve.rate_limit), valve.rate_limit) - rate);
}

/// Stops at both ends: against a piston δ beyond an end, N = k δ (1 + d δ̇), never pulling.
template <class Scalar>
struct StopsOf {
  Scalar low{}, high{};  ///< [m] piston positions s where they touch
  Scalar stiffness{};    ///< k [N/m]
  Scalar damping{};      ///< d [s/m]
};
using Stops = StopsOf<double>;

/// Force of the stops on the piston along s [N].
template <class Scalar>
Scalar stop_force(const StopsOf<Scalar>& stops, Given<Scalar> s, Given<Scalar> rate) {
  using std::max;
  const Scalar none = 0.0;
  if (!numerics::any_less(s, stops.low) && !numerics::any_less(stops.high, s)) return none;
  const Scalar in = max(Scalar(stops.low - s), none), out = max(Scalar(s - stops.high), none);
  return max(none, Scalar(stops.stiffness * in * (1.0 - stops.damping * rate))) -
         max(none, Scalar(stops.stiffness * out * (1.0 + stops.damping * rate)));
}

template <class Scalar>
struct ServoAxisOf {
  CylinderAreasOf<Scalar> area{};     ///< A_p, e A_p [m²]
  ChamberVolumesOf<Scalar> volume{};  ///< V_1, V_2 [m³] with the piston at s_mid
  Scalar s_mid{};                     ///< [m] from the base joint
  Scalar smallest_volume{};           ///< [m³] chambers are never taken for smaller
  Scalar cap_line_compliance{}, rod_line_compliance{};  ///< [m³/Pa] of the lines' walls
  OilOf<Scalar> oil{};
  ValveOf<Scalar> valve{};
  Scalar internal_leakage{};  ///< [m³/(s Pa)]
  Scalar external_leakage{};  ///< [m³/(s Pa)]
  FrictionOf<Scalar> friction{};
  StopsOf<Scalar> stops{};

  /// V_1 and V_2 [m³] with the piston at `s` [m].
  [[nodiscard]] ChamberVolumesOf<Scalar> volumes(const Scalar& s) const {
    using std::max;
    return {max(Scalar(volume.cap + area.piston * (s - s_mid)), smallest_volume),
            max(Scalar(volume.rod - area.annulus * (s - s_mid)), smallest_volume)};
  }
  /// Force of the oil on the piston [N] along s (it pushes the leg out), the air's on the rod taken
  /// off.
  [[nodiscard]] Scalar force(const Scalar& p_cap, const Scalar& p_rod) const {
    return p_cap * area.piston - p_rod * area.annulus -
           atmospheric_pressure * (area.piston - area.annulus);
  }
};
using ServoAxis = ServoAxisOf<double>;

/// All legs side by side.
ServoAxisOf<numerics::Lanes> side_by_side(const std::array<ServoAxis, model::leg_count>& axes);

/// Throws base::InputError for legs that nothing drives, which are plain struts.
void require_actuators(const model::Machine& machine);

/// Throws base::InputError for legs without valves and oil: what is asked needs hydraulics.
void require_hydraulics(const model::Machine& machine);

/// The end stops of a leg without hydraulics: those of its stroke, with the default stiffness of 20
/// times axial_spring(); at infinity where it has no stroke.
Stops mechanical_stops(const model::Leg& leg);

/// Leg `i` (from 0). The machine must be sound (model::validate). Throws as require_hydraulics().
ServoAxis servo_axis(const model::Machine& machine, int i);

/// What was assumed, for people: one entry for all legs where they agree.
struct Assumption {
  std::string key{};   ///< the key that would say it, for instance "legs.valve.rated_flow"
  std::string text{};  ///< "29.1 l/min: 0.5 m/s at the rated flow"
};
/// None for legs without hydraulics.
std::vector<Assumption> hydraulic_assumptions(const model::Machine& machine);

/// One of each for the lines of both chambers.
template <class Line>
struct LinesOf {
  Line cap{}, rod{};
};

/// Pressures and spool position at which a piston at rest carries a load.
struct HydraulicRest {
  double p_cap{}, p_rod{};           ///< [Pa]
  LinesOf<double> valve_pressure{};  ///< [Pa] at the valve's ends of the lines
  double spool{};                    ///< x
  bool found{};                      ///< false: the supply cannot carry the load
};
/// `force` [N] is what the oil must push with along s. Where closed edges and tight seals leave the
/// pressures open, their sum is taken as that of a leaking valve. `line_loss` [Pa s/m³]: what the
/// leakage loses in the lines.
HydraulicRest hydraulic_rest(const ServoAxis& axis, const model::Supply& supply, double force,
                             const LinesOf<double>& line_loss = {});

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
