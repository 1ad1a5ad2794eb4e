/// What comes before and around the modes: the file, the equilibrium under gravity, the check.

#include <benchmark/benchmark.h>

#include "hydrapod/dynamics/linear_model.hpp"
#include "machines.hpp"

namespace {

using namespace hydrapod;
using dynamics::ModelKind;

model::Machine heavy() {
  return bench::machine("zhang-jiang-2021-transverse", {"environment.gravity=9.80665"});
}

void read_machine_file(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(bench::published());
}
BENCHMARK(read_machine_file);

void check_machine(benchmark::State& state) {
  const auto machine = bench::published();
  for (auto _ : state) benchmark::DoNotOptimize(kinematics::check_machine(machine));
}
BENCHMARK(check_machine);

void equilibrium(benchmark::State& state) {
  const auto machine = heavy();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        dynamics::static_equilibrium(machine, machine.neutral(), ModelKind::guide));
}
BENCHMARK(equilibrium);

void assembly_with_gravity(benchmark::State& state) {
  const auto machine = heavy();
  for (auto _ : state)
    benchmark::DoNotOptimize(dynamics::linear_model(machine, machine.neutral(), ModelKind::guide));
}
BENCHMARK(assembly_with_gravity);

void buckling_payload(benchmark::State& state) {
  const auto machine = heavy();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        dynamics::buckling_payload(machine, machine.neutral(), ModelKind::guide));
}
BENCHMARK(buckling_payload);

}  // namespace
