/// Inverse, Jacobian and forward kinematics, at a hundred poses in turn.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <random>
#include <unsupported/Eigen/NonLinearOptimization>

#include "hydrapod/kinematics/legs.hpp"
#include "machines.hpp"

namespace {

using namespace hydrapod;
using spatial::Matrix6;
using spatial::Pose;
using spatial::Vector6;

constexpr int pose_count = 100;
constexpr double tolerance = 1e-12;  // [m], the same for every solver

/// Poses within 50 mm and 5 degrees of neutral, and starts some millimetres and a degree away from
/// them.
struct Cases {
  model::Machine machine = bench::published();
  std::vector<Pose> poses, starts;
  std::vector<Vector6> lengths;

  Cases() {
    std::mt19937_64 generator(20210316);
    const auto near = [&](const Pose& pose, double metres, double radians) {
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      Vector6 step;
      for (int i = 0; i < 6; ++i) step[i] = (i < 3 ? metres : radians) * uniform(generator);
      return spatial::displaced(pose, step);
    };
    for (int i = 0; i < pose_count; ++i) {
      poses.push_back(near(machine.neutral(), 0.05, 0.087));
      starts.push_back(near(poses.back(), 0.005, 0.017));
      lengths.push_back(kinematics::leg_lengths(machine, poses.back()));
    }
  }
};

void inverse(benchmark::State& state) {
  const Cases cases;
  int i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(kinematics::inverse_kinematics(cases.machine, cases.poses[i]));
    i = (i + 1) % pose_count;
  }
}
BENCHMARK(inverse);

void jacobian(benchmark::State& state) {
  const Cases cases;
  int i = 0;
  for (auto _ : state) {
    const Pose& pose = cases.poses[i];
    const auto legs = kinematics::inverse_kinematics(cases.machine, pose);
    benchmark::DoNotOptimize(kinematics::leg_jacobian(legs, pose.p_BP));
    i = (i + 1) % pose_count;
  }
}
BENCHMARK(jacobian);

void forward(benchmark::State& state) {
  const Cases cases;
  int i = 0;
  benchmark::IterationCount steps = 0;
  for (auto _ : state) {
    const auto result =
        kinematics::forward_kinematics(cases.machine, cases.lengths[i], cases.starts[i]);
    if (result.status != kinematics::ForwardStatus::converged) state.SkipWithError("no pose");
    benchmark::DoNotOptimize(result);
    steps += result.iterations;
    i = (i + 1) % pose_count;
  }
  state.SetLabel(fmt::format("{:.1f} steps",
                             static_cast<double>(steps) / static_cast<double>(state.iterations())));
}
BENCHMARK(forward);

/// What most programs do first: Newton with a Jacobian from central differences.
void forward_differenced_newton(benchmark::State& state) {
  const Cases cases;
  int i = 0;
  for (auto _ : state) {
    Pose pose = cases.starts[i];
    Vector6 residual = kinematics::leg_lengths(cases.machine, pose) - cases.lengths[i];
    for (int step = 0; step < 50 && residual.lpNorm<Eigen::Infinity>() > tolerance; ++step) {
      constexpr double h = 1e-6;
      Matrix6 J;
      for (int k = 0; k < 6; ++k) {
        const Vector6 d = h * Vector6::Unit(k);
        J.col(k) = (kinematics::leg_lengths(cases.machine, spatial::displaced(pose, d)) -
                    kinematics::leg_lengths(cases.machine, spatial::displaced(pose, -d))) /
                   (2.0 * h);
      }
      pose = spatial::displaced(pose, -Eigen::PartialPivLU<Matrix6>(J).solve(residual));
      residual = kinematics::leg_lengths(cases.machine, pose) - cases.lengths[i];
    }
    if (residual.lpNorm<Eigen::Infinity>() > tolerance) state.SkipWithError("no pose");
    benchmark::DoNotOptimize(pose);
    i = (i + 1) % pose_count;
  }
}
BENCHMARK(forward_differenced_newton);

/// Leg lengths less the given ones as a function of (p, roll, pitch, yaw), as Eigen's solvers want
/// it.
struct Residual {
  const model::Machine& machine;
  const Vector6& lengths;
  static Pose pose(const Eigen::VectorXd& x) {
    return {.R_BP = spatial::rotation_from_rpy(x.tail<3>()), .p_BP = x.head<3>()};
  }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& r) const {
    r = kinematics::leg_lengths(machine, pose(x)) - lengths;
    return 0;
  }
};

/// MINPACK's hybrid method (Powell's dog leg with Broyden updates) from Eigen's unsupported
/// modules.
void forward_minpack_hybrid(benchmark::State& state) {
  const Cases cases;
  int i = 0;
  for (auto _ : state) {
    Residual residual{cases.machine, cases.lengths[i]};
    Eigen::VectorXd x(6), r(6);
    x << cases.starts[i].p_BP, spatial::rpy_from_rotation(cases.starts[i].R_BP);
    Eigen::HybridNonLinearSolver<Residual> solver(residual);
    solver.parameters.xtol = 1e-13;
    solver.solveNumericalDiff(x);
    residual(x, r);
    if (r.lpNorm<Eigen::Infinity>() > tolerance) state.SkipWithError("no pose");
    benchmark::DoNotOptimize(x.data());
    i = (i + 1) % pose_count;
  }
}
BENCHMARK(forward_minpack_hybrid);

}  // namespace
