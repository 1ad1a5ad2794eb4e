/// One sample of the controller, forward kinematics included, a second of the closed loop, and a
/// second of the same with packets, as in real time.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <random>

#include "hydrapod/realtime/realtime.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "machines.hpp"

namespace {

using namespace hydrapod;
using spatial::Vector6;

constexpr int sample_count = 1000;

/// A second of a motion of 10 mm and 1° at 2 Hz as sensors show it, with some noise.
struct Samples {
  model::Machine machine = bench::published();
  control::ControllerParameters parameters =
      simulation::tune_controller(machine, machine.neutral()).parameters;
  std::vector<control::Measurement> measured;
  std::vector<control::Command> commands;

  Samples() {
    std::mt19937_64 generator(20210316);
    std::normal_distribution<double> noise;
    signals::Signal sine{.form = signals::Sine{2.0}, .fade = 0.0};
    sine.size << 0.01, 0.01, 0.01, 0.017, 0.017, 0.017;
    signals::Generator motion({sine}, 1e3);
    for (int k = 0; k < sample_count; ++k) {
      commands.push_back(simulation::command_at(machine.neutral(), motion.next()));
      control::Measurement sample;
      sample.length = kinematics::leg_lengths(machine, commands.back().X_BP);
      for (int i = 0; i < 6; ++i) {
        sample.length[i] += 2e-6 * noise(generator);
        sample.cap_pressure[i] = 5e6 + 5e3 * noise(generator);
        sample.rod_pressure[i] = 8e6 + 5e3 * noise(generator);
      }
      measured.push_back(sample);
    }
  }
};

void tick(benchmark::State& state, model::ControlSpace space, bool warm) {
  Samples samples;
  samples.parameters.space = space;
  control::Controller controller(samples.machine, samples.parameters);
  controller.reset(samples.machine.neutral(), samples.measured[0]);
  size_t k = 0;
  for (auto _ : state) {
    if (!warm) controller.reset(samples.machine.neutral(), samples.measured[k]);
    benchmark::DoNotOptimize(controller.step(samples.measured[k], samples.commands[k]));
    if (controller.state().forward != kinematics::ForwardStatus::converged)
      state.SkipWithError("no pose");
    k = (k + 1) % sample_count;
  }
}
BENCHMARK_CAPTURE(tick, pose, model::ControlSpace::pose, true);
BENCHMARK_CAPTURE(tick, pose_from_neutral, model::ControlSpace::pose, false);
BENCHMARK_CAPTURE(tick, leg, model::ControlSpace::leg, true);

/// Default tolerances, sensors and controller; noise of 1 mm and 0.1° in all six directions.
void closed_loop_second(benchmark::State& state) {
  const auto machine = bench::published();
  simulation::ClosedLoop loop(machine, machine.neutral(), {.until = 1.0});
  signals::Signal noise{.form = signals::Noise{.to = 20.0}};
  noise.size << 1e-3, 1e-3, 1e-3, 1.7e-3, 1.7e-3, 1.7e-3;
  signals::Generator generator({noise}, 1.0 / loop.parameters().sample_time);
  for (auto _ : state) {
    generator.restart();
    const auto summary = loop.run(simulation::command_source(generator), {});
    if (summary.end != simulation::RunEnd::finished) state.SkipWithError("run ended early");
  }
}
BENCHMARK(closed_loop_second)->Unit(benchmark::kMillisecond);

/// What `hydrapod serve` does in a thousand samples, but for the calls of the system: sensors into
/// a packet, a command out of one.
void served_second(benchmark::State& state, const simulation::IntegratorOptions& integrator) {
  const auto machine = bench::published();
  simulation::ClosedLoop loop(machine, machine.neutral(), {.integrator = integrator, .until = 1.0});
  const auto layout = realtime::native_layout(9);
  signals::Signal noise{.form = signals::Noise{.to = 20.0}};
  noise.size << 1e-3, 1e-3, 1e-3, 1.7e-3, 1.7e-3, 1.7e-3;
  signals::Generator generator({noise}, 1.0 / loop.parameters().sample_time);
  std::array<std::byte, realtime::largest_packet> command_bytes, sensor_bytes;
  for (auto _ : state) {
    generator.restart();
    const auto summary = loop.run_with(
        [&](const simulation::SampledMachine& at, simulation::Excitation& excitation) {
          const auto out = at.plant.outputs(at.x.data(), at.input);
          realtime::Sensors sensors;
          sensors.length = at.measured.length;
          sensors.acceleration = out.acceleration;
          benchmark::DoNotOptimize(realtime::encode(layout, sensors, sensor_bytes.data()));
          const std::size_t size = realtime::encode(
              layout, {.displacement = generator.next().value}, command_bytes.data());
          realtime::Command command;
          if (!realtime::decode(layout, {command_bytes.data(), size}, command)) return false;
          excitation.command.value = command.displacement;
          return true;
        },
        {});
    if (summary.end != simulation::RunEnd::finished) state.SkipWithError("run ended early");
  }
}
BENCHMARK_CAPTURE(served_second, exponential,
                  {.relative_tolerance = 1e-6, .absolute_tolerance = 1e-6})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(served_second, fixed, {.method = simulation::Method::fixed, .fixed_step = 2e-4})
    ->Unit(benchmark::kMillisecond);

}  // namespace
