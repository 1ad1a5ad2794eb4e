/// Simulation: the right-hand side of the full plant beside MuJoCo's step of the mechanism alone,
/// and simulated time with an input that changes every millisecond.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

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

/// One second in which white noise moves all six valves every millisecond, seen every millisecond.
class SecondOfNoise {
 public:
  SecondOfNoise(const model::Machine& machine, ModelKind kind)
      : plant_(machine, kind), rest_(plant_.equilibrium(machine.neutral())) {
    constexpr double rms = 0.1;  // of the valves' travel
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal(0.0, rms);
    for (auto& command : commands_)
      for (int i = 0; i < 6; ++i) command[i] = rest_.input.command[i] + normal(engine);
  }

  [[nodiscard]] const Plant& plant() const { return plant_; }

  template <class Seen>
  void operator()(simulation::Integrator& run, Seen seen) const {
    run.start(0.0, rest_.x);
    simulation::PlantInput input = rest_.input;
    for (int k = 1; k <= 1000; ++k) {
      input.command = commands_[static_cast<std::size_t>(k - 1)];
      run.advance(1e-3 * k, input);
      seen(run.state());
    }
  }

  /// Largest error of any state at any sample, in Plant::scales(), against CVODE at 1e-11.
  [[nodiscard]] double error(simulation::Integrator& run) const {
    constexpr double tight = 1e-11;
    simulation::Integrator reference(
        plant_,
        {.method = Method::cvode_adams, .relative_tolerance = tight, .absolute_tolerance = tight});
    std::vector<Eigen::VectorXd> expected;
    (*this)(reference, [&](const Eigen::VectorXd& x) { expected.push_back(x); });
    double largest = 0.0;
    std::size_t k = 0;
    (*this)(run, [&](const Eigen::VectorXd& x) {
      const auto difference = (x - expected[k++]).cwiseQuotient(plant_.scales());
      largest = std::max(largest, difference.lpNorm<Eigen::Infinity>());
    });
    return largest;
  }

 private:
  Plant plant_;
  Plant::Rest rest_;
  std::array<spatial::Vector6, 1000> commands_{};
};

void second_of_noise(benchmark::State& state, const simulation::IntegratorOptions& options,
                     ModelKind kind, const char* name = "zhang-jiang-2021",
                     const std::vector<std::string>& overrides = {}) {
  const SecondOfNoise second(bench::machine(name, overrides), kind);
  simulation::Integrator run(second.plant(), options);
  state.counters["error"] = second.error(run);
  state.counters["steps"] = static_cast<double>(run.statistics().steps);
  state.counters["evaluations"] = static_cast<double>(run.statistics().evaluations);
  for (auto _ : state) second(run, [](const auto&) {});
}

simulation::IntegratorOptions with(Method method, double tolerance) {
  return {.method = method, .relative_tolerance = tolerance, .absolute_tolerance = tolerance};
}

#define SECOND_OF_NOISE(name, ...) \
  BENCHMARK_CAPTURE(second_of_noise, name, __VA_ARGS__)->Unit(benchmark::kMillisecond)

SECOND_OF_NOISE(adaptive_guide, with(Method::adaptive, 1e-5), ModelKind::guide);
// Of exponential_guide and exponential_tight, as near as powers of ten come.
SECOND_OF_NOISE(adaptive_equal_error, with(Method::adaptive, 1e-6), ModelKind::guide);
SECOND_OF_NOISE(adaptive_tight, with(Method::adaptive, 1e-7), ModelKind::guide);
SECOND_OF_NOISE(adaptive_rigid, with(Method::adaptive, 1e-5), ModelKind::rigid);
SECOND_OF_NOISE(exponential_loose, with(Method::exponential, 1e-4), ModelKind::guide);
SECOND_OF_NOISE(exponential_guide, with(Method::exponential, 1e-5), ModelKind::guide);
SECOND_OF_NOISE(exponential_tight, with(Method::exponential, 1e-7), ModelKind::guide);
SECOND_OF_NOISE(exponential_rigid, with(Method::exponential, 1e-5), ModelKind::rigid);
SECOND_OF_NOISE(exponential_heavy, with(Method::exponential, 1e-5), ModelKind::guide,
                "heavy-platform");
SECOND_OF_NOISE(exponential_full, with(Method::exponential, 1e-5), ModelKind::full,
                "zhang-jiang-2021",
                {"legs.piston_ring.stiffness=2 kN/mm", "legs.piston_ring.damping=500 N s/m"});
SECOND_OF_NOISE(fixed_guide, {.method = Method::fixed}, ModelKind::guide);
SECOND_OF_NOISE(cvode_adams_guide, with(Method::cvode_adams, 1e-5), ModelKind::guide);

}  // namespace
