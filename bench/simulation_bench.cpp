/// Simulation: the right-hand side of the full plant beside MuJoCo's step of the mechanism alone,
/// and simulated time with an input that changes every millisecond.

#include <benchmark/benchmark.h>

#include <random>

#include "hydrapod/simulation/closed_loop.hpp"
#include "machines.hpp"
#include "support/mujoco_hexapod.hpp"

namespace {

using namespace hydrapod;
using simulation::Method;
using simulation::ModelKind;
using simulation::Plant;

/// The published machine under gravity.
model::Machine heavy() {
  return bench::machine("zhang-jiang-2021", {"environment.gravity=9.80665"});
}

/// 18 mechanical degrees of freedom, 12 pressures, 12 spool states.
void plant_derivative(benchmark::State& state) {
  const Plant plant(heavy(), ModelKind::guide);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  Eigen::VectorXd rate(plant.layout().size);
  for (auto _ : state) {
    benchmark::DoNotOptimize(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
    benchmark::DoNotOptimize(rate.data());
  }
}
BENCHMARK(plant_derivative);

void plant_linearise(benchmark::State& state) {
  const Plant plant(heavy(), ModelKind::guide);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  for (auto _ : state) benchmark::DoNotOptimize(plant.linearise(rest.x, rest.input));
}
BENCHMARK(plant_linearise);

/// Kinematics, mass matrix, constraint forces and one Euler step of the same mechanism, without
/// seals, friction or hydraulics.
void mujoco_step(benchmark::State& state) {
  test::MujocoHexapod hexapod(heavy(), heavy().neutral(), ModelKind::guide);
  for (auto _ : state) hexapod.step_and_return();
}
BENCHMARK(mujoco_step);

/// One second in which white noise moves all six valves every millisecond.
void second_of_noise(benchmark::State& state, Method method, ModelKind kind) {
  constexpr double rms = 0.1;  // of the valves' travel
  const Plant plant(bench::published(), kind);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  simulation::Integrator run(plant, {.method = method});
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0.0, rms);
  simulation::PlantInput input = rest.input;
  for (auto _ : state) {
    run.start(0.0, rest.x);
    for (int k = 1; k <= 1000; ++k) {
      for (int i = 0; i < 6; ++i) input.command[i] = rest.input.command[i] + normal(engine);
      run.advance(1e-3 * k, input);
    }
  }
}
BENCHMARK_CAPTURE(second_of_noise, adaptive_guide, Method::adaptive, ModelKind::guide)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(second_of_noise, adaptive_rigid, Method::adaptive, ModelKind::rigid)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(second_of_noise, fixed_guide, Method::fixed, ModelKind::guide)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(second_of_noise, cvode_adams_guide, Method::cvode_adams, ModelKind::guide)
    ->Unit(benchmark::kMillisecond);

}  // namespace
