/// The verdict on stability near its limit: poles of the sampled loop against the growth of the
/// nonlinear machine under the real controller.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "hydrapod/numerics/dense.hpp"
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

model::Machine looped(const Case& which, const char* compensation, double share) {
  auto overrides = smooth;
  overrides.push_back(fmt::format("controller.compensation=\"{}\"", compensation));
  overrides.push_back(fmt::format("controller.gain={}", share * which.limit));
  return machine_of(which.machine, overrides);
}

LoopOptions exact_until(double end) {
  return {.plant = {.friction = Friction::viscous},
          .integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12},
          .until = end,
          .ideal_sensors = true};
}

/// A pulse of 20 ms.
signals::Trajectory kick_of(const Vector6& size) {
  return {.times = {0.0, 0.01, 0.02}, .points = {Vector6::Zero(), size, Vector6::Zero()}};
}

TEST_P(Growth, OfTheMachineIsThatOfTheLargestPole) {
  const auto& [which, compensation, share] = GetParam();
  const auto machine = looped(which, compensation, share);
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

INSTANTIATE_TEST_SUITE_P(, Growth,
                         testing::Combine(testing::Values(Case{"zhang-jiang-2021", 33.98},
                                                          Case{"heavy-platform", 16.195}),
                                          testing::Values("load", "asymmetry", "none"),
                                          testing::Values(0.997, 1.0015, 1.006)),
                         [](const auto& test) { return fmt::format("{}", test.index); });

/// Poles of free motions y_k (a column per run) an `interval` [s] apart: of the matrix that leads
/// from lags to the next ones (J.-N. Juang, R. S. Pappa, J. Guid. Control Dyn. 8 (1985) 620).
Eigen::VectorXcd poles_of_motions(const std::vector<Eigen::MatrixXd>& y, double interval) {
  constexpr Eigen::Index blocks = 30;
  constexpr double noise = 1e-8;  // of the largest singular value; tolerances are 1e-10
  const Eigen::Index rows = y[0].rows(), columns = y[0].cols();
  Eigen::MatrixXd H(blocks * rows, (std::ssize(y) - blocks) * columns);
  for (Eigen::Index i = 0; i < blocks; ++i)
    for (Eigen::Index j = 0; j < std::ssize(y) - blocks; ++j)
      H.block(i * rows, j * columns, rows, columns) = y[static_cast<std::size_t>(i + j)];
  const auto svd = numerics::singular_values(H);
  const Eigen::Index order = (svd.s.array() > noise * svd.s[0]).count();
  const Eigen::MatrixXd O = svd.U.leftCols(order);
  const Eigen::VectorXcd z = numerics::eigenvalues(
      numerics::least_squares(O.topRows(O.rows() - rows), O.bottomRows(O.rows() - rows)));
  return z.array().log() / interval;
}

class Poles : public Growth {};

/// Nothing but the simulated motion after kicks in all directions tells of them.
TEST_P(Poles, ThatShowInTheMotionOfTheMachineAreThoseOfTheSampledLoop) {
  const auto& [which, compensation, share] = GetParam();
  const auto machine = looped(which, compensation, share);
  constexpr double begin = 0.1, end = 3.1;
  constexpr int apart = 8;  // samples
  std::vector<Eigen::MatrixXd> motions;
  double sample_time = 0.0;
  for (int direction = 0; direction < 6; ++direction) {
    ClosedLoop loop(machine, machine.neutral(), exact_until(end));
    sample_time = loop.parameters().sample_time;
    signals::Generator kick({{.form = kick_of(1e-6 * Vector6::Unit(direction))}},
                            1.0 / sample_time);
    std::size_t k = 0;
    loop.run(command_source(kick), [&](const LoopSample& sample) {
      if (sample.time < begin || std::lround(sample.time / sample_time) % apart != 0) return;
      if (k == motions.size()) motions.emplace_back(6, 6);
      motions[k++].col(direction) = displacement_between(loop.operating(), sample.plant.X_BP);
    });
  }
  const auto measured = poles_of_motions(motions, apart * sample_time);
  for (const auto& pole : measured) fmt::print("measured {} {}\n", pole.real(), pole.imag());
  const auto poles = system_poles(linear_system(machine, machine.neutral()));
  for (const auto& pole : poles.sampled) {
    if (pole.real() < -60 || std::abs(pole) > 300) continue;
    double nearest = 1e9;
    for (const auto& m : measured) nearest = std::min(nearest, std::abs(m - pole));
    fmt::print("stated {} {} off {}\n", pole.real(), pole.imag(), nearest);
  }
}

INSTANTIATE_TEST_SUITE_P(, Poles,
                         testing::Combine(testing::Values(Case{"zhang-jiang-2021", 33.98},
                                                          Case{"heavy-platform", 16.195}),
                                          testing::Values("load", "asymmetry", "none"),
                                          testing::Values(0.37, 0.997, 1.006)),
                         [](const auto& test) { return fmt::format("{}", test.index); });

}  // namespace
}  // namespace hydrapod::simulation
