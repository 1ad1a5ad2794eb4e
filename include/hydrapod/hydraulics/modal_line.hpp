#pragma once
/// A line between valve and chamber by its own modes (docs/theory/hydraulics.md, "Modes of lines").
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

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

struct ModalLine {
  int modes{};          ///< N with the column; 0: no such line
  double volume{};      ///< V_line [m³]
  double compliance{};  ///< c_line [m³/Pa]
  double inertance{};   ///< I [kg/m⁴]
  double resistance{};  ///< R [Pa s/m³]
  double own{};         ///< a
  double across{};      ///< b
  [[nodiscard]] int states() const { return 2 * modes; }
  [[nodiscard]] double loss() const { return resistance; }
  /// b/a; 0 without modes.
  [[nodiscard]] double tilt() const { return modes > 0 ? across / own : 0.0; }
  /// Share of the line's oil that the chamber has.
  [[nodiscard]] double with_chamber() const { return own - tilt() * across; }
};
using LegModalLines = LinesOf<ModalLine>;
/// Both lines of a leg; without modes where `machine.hydraulics.lines` or the length says so.
LegModalLines modal_lines(const model::Machine& machine, int leg);

/// Takes what the lines hold out of the chambers, but for ModalLine::with_chamber().
void take_out_lines(const LegModalLines& lines, ServoAxis& axis);

/// p_v [Pa] of the state p_w, P_1, …, P_{N−1} [Pa], q_0, …, q_{N−1} [m³/s], the chamber's pressure
/// being `chamber`.
double valve_pressure(const ModalLine& line, const double* state, double chamber);
/// Q_c [m³/s], with `valve_flow` Q.
double chamber_inflow(const ModalLine& line, const double* state, double valve_flow);
/// Rates of the state.
void line_rates(const ModalLine& line, const Oil& oil, const double* state, double valve_flow,
                double chamber, double* rates);
/// The state of a steady flow [m³/s].
void steady_line(const ModalLine& line, double at_valve, double in_chamber, double flow,
                 double* state);
/// ½ I ∫ q² dξ [J] and R ∫ q² dξ [W].
double line_kinetic_energy(const ModalLine& line, const double* state);
double line_dissipation(const ModalLine& line, const double* state);

}  // namespace hydrapod::hydraulics
