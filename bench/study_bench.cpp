/// Rows of studies: designs in SIMD lanes, and whole rows from the plan to the outputs.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>

#include "hydrapod/study/study.hpp"
#include "machines.hpp"
#include "study/lane_designs.hpp"
#include "study/lane_machine.hpp"

namespace {

using namespace hydrapod;
using dynamics::ModelKind;

/// The machine with guide sleeves that differ by some per cent, as samples of a study do.
model::Machine published(bool gravity) {
  return gravity ? bench::machine("zhang-jiang-2021-transverse", {"environment.gravity=9.80665"})
                 : bench::published();
}

model::Machine scattered(model::Machine machine, int design) {
  for (int i = 0; i < model::leg_count; ++i)
    machine.legs[i].guide_sleeve.stiffness *= 1.0 + 0.03 * std::sin(1.7 * (6 * design + i + 1));
  return machine;
}

enum class Outputs { all, frequencies };

/// Time per design, equilibrium from that of the nominal machine included. Frequencies and main
/// directions alone need all shapes too, but no modes with rigid legs and none that are followed.
void lanes(benchmark::State& state, bool gravity, Outputs outputs) {
  const auto machine = published(gravity);
  const auto& X_BP = machine.neutral();
  const auto flexible = dynamics::linear_model(machine, X_BP, ModelKind::guide),
             rigid = dynamics::linear_model(machine, X_BP, ModelKind::rigid);
  const auto modes = modal::normal_modes(flexible);
  const bool all = outputs == Outputs::all;
  const dynamics::ModelMatrix followed = modes.shapes.leftCols(all ? 6 : 0);
  auto options = study::lane_options(machine, 0.05);
  options.rigid = all;
  study::LaneDesigns designs(study::usable_kernels().front(), ModelKind::guide, options, followed);
  for (int lane = 0; lane < designs.lanes(); ++lane)
    designs.put(lane, study::lane_numbers(scattered(machine, lane), X_BP, &flexible.statics,
                                          &rigid.statics));
  while (state.KeepRunningBatch(designs.lanes())) {
    designs.solve(designs.lanes());
    benchmark::ClobberMemory();
  }
  for (int lane = 0; lane < designs.lanes(); ++lane)
    if (!designs.sound(lane)) state.SkipWithError("a design had to be computed alone");
}
BENCHMARK_CAPTURE(lanes, designs, false, Outputs::all);
BENCHMARK_CAPTURE(lanes, designs_gravity, true, Outputs::all);
BENCHMARK_CAPTURE(lanes, labels, false, Outputs::frequencies);
BENCHMARK_CAPTURE(lanes, labels_gravity, true, Outputs::frequencies);

/// Their frequencies without shapes, the kernel alone.
void lane_frequencies(benchmark::State& state, bool gravity) {
  const auto machine = published(gravity);
  study::LaneDesigns designs(study::usable_kernels().front(), ModelKind::guide,
                             study::lane_options(machine, 0.05), {});
  for (int lane = 0; lane < designs.lanes(); ++lane)
    designs.put(lane,
                study::lane_numbers(scattered(machine, lane), machine.neutral(), nullptr, nullptr));
  while (state.KeepRunningBatch(designs.lanes())) {
    designs.solve_frequencies(designs.lanes());
    benchmark::ClobberMemory();
  }
  std::array<double, study::most_modes> omega2{};
  for (int lane = 0; lane < designs.lanes(); ++lane)
    if (!designs.frequencies(lane, omega2.data()))
      state.SkipWithError("a design had to be computed alone");
}
BENCHMARK_CAPTURE(lane_frequencies, designs, false);
BENCHMARK_CAPTURE(lane_frequencies, designs_gravity, true);

/// From numbers to frequencies, as from Python.
void design_frequencies(benchmark::State& state, bool gravity) {
  const auto machine = published(gravity);
  const auto id = *model::find_parameter(machine, "legs.guide_sleeve.stiffness");
  study::DesignFrequencies frequencies(machine, machine.neutral(), ModelKind::guide, {id});
  constexpr std::size_t count = 64;
  std::array<double, count> values{};
  for (std::size_t k = 0; k < count; ++k)
    values[k] = machine.legs[0].guide_sleeve.stiffness * (0.9 + 0.003 * static_cast<double>(k));
  std::array<double, count * 18> omega{};
  while (state.KeepRunningBatch(count)) {
    frequencies(values, omega);
    benchmark::ClobberMemory();
  }
}
BENCHMARK_CAPTURE(design_frequencies, machine, false);
BENCHMARK_CAPTURE(design_frequencies, machine_gravity, true);

/// The same designs one at a time, without the outputs of a row.
void one_at_a_time(benchmark::State& state, bool gravity) {
  const auto nominal = published(gravity);
  const auto machine = scattered(nominal, 1);
  const auto& X_BP = machine.neutral();
  const auto start = dynamics::linear_model(nominal, X_BP, ModelKind::guide),
             start_rigid = dynamics::linear_model(nominal, X_BP, ModelKind::rigid);
  for (auto _ : state) {
    const auto flexible = dynamics::linear_model(machine, X_BP, ModelKind::guide, &start.statics);
    const auto rigid =
        dynamics::linear_model(machine, X_BP, ModelKind::rigid, &start_rigid.statics);
    benchmark::DoNotOptimize(modal::normal_modes(flexible));
    benchmark::DoNotOptimize(modal::normal_modes(rigid));
  }
}
BENCHMARK_CAPTURE(one_at_a_time, designs, false);
BENCHMARK_CAPTURE(one_at_a_time, designs_gravity, true);

void evaluate(benchmark::State& state, const study::Problem& problem) {
  study::Evaluator evaluator(problem);
  constexpr std::size_t count = 64;
  std::vector<double> numbers(count * (problem.inputs.size() + problem.outputs.size()));
  std::uint64_t first = 0;
  while (state.KeepRunningBatch(count)) {
    if (evaluator.rows({.samples = 1U << 30U}, first, numbers) > 0)
      state.SkipWithError("a row had to be computed alone");
    first += count;
  }
}

/// Rows of `hydrapod montecarlo` with the guide sleeves varied per leg, files excluded.
void rows(benchmark::State& state, bool gravity, Outputs outputs) {
  model::MachineFile file;
  file.machine = published(gravity);
  const auto inputs =
      study::read_variation(file, "legs.guide_sleeve.stiffness", "normal ± 3 % per leg", "");
  study::MachineOptions options{.kind = ModelKind::guide, .X_BP = file.machine.neutral()};
  if (outputs == Outputs::frequencies)
    options.only = {"lowest", "direction", "x", "y", "z", "rx", "ry", "rz"};
  evaluate(state, study::machine_problem(file.machine, inputs, options));
}
BENCHMARK_CAPTURE(rows, study, false, Outputs::all);
BENCHMARK_CAPTURE(rows, study_gravity, true, Outputs::all);
BENCHMARK_CAPTURE(rows, labels, false, Outputs::frequencies);
BENCHMARK_CAPTURE(rows, labels_gravity, true, Outputs::frequencies);

/// Poses of `hydrapod map` over x, y and rz, files excluded.
void poses(benchmark::State& state) {
  const auto machine = bench::published();
  std::vector<study::Input> inputs;
  for (const auto& [name, reach] : {std::pair{"x", 0.05}, {"y", 0.05}, {"rz", 0.1}})
    inputs.push_back(
        {.name = name, .distribution = {.shape = study::Shape::uniform, .a = -reach, .b = reach}});
  const auto problem = study::machine_problem(
      machine, inputs, {.kind = ModelKind::guide, .X_BP = machine.neutral(), .poses = true});
  evaluate(state, problem);
}
BENCHMARK(poses);

}  // namespace
