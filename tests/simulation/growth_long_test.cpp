/// The verdict on stability near its limit: poles of the sampled loop against the growth of the
/// nonlinear machine under the real controller.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation {
namespace {

struct Case {
  const char* machine;
  double limit;  ///< gain at which the loop with compensation = "load" begins to grow [1/s]
};

class Growth : public testing::TestWithParam<std::tuple<Case, const char*, double>> {};

/// Root mean square of the platform's displacement over one second.
class Window {
 public:
  explicit Window(double from) : from_(from) {}
  void see(double time, const Vector6& displacement) {
    if (time <= from_ || time > from_ + 1.0) return;
    sum_ += displacement.squaredNorm();
    ++count_;
  }
  [[nodiscard]] double rms() const { return std::sqrt(sum_ / count_); }

 private:
  double from_, sum_{};
  int count_{};
};

TEST_P(Growth, OfTheMachineIsThatOfTheLargestPole) {
  const auto& [which, compensation, share] = GetParam();
  auto overrides = smooth;
  overrides.push_back(fmt::format("controller.compensation=\"{}\"", compensation));
  overrides.push_back(fmt::format("controller.gain={}", share * which.limit));
  const auto machine = machine_of(which.machine, overrides);
  constexpr double first = 30.0, second = 58.0;
  ClosedLoop loop(machine, machine.neutral(),
                  {.plant = {.friction = Friction::viscous},
                   .integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12},
                   .until = second + 1.0,
                   .ideal_sensors = true});
  const auto system = linear_system(machine, machine.neutral());
  // a small kick in all directions; what is left after 30 s is the mode that grows or fades slowest
  const Vector6 size = (Vector6() << 1.1, 0.9, 1.3, 0.8, 1.2, 0.7).finished() * 1e-7;
  const signals::Trajectory pulse{.times = {0.0, 0.01, 0.02},
                                  .points = {Vector6::Zero(), size, Vector6::Zero()}};
  signals::Generator kick({{.form = pulse}}, 1.0 / loop.parameters().sample_time);
  Window early(first), late(second);
  loop.run(command_source(kick), [&](const LoopSample& sample) {
    const Vector6 moved = displacement_between(loop.operating(), sample.plant.X_BP);
    early.see(sample.time, moved);
    late.see(sample.time, moved);
  });
  const double measured = std::log(late.rms() / early.rms()) / (second - first);
  const double stated =
      std::log(system_poles(system).largest_modulus) / loop.parameters().sample_time;
  // modes close to the slowest take part in the early window
  EXPECT_NEAR(measured, stated, 0.004 + 0.02 * std::abs(stated));
}

INSTANTIATE_TEST_SUITE_P(, Growth,
                         testing::Combine(testing::Values(Case{"zhang-jiang-2021", 33.98},
                                                          Case{"heavy-platform", 16.195}),
                                          testing::Values("load", "asymmetry", "none"),
                                          testing::Values(0.997, 1.0015, 1.006)),
                         [](const auto& test) { return fmt::format("{}", test.index); });

}  // namespace
}  // namespace hydrapod::simulation
