/// The verdict on stability near its limit: poles of the sampled loop against the growth of the
/// nonlinear machine under the real controller.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/simulation/linear_system.hpp"
#include "near_gain_limit.hpp"

namespace hydrapod::simulation {
namespace {

class Growth : public testing::TestWithParam<NearGainLimit> {};

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
  const auto machine = looped(GetParam());
  constexpr double first = 30.0, second = 58.0;
  ClosedLoop loop(machine, machine.neutral(), exact_until(second + 1.0));
  const auto system = linear_system(machine, machine.neutral());
  // a small kick in all directions; what is left after 30 s is the mode that grows or fades slowest
  const Vector6 size = (Vector6() << 1.1, 0.9, 1.3, 0.8, 1.2, 0.7).finished() * 1e-7;
  signals::Generator kick({{.form = kick_of(size)}}, 1.0 / loop.parameters().sample_time);
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

INSTANTIATE_TEST_SUITE_P(, Growth, near_gain_limits(0.997, 1.0015, 1.006),
                         [](const auto& test) { return fmt::format("{}", test.index); });

}  // namespace
}  // namespace hydrapod::simulation
