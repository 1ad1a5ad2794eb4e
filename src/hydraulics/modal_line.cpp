/// Lines between valves and chambers by their modes.

#include "hydrapod/hydraulics/modal_line.hpp"

#include <cmath>
#include <numbers>

namespace hydrapod::hydraulics {

namespace {

constexpr double wave_number(int n) { return n * std::numbers::pi; }
constexpr double alternating(int n) { return n % 2 == 0 ? 1.0 : -1.0; }

/// a and b: what all modes have, less what the first ones have.
void set_ends(ModalLine& line) {
  line.own = 1.0 / 3.0;
  line.across = 1.0 / 6.0;
  for (int n = 1; n < line.modes; ++n) {
    const double share = 2.0 / (wave_number(n) * wave_number(n));
    line.own -= share;
    line.across += alternating(n) * share;
  }
}

ModalLine modal(const model::Lines& lines, double density, double length, double volume,
                double compliance) {
  if (lines.modes == 0.0 || length == 0.0) return {};
  const double section = volume / length;
  ModalLine line{
      .modes = static_cast<int>(lines.modes),
      .volume = volume,
      .compliance = compliance,
      .inertance = density * length / section,
      .resistance = 8.0 * std::numbers::pi * lines.viscosity * length / (section * section)};
  set_ends(line);
  return line;
}

void take_out(const ModalLine& line, double& volume, double& compliance) {
  if (line.modes == 0) return;
  volume -= (1.0 - line.with_chamber()) * line.volume;
  compliance = line.with_chamber() * line.compliance;
}

/// Flows at both ends, but for what the ends give way.
struct EndFlows {
  double valve{}, chamber{};
  EndFlows(const ModalLine& line, const double* state) {
    for (int n = 0; n < line.modes; ++n) {
      const double q = state[line.modes + n];
      valve += q;
      chamber += alternating(n) * q;
    }
  }
};

/// ∫ q² dξ.
double mean_square(const ModalLine& line, const double* state) {
  double sum = 0.0;
  for (int n = 0; n < line.modes; ++n) {
    const double q = state[line.modes + n];
    sum += (n == 0 ? 1.0 : 0.5) * q * q;
  }
  return sum;
}

}  // namespace

LegModalLines modal_lines(const model::Machine& machine, int leg) {
  const auto& given = machine.legs[static_cast<std::size_t>(leg)].oil_spring.cylinder;
  if (!given) return {};
  const auto& lines = machine.hydraulics.lines;
  return {modal(lines, given->density, given->cap_line_length, given->cap_line_volume,
                given->cap_line_compliance),
          modal(lines, given->density, given->rod_line_length, given->rod_line_volume,
                given->rod_line_compliance)};
}

void take_out_lines(const LegModalLines& lines, ServoAxis& axis) {
  take_out(lines.cap, axis.volume.cap, axis.cap_line_compliance);
  take_out(lines.rod, axis.volume.rod, axis.rod_line_compliance);
}

double valve_pressure(const ModalLine& line, const double* state, double chamber) {
  return state[0] - line.tilt() * chamber;
}

double chamber_inflow(const ModalLine& line, const double* state, double valve_flow) {
  const EndFlows flows(line, state);
  return flows.chamber - line.tilt() * (valve_flow - flows.valve);
}

void line_rates(const ModalLine& line, const Oil& oil, const double* state, double valve_flow,
                double chamber, double* rates) {
  const int N = line.modes;
  const double capacity = line.volume * compressibility(oil, chamber) + line.compliance;
  const double at_valve = valve_pressure(line, state, chamber);
  const double* q = state + N;
  rates[0] = (valve_flow - EndFlows(line, state).valve) / (line.own * capacity);
  rates[N] = (at_valve - chamber - line.resistance * q[0]) / line.inertance;
  for (int n = 1; n < N; ++n) {
    rates[n] = wave_number(n) * q[n] / capacity;
    rates[N + n] = (2.0 * (at_valve - alternating(n) * chamber) - wave_number(n) * state[n] -
                    line.resistance * q[n]) /
                   line.inertance;
  }
}

void steady_line(const ModalLine& line, double at_valve, double in_chamber, double flow,
                 double* state) {
  const int N = line.modes;
  state[0] = at_valve + line.tilt() * in_chamber;
  state[N] = flow;
  for (int n = 1; n < N; ++n) {
    state[n] = 2.0 * (at_valve - alternating(n) * in_chamber) / wave_number(n);
    state[N + n] = 0.0;
  }
}

double line_kinetic_energy(const ModalLine& line, const double* state) {
  return 0.5 * line.inertance * mean_square(line, state);
}

double line_dissipation(const ModalLine& line, const double* state) {
  return line.resistance * mean_square(line, state);
}

}  // namespace hydrapod::hydraulics
