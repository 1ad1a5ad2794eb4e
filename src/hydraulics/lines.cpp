/// Lines between valves and chambers as chains of segments.

#include <numbers>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

namespace {

SegmentedLine segmented(const model::Lines& lines, double density, double length, double volume,
                        double compliance) {
  if (lines.segments == 0.0 || length == 0.0) return {};
  const double N = lines.segments, section = volume / length;
  return {
      .segments = static_cast<int>(N),
      .volume = volume / N,
      .compliance = compliance / N,
      .inertance = density * length / (section * N),
      .resistance = 8.0 * std::numbers::pi * lines.viscosity * length / (section * section * N)};
}

void take_out(const SegmentedLine& line, double& volume, double& compliance) {
  if (line.segments == 0) return;
  volume -= (line.segments - 0.5) * line.volume;
  compliance = 0.5 * line.compliance;
}

}  // namespace

LegLines segmented_lines(const model::Machine& machine, int leg) {
  const auto& given = machine.legs[static_cast<std::size_t>(leg)].oil_spring.cylinder;
  if (!given) return {};
  const auto& lines = machine.hydraulics.lines;
  return {segmented(lines, given->density, given->cap_line_length, given->cap_line_volume,
                    given->cap_line_compliance),
          segmented(lines, given->density, given->rod_line_length, given->rod_line_volume,
                    given->rod_line_compliance)};
}

void take_out_lines(const LegLines& lines, ServoAxis& axis) {
  take_out(lines.cap, axis.volume.cap, axis.cap_line_compliance);
  take_out(lines.rod, axis.volume.rod, axis.rod_line_compliance);
}

model::Machine without_line_inertia(model::Machine machine) {
  for (auto& leg : machine.legs)
    if (auto& cylinder = leg.oil_spring.cylinder)
      cylinder->cap_line_length = cylinder->rod_line_length = 0.0;
  return machine;
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

}  // namespace hydrapod::hydraulics
