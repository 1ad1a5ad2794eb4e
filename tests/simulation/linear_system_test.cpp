/// The linear description of everything against time stepping that knows nothing of it.

#include "hydrapod/simulation/linear_system.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "hydrapod/simulation/closed_loop.hpp"
#include "support/classical_step.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation {
namespace {

using Complex = std::complex<double>;
using control::ControllerInputs;

const Pose& neutral(const model::Machine& machine) { return machine.neutral(); }

/// One sample of the loop by small steps of the plant's linear equations, with a queue of drives as
/// a computer has one: nothing of the assembly under test is used but the plant's A, B, C.
class SteppedLoop {
 public:
  SteppedLoop(const model::Machine& machine, ModelKind kind)
      : plant_(machine, kind, {.friction = Friction::viscous}, machine.neutral()) {
    const auto rest = plant_.equilibrium(machine.neutral());
    linear_ = plant_.linearise(rest.x, rest.input);
    parameters_ = tune_controller(machine, machine.neutral()).parameters;
    Vector6 loads;
    for (int i = 0; i < 6; ++i) {
      const auto& axis = parameters_.axes[static_cast<size_t>(i)];
      loads[i] = rest.x[plant_.layout().cap(i)] * axis.piston_area -
                 rest.x[plant_.layout().rod(i)] * axis.annulus_area;
    }
    controller_ = control::linear_controller(machine, parameters_, machine.neutral(),
                                             rest.input.command, loads);
    x = Eigen::VectorXd::Zero(linear_.A.rows());
    xi = Eigen::VectorXd::Zero(controller_.A.rows());
  }

  /// From sample k to k + 1; `past` holds the drives of the samples before, the latest first.
  void step(const Vector6& command, const Vector6& velocity, std::deque<Vector6>& past) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(ControllerInputs::count);
    const Eigen::VectorXd y = linear_.C * x;
    u.segment<6>(ControllerInputs::length) = y.segment<6>(6);
    for (int i = 0; i < 6; ++i) {
      u[ControllerInputs::cap_pressure + i] = y[18 + 2 * i];
      u[ControllerInputs::rod_pressure + i] = y[19 + 2 * i];
    }
    u.segment<6>(ControllerInputs::command) = command;
    u.segment<6>(ControllerInputs::velocity) = velocity;
    past.push_front(controller_.C * xi + controller_.D * u);
    xi = (controller_.A_d * xi + controller_.B_d * u).eval();
    const double delay = parameters_.delay;
    const int pieces = 400;
    const double h = parameters_.sample_time / pieces;
    for (int piece = 0; piece < pieces; ++piece) {
      const double into = (piece + 0.5) / pieces;  // of the sample
      // Due now: the drive of the latest sample j back with j ≥ delay − into
      const int back = std::max(0, static_cast<int>(std::ceil(delay - into - 1e-12)));
      runge_kutta(h, past[static_cast<size_t>(back)]);
    }
  }

  Eigen::VectorXd x, xi;
  [[nodiscard]] const Plant& plant() const { return plant_; }
  [[nodiscard]] Vector6 random_drive(int seed) const {
    Vector6 drive;
    for (int i = 0; i < 6; ++i) drive[i] = 0.01 * std::sin(1.7 * seed + 0.9 * i);
    return drive;
  }

 private:
  void runge_kutta(double h, const Vector6& drive) {
    const Eigen::VectorXd b = linear_.B.leftCols(6) * drive;
    const auto f = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd { return linear_.A * at + b; };
    x = test::classical_step(f, x, h);
  }

  Plant plant_;
  LinearPlant linear_{};
  control::ControllerParameters parameters_{};
  control::LinearController controller_{};
};

class SampledLoop : public testing::TestWithParam<double> {};

/// Three samples with a command, from states and past drives that are not zero.
TEST_P(SampledLoop, StepsAsTheLoopDoes) {
  const auto machine =
      machine_of("heavy-platform", {"controller.delay=" + std::to_string(GetParam())});
  SteppedLoop stepped(machine, ModelKind::rigid);
  const auto system = linear_system(machine, neutral(machine), {.kind = ModelKind::rigid});
  const auto n = stepped.x.size(), nc = stepped.xi.size();
  const auto memory = (system.sampled.rows() - n - nc) / 6;
  for (Eigen::Index i = 0; i < n; ++i)
    stepped.x[i] = 1e-3 * system.scales[i] * std::sin(0.7 + 1.3 * static_cast<double>(i));
  for (Eigen::Index i = 0; i < nc; ++i)
    stepped.xi[i] = (i < 6 ? 1e-5 : 30.0) * std::cos(2.1 * static_cast<double>(i));
  std::deque<Vector6> past;
  for (int i = 0; i < 5; ++i) past.push_back(stepped.random_drive(i));
  Eigen::VectorXd w(system.sampled.rows());
  w << stepped.x, stepped.xi, Eigen::VectorXd::Zero(6 * memory);
  for (Eigen::Index i = 0; i < memory; ++i)
    w.segment<6>(n + nc + 6 * i) = past[static_cast<size_t>(i)];

  const Vector6 command = (Vector6() << 2e-4, -1e-4, 3e-4, 1e-4, 2e-4, -3e-4).finished();
  for (int k = 0; k < 3; ++k) {
    const Vector6 r = (k + 1) * command, v = 7.0 * (2 - k) * command;
    stepped.step(r, v, past);
    w = (system.sampled * w + system.sampled_command * r + system.sampled_velocity * v).eval();
  }
  const Eigen::VectorXd error = (w.head(n) - stepped.x).cwiseQuotient(system.scales.head(n));
  const double size = stepped.x.cwiseQuotient(system.scales.head(n)).norm();
  EXPECT_LT(error.norm(), 1e-8 * size);  // 400 steps of Runge-Kutta per sample
  EXPECT_LT((w.segment(n, nc) - stepped.xi).norm(), 1e-9 * stepped.xi.norm());
}

INSTANTIATE_TEST_SUITE_P(Delays, SampledLoop, testing::Values(0.0, 0.25, 1.0, 1.5, 2.75));

/// Of each exact pole below `fastest`, the distance to the nearest approximate one over its
/// modulus; the largest of all.
double worst_distance(const SystemPoles& poles, double fastest) {
  double worst = 0.0;
  for (const Complex exact : poles.sampled) {
    if (std::abs(exact) > fastest || std::abs(exact) < 1e-6) continue;
    double nearest = 1e300;
    for (const auto& pole : poles.poles) nearest = std::min(nearest, std::abs(pole.pole - exact));
    worst = std::max(worst, nearest / std::abs(exact));
  }
  return worst;
}

/// The continuous approximation against the exact poles of the sampled loop: what is left is the
/// hold taken for half a sample of delay and the sampled filters, (ωT)²/24 and ωT/2 of their own
/// poles.
TEST(ContinuousLoop, HasThePolesOfTheSampledOne) {
  const auto machine = machine_of("zhang-jiang-2021");
  const auto poles = system_poles(linear_system(machine, neutral(machine)));
  EXPECT_EQ(poles.stable, poles.sampled_stable);
  EXPECT_LT(worst_distance(poles, 250.0), 4e-3);
}

TEST(ContinuousLoop, IsBetterTheFasterTheSampling) {
  double last = 1.0;
  for (const char* time : {"4 ms", "2 ms", "1 ms", "0.5 ms"}) {
    const auto machine =
        machine_of("zhang-jiang-2021", {std::string("controller.sample_time=") + time});
    const double worst = worst_distance(
        system_poles(linear_system(machine, neutral(machine), {.kind = ModelKind::rigid})), 250.0);
    EXPECT_LT(worst, 0.6 * last) << time;
    last = worst;
  }
}

/// A long delay needs its approximation: without it the poles are far off, and higher orders are
/// better than low ones until the hold's error is left.
TEST(ContinuousLoop, NeedsThePadeApproximationOfALongDelay) {
  const auto machine = machine_of("zhang-jiang-2021", {"controller.delay=9.5"});
  const auto distance = [&](int order) {
    return worst_distance(
        system_poles(linear_system(machine, neutral(machine),
                                   {.kind = ModelKind::rigid, .pade_order = order})),
        250.0);
  };
  EXPECT_GT(distance(0), 0.1);
  EXPECT_LT(distance(1), 0.5 * distance(0));
  EXPECT_LT(distance(2), 0.5 * distance(1));
  EXPECT_LT(distance(3), 0.5 * distance(2));
  EXPECT_THROW(distance(9), std::invalid_argument);
}

/// The nonlinear machine under the real controller, for a step of 20 µm, against the sampled linear
/// loop, sample by sample.
TEST(SampledLoop, FollowsTheNonlinearMachineForASmallStep) {
  for (const std::string name : {"zhang-jiang-2021", "heavy-platform"}) {
    const auto machine = machine_of(name, smooth);
    ClosedLoop loop(machine, neutral(machine),
                    {.plant = {.friction = Friction::viscous},
                     .integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10},
                     .until = 0.8,
                     .ideal_sensors = true});
    const auto system = linear_system(machine, neutral(machine));
    for (const int direction : {0, 2, 5}) {
      const Vector6 size = 2e-5 * Vector6::Unit(direction);
      signals::Generator step({{.size = size, .form = signals::Step{.at = 0.0}}},
                              1.0 / loop.parameters().sample_time);
      Eigen::VectorXd w = Eigen::VectorXd::Zero(system.sampled.rows());
      double worst = 0.0;
      const auto summary = loop.run(command_source(step), [&](const LoopSample& sample) {
        const Vector6 linear =
            system.C.leftCols(system.scales.size()).leftCols(loop.plant().layout().tangent()) *
            w.head(loop.plant().layout().tangent());
        const Vector6 real = displacement_between(loop.operating(), sample.plant.X_BP);
        worst = std::max(worst, (linear - real).norm());
        w = (system.sampled * w + system.sampled_command * size).eval();
      });
      EXPECT_EQ(summary.end, RunEnd::finished);
      // The valve's null is bent: a step this small moves the spools by 3e-4 of their travel.
      EXPECT_LT(worst, 2.5e-3 * 2e-5) << name << ' ' << direction;
    }
  }
}

TEST(CommandResponse, IsOneAtRestAndMatchesASine) {
  const auto machine = machine_of("zhang-jiang-2021", smooth);
  const auto system = linear_system(machine, neutral(machine));
  const auto at_rest = command_response(system, 1e-5);
  EXPECT_LT((at_rest - Eigen::Matrix<Complex, 6, 6>::Identity()).norm(), 1e-4);

  constexpr double frequency = 5.0, amplitude = 2e-5, until = 6.0;
  ClosedLoop loop(machine, neutral(machine),
                  {.plant = {.friction = Friction::viscous},
                   .integrator = {.relative_tolerance = 1e-9, .absolute_tolerance = 1e-9},
                   .until = until,
                   .ideal_sensors = true});
  signals::Generator sine(
      {{.size = amplitude * Vector6::Unit(0), .form = signals::Sine{frequency}}},
      1.0 / loop.parameters().sample_time);
  Complex sum;  // over the last second: whole periods
  loop.run(command_source(sine), [&](const LoopSample& sample) {
    if (sample.time <= until - 1.0 + 1e-9) return;
    const double x = displacement_between(loop.operating(), sample.plant.X_BP)[0];
    sum += x * std::polar(1.0, -2.0 * M_PI * frequency * sample.time);
  });
  const Complex measured = 2.0 * sum / 1000.0 / amplitude * Complex(0.0, 1.0);
  const Complex linear = command_response(system, 2.0 * M_PI * frequency)(0, 0);
  EXPECT_LT(std::abs(measured - linear), 0.008 * std::abs(linear)) << measured << linear;
}

}  // namespace
}  // namespace hydrapod::simulation
