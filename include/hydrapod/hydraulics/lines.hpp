#pragma once
/// Lines between valves and chambers whose oil moves by itself: as chains of segments, or by their
/// modes (docs/theory/hydraulics.md, "Waves in lines", "Modes of lines").

#include <variant>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

/// A line between valve and chamber as a chain of N equal segments: oil that moves between nodes
/// that give way. Node 0 is the valve's end and node N the chamber; the nodes at both ends have the
/// oil of half a segment.
///
///     C_j ṗ_j = q_j − q_{j+1},  q_0 = Q of the valve      C_j = V_seg/β(p_j) + c_seg, C_0 half
///     I q̇_j = p_{j−1} − p_j − R q_j                       I = ρ L/(A N),  A = V_line/L
///     R = 8π μ L/(A² N)                                   laminar flow in a round pipe
///
/// Oil moves slowly beside sound: ½ρv² is left out.
struct SegmentedLine {
  int segments{};       ///< N; 0: no line with waves
  double volume{};      ///< V_seg [m³] of a segment
  double compliance{};  ///< c_seg [m³/Pa] of a segment's wall
  double inertance{};   ///< I [kg/m⁴]
  double resistance{};  ///< R [Pa s/m³]
  [[nodiscard]] int states() const { return 2 * segments; }
  /// Of the whole line: what a steady flow loses.
  [[nodiscard]] double loss() const { return segments * resistance; }
};

/// A line between valve and chamber by its own modes.
///
/// The uniform line with ξ = x/L from the valve, whole inertance I, resistance R and capacity C:
///
///     I ∂q/∂t = −∂p/∂ξ − R q,     C ∂p/∂t = −∂q/∂ξ
///     q = q_0 + Σ q_n cos nπξ,     p = Σ P_n sin nπξ inside      n = 1 … N − 1
///
///     I q̇_0 = p_v − p_c − R q_0                                  the column
///     I q̇_n = 2 (p_v − (−1)ⁿ p_c) − nπ P_n − R q_n,   C Ṗ_n = nπ q_n
///
/// p_v and p_c are the pressures at the valve and in the chamber. The modes from N on are taken for
/// slow: they are capacities at the ends, a = Σ 2/(nπ)² of C at each and b = −Σ 2 (−1)ⁿ/(nπ)²
/// between them, so that a slow line has all its oil and a steady one its whole loss:
///
///     C (a ṗ_v + b ṗ_c) = Q − q(0)        q(0) = q_0 + Σ q_n
///     C (b ṗ_v + a ṗ_c) = q(L) − Q_c      q(L) = q_0 + Σ (−1)ⁿ q_n
///
/// With p_w = p_v + (b/a) p_c neither needs the other's rate: a C ṗ_w = Q − q(0), and the chamber,
/// which has the share a − b²/a of the line's oil, gets Q_c = q(L) − (b/a) (Q − q(0)).
///
/// C = V_line/β(p_c) + c_line.
struct ModalLine {
  int modes{};          ///< N with the column; 0: no such line
  double volume{};      ///< V_line [m³]
  double compliance{};  ///< c_line [m³/Pa]
  double inertance{};   ///< I [kg/m⁴]
  double resistance{};  ///< R [Pa s/m³]
  double own{};         ///< a
  double across{};      ///< b
  [[nodiscard]] int states() const { return 2 * modes; }
  /// Of the whole line: what a steady flow loses.
  [[nodiscard]] double loss() const { return resistance; }
  /// b/a; 0 without modes.
  [[nodiscard]] double tilt() const { return modes > 0 ? across / own : 0.0; }
  /// Share of the line's oil that the chamber has.
  [[nodiscard]] double with_chamber() const { return own - tilt() * across; }
};

/// Segments or modes. A line without states has no waves: its oil is the chamber's.
using Line = std::variant<SegmentedLine, ModalLine>;
inline int states(const Line& line) {
  return std::visit([](const auto& one) { return one.states(); }, line);
}
inline double loss(const Line& line) {
  return std::visit([](const auto& one) { return one.loss(); }, line);
}

/// Both lines of a leg, as `machine.hydraulics.lines` and their lengths say.
using LegLines = LinesOf<Line>;
LegLines leg_lines(const model::Machine& machine, int leg);

/// Takes what the lines hold out of the chambers, but for what stays at their ends: half a segment,
/// or ModalLine::with_chamber().
void take_out_lines(const LegLines& lines, ServoAxis& axis);

/// The machine whose legs do not carry the inertia of lines that are dead ends (line_inertia()).
model::Machine without_line_inertia(model::Machine machine);

/// The state of segments is p_0, …, p_{N−1} [Pa], q_1, …, q_N [m³/s]; that of modes p_w, P_1, …,
/// P_{N−1} [Pa], q_0, …, q_{N−1} [m³/s]. `chamber`: its pressure [Pa]; `valve_flow`: Q [m³/s].
///
/// Pressure at the valve [Pa].
double valve_pressure(const SegmentedLine& line, const double* state, double chamber);
double valve_pressure(const ModalLine& line, const double* state, double chamber);
/// Flow into the chamber [m³/s].
double chamber_inflow(const SegmentedLine& line, const double* state, double valve_flow);
double chamber_inflow(const ModalLine& line, const double* state, double valve_flow);
/// Rates of the state.
void line_rates(const SegmentedLine& line, const Oil& oil, const double* state, double valve_flow,
                double chamber, double* rates);
void line_rates(const ModalLine& line, const Oil& oil, const double* state, double valve_flow,
                double chamber, double* rates);
/// The state of a steady flow [m³/s].
void steady_line(const SegmentedLine& line, double at_valve, double in_chamber, double flow,
                 double* state);
void steady_line(const ModalLine& line, double at_valve, double in_chamber, double flow,
                 double* state);
/// What its oil moves with [J]: Σ ½ I q² of segments, ½ I ∫ q² dξ of modes.
double line_kinetic_energy(const SegmentedLine& line, const double* state);
double line_kinetic_energy(const ModalLine& line, const double* state);
/// What it loses [W]: Σ R q², R ∫ q² dξ.
double line_dissipation(const SegmentedLine& line, const double* state);
double line_dissipation(const ModalLine& line, const double* state);

}  // namespace hydrapod::hydraulics
