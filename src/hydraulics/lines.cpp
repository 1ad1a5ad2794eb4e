/// Lines between valves and chambers: chains of segments, and modes.

#include "hydrapod/hydraulics/lines.hpp"

#include <cmath>
#include <numbers>

namespace hydrapod::hydraulics {

namespace {

/// What a line is, whatever model it has.
struct Pipe {
  double density{}, length{}, volume{}, compliance{}, viscosity{};
  [[nodiscard]] double section() const { return volume / length; }
  /// Of the N-th part of it.
  [[nodiscard]] double inertance(double N = 1.0) const {
    return density * length / (section() * N);
  }
  [[nodiscard]] double resistance(double N = 1.0) const {
    return 8.0 * std::numbers::pi * viscosity * length / (section() * section() * N);
  }
};

SegmentedLine segmented(const Pipe& pipe, double N) {
  return {.segments = static_cast<int>(N),
          .volume = pipe.volume / N,
          .compliance = pipe.compliance / N,
          .inertance = pipe.inertance(N),
          .resistance = pipe.resistance(N)};
}

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

ModalLine modal(const Pipe& pipe, double N) {
  ModalLine line{.modes = static_cast<int>(N),
                 .volume = pipe.volume,
                 .compliance = pipe.compliance,
                 .inertance = pipe.inertance(),
                 .resistance = pipe.resistance()};
  set_ends(line);
  return line;
}

/// Of a line's oil and wall, the parts that stay with the chamber.
void take_out(const SegmentedLine& line, double& volume, double& compliance) {
  if (line.segments == 0) return;
  volume -= (line.segments - 0.5) * line.volume;
  compliance = 0.5 * line.compliance;
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

LegLines leg_lines(const model::Machine& machine, int leg) {
  const auto& given = machine.legs[static_cast<std::size_t>(leg)].oil_spring.cylinder;
  if (!given) return {};
  const auto& of = machine.hydraulics.lines;
  const auto line = [&](double length, double volume, double compliance) -> Line {
    const Pipe pipe{given->density, length, volume, compliance, of.viscosity};
    if (length > 0.0 && of.modes > 0.0) return modal(pipe, of.modes);
    if (length > 0.0 && of.segments > 0.0) return segmented(pipe, of.segments);
    return {};
  };
  return {line(given->cap_line_length, given->cap_line_volume, given->cap_line_compliance),
          line(given->rod_line_length, given->rod_line_volume, given->rod_line_compliance)};
}

void take_out_lines(const LegLines& lines, ServoAxis& axis) {
  std::visit([&](const auto& line) { take_out(line, axis.volume.cap, axis.cap_line_compliance); },
             lines.cap);
  std::visit([&](const auto& line) { take_out(line, axis.volume.rod, axis.rod_line_compliance); },
             lines.rod);
}

model::Machine without_line_inertia(model::Machine machine) {
  for (auto& leg : machine.legs)
    if (auto& cylinder = leg.oil_spring.cylinder)
      cylinder->cap_line_length = cylinder->rod_line_length = 0.0;
  return machine;
}

double valve_pressure(const SegmentedLine&, const double* state, double) { return state[0]; }

double chamber_inflow(const SegmentedLine& line, const double* state, double) {
  return state[line.states() - 1];
}

void line_rates(const SegmentedLine& line, const Oil& oil, const double* state, double valve_flow,
                double chamber, double* rates) {
  const int N = line.segments;
  const double* p = state;
  const double* q = state + N;
  for (int j = 0; j < N; ++j) {
    const double share = j == 0 ? 0.5 : 1.0;
    const double capacity = share * (line.volume * compressibility(oil, p[j]) + line.compliance);
    const double in = j == 0 ? valve_flow : q[j - 1], next = j + 1 < N ? p[j + 1] : chamber;
    rates[j] = (in - q[j]) / capacity;
    rates[N + j] = (p[j] - next - line.resistance * q[j]) / line.inertance;
  }
}

double line_kinetic_energy(const SegmentedLine& line, const double* state) {
  double energy = 0.0;
  for (int j = line.segments; j < line.states(); ++j)
    energy += 0.5 * line.inertance * state[j] * state[j];
  return energy;
}

double line_dissipation(const SegmentedLine& line, const double* state) {
  double loss = 0.0;
  for (int j = line.segments; j < line.states(); ++j) loss += line.resistance * state[j] * state[j];
  return loss;
}

/// Its pressure falls evenly from the valve to the chamber.
void steady_line(const SegmentedLine& line, double at_valve, double in_chamber, double flow,
                 double* state) {
  for (int j = 0; j < line.segments; ++j) {
    state[j] = at_valve + (in_chamber - at_valve) * j / line.segments;
    state[line.segments + j] = flow;
  }
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
