/// Spools in closed form, and the method that takes them so.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "hydrapod/simulation/closed_loop.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::VectorXd;
using simulation::Integrator;
using simulation::IntegratorOptions;
using simulation::Method;
using simulation::Plant;
using simulation::PlantInput;

model::Machine heavy() {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 3.0;
  return machine;
}

model::Machine with_valves(double frequency, double damping_ratio, double rate_limit) {
  auto machine = heavy();
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.natural_frequency = frequency;
    leg.hydraulics.valve.damping_ratio = damping_ratio;
    leg.hydraulics.valve.rate_limit = rate_limit;
    frequency *= 1.07;  // every leg has its own
  }
  return machine;
}

/// States every millisecond under commands that are drawn anew for each.
std::vector<VectorXd> driven(const Plant& plant, const IntegratorOptions& options, double rms,
                             int samples, simulation::IntegratorStatistics* statistics = nullptr) {
  const auto rest = plant.equilibrium(plant.machine().neutral());
  Integrator run(plant, options);
  run.start(0.0, rest.x);
  std::mt19937_64 engine(20261126);
  std::normal_distribution<double> normal(0.0, rms);
  PlantInput input = rest.input;
  std::vector<VectorXd> states;
  for (int k = 1; k <= samples; ++k) {
    for (int i = 0; i < 6; ++i) input.command[i] = rest.input.command[i] + normal(engine);
    run.advance(1e-3 * k, input);
    states.push_back(run.state());
  }
  if (statistics) *statistics = run.statistics();
  return states;
}

/// Largest difference of the states from `first` on, `count` of them, in their scales.
double difference(const Plant& plant, const std::vector<VectorXd>& a,
                  const std::vector<VectorXd>& b, int first, int count) {
  const VectorXd scales = plant.scales().segment(first, count);
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    largest = std::max(
        largest,
        (a[k] - b[k]).segment(first, count).cwiseQuotient(scales).lpNorm<Eigen::Infinity>());
  return largest;
}

double difference(const Plant& plant, const std::vector<VectorXd>& a,
                  const std::vector<VectorXd>& b) {
  return difference(plant, a, b, 0, plant.layout().size);
}

IntegratorOptions with(Method method, double tolerance) {
  return {.method = method, .relative_tolerance = tolerance, .absolute_tolerance = tolerance};
}

TEST(Spools, MoveByTheExponentialOfTheirMatrix) {
  constexpr double rounding = 1e-13;  // of some hundreds of epsilons after 40 commands
  for (const double ratio : {0.31, 0.83, 1.0, 1.0 + 1e-9, 1.7}) {
    const Plant plant(with_valves(613.0, ratio, 1e6), ModelKind::rigid);
    const auto rest = plant.equilibrium(plant.machine().neutral());
    for (const auto method : {Method::exponential, Method::fixed}) {
      Integrator run(plant, {.method = method});
      run.start(0.0, rest.x);
      std::array<Eigen::Vector2d, 6> expected;
      for (int i = 0; i < 6; ++i) expected[i] << rest.x[plant.layout().spool(i)], 0.0;
      PlantInput input = rest.input;
      for (int k = 1; k <= 40; ++k) {
        for (int i = 0; i < 6; ++i) input.command[i] = 0.2 * std::sin(2.3 * k + i);
        run.advance(1.3e-3 * k, input);
        for (int i = 0; i < 6; ++i) {
          const auto& valve = plant.axis(i).valve;
          const double w = valve.natural_frequency;
          Eigen::Matrix2d A;  // of (x, ẋ/ω)
          A << 0.0, w, -w, -2.0 * ratio * w;
          const Eigen::Vector2d u(input.command[i], 0.0);
          expected[i] = u + (1.3e-3 * A).exp() * (expected[i] - u);
          const int at = plant.layout().spool(i);
          EXPECT_NEAR(run.state()[at], expected[i][0], rounding) << ratio << name(method);
          EXPECT_NEAR(run.state()[at + 1] / w, expected[i][1], rounding) << ratio << name(method);
        }
      }
    }
  }
}

/// A spool by small steps of the classical Runge-Kutta method, which the corner of the rate's limit
/// costs an error of second order.
Eigen::Vector2d by_small_steps(const hydraulics::Valve& valve, Eigen::Vector2d x, double command,
                               double time) {
  constexpr int steps = 30'000;
  const double h = time / steps;
  const auto rate = [&](const Eigen::Vector2d& at) {
    return Eigen::Vector2d(at[1], hydraulics::spool_acceleration(valve, at[0], at[1], command));
  };
  for (int k = 0; k < steps; ++k) {
    const Eigen::Vector2d k1 = rate(x), k2 = rate(x + 0.5 * h * k1), k3 = rate(x + 0.5 * h * k2),
                          k4 = rate(x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
  }
  return x;
}

TEST(Spools, KeepToTheLimitOfTheirRate) {
  constexpr double of_small_steps = 1e-9;  // of the travel; (1 ms / 30 000)² ω³ per corner
  for (const double ratio : {0.12, 0.8, 1.4}) {
    const Plant plant(with_valves(613.0, ratio, 57.0), ModelKind::rigid);
    const auto rest = plant.equilibrium(plant.machine().neutral());
    for (const auto method : {Method::exponential, Method::fixed}) {
      Integrator run(plant, {.method = method, .fixed_step = 5e-4});
      run.start(0.0, rest.x);
      std::array<Eigen::Vector2d, 6> expected;
      for (int i = 0; i < 6; ++i) expected[i] << rest.x[plant.layout().spool(i)], 0.0;
      PlantInput input = rest.input;
      double fastest = 0.0;
      for (int k = 1; k <= 40; ++k) {
        for (int i = 0; i < 6; ++i) input.command[i] = 0.6 * std::sin(2.3 * k + i);
        run.advance(1e-3 * k, input);
        for (int i = 0; i < 6; ++i) {
          const auto& valve = plant.axis(i).valve;
          expected[i] = by_small_steps(valve, expected[i], input.command[i], 1e-3);
          const int at = plant.layout().spool(i);
          EXPECT_NEAR(run.state()[at], expected[i][0], of_small_steps) << ratio << name(method);
          EXPECT_NEAR(run.state()[at + 1], expected[i][1], of_small_steps * valve.natural_frequency)
              << ratio << name(method);
          fastest = std::max(fastest, std::abs(run.state()[at + 1]));
        }
      }
      EXPECT_GT(fastest, 15.0) << ratio;  // with little damping it comes near the limit slowly
      EXPECT_LE(fastest, 57.0) << ratio;
    }
  }
}

/// Where nothing has a corner: edges that stay open, rates below their limit.
TEST(Exponential, HasOrderFive) {
  auto machine = with_valves(613.0, 0.8, 1e6);
  for (auto& leg : machine.legs) leg.hydraulics.valve.overlap = -0.6;
  const Plant plant(machine, ModelKind::guide, {.friction = simulation::Friction::viscous});
  const auto exact = driven(plant, with(Method::cvode_adams, 1e-13), 0.05, 40);
  const auto error = [&](double step) {
    return difference(plant,
                      driven(plant,
                             {.method = Method::exponential,
                              .relative_tolerance = 0.1,
                              .absolute_tolerance = 0.1,
                              .largest_step = step},
                             0.05, 40),
                      exact);
  };
  const double coarse = error(1e-3), fine = error(5e-4), finest = error(2.5e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 5.0, 0.5);
  EXPECT_NEAR(std::log2(fine / finest), 5.0, 0.5);
}

struct Subject {
  const char* name;
  model::Machine machine;
  ModelKind kind{ModelKind::guide};
  double rms{0.1};
  double share{0.8};  ///< of the adaptive method's evaluations that are enough
};

std::vector<Subject> subjects() {
  auto rubbing = heavy(), ringed = heavy(), bristled = heavy(), weak_pump = heavy();
  for (int i = 0; i < 6; ++i) {
    rubbing.legs[i].hydraulics.friction.coulomb = 137.0;
    bristled.legs[i].hydraulics.friction.coulomb = 83.0;
    bristled.legs[i].hydraulics.friction.bristles = model::LuGreBristles{2e7, 2e4};
    ringed.legs[i].piston_ring = model::PistonRing{.stiffness = 2.1e6, .damping = 470.0};
  }
  weak_pump.hydraulics.supply.pump_flow = 1.3e-3;
  // Stability limits the steps, and nearly so a pump's small volume of oil.
  constexpr double by_rings = 0.95, by_pump = 0.95, by_bristles = 1.1;
  return {{"small motion", heavy(), ModelKind::guide, 0.01},
          {"motion", heavy()},
          {"large motion", heavy(), ModelKind::guide, 0.3},
          {"rigid legs", heavy(), ModelKind::rigid},
          {"piston rings", ringed, ModelKind::full, 0.1, by_rings},
          {"friction", rubbing},
          {"bristles", bristled, ModelKind::rigid, 0.1, by_bristles},
          {"a pump", weak_pump, ModelKind::rigid, 0.1, by_pump}};
}

/// As near to a tight integration as the adaptive method at the same tolerance, in fewer steps.
TEST(Exponential, IsAtLeastAsAccurateAsTheAdaptiveMethod) {
  for (const auto& subject : subjects()) {
    const Plant plant(subject.machine, subject.kind);
    const auto exact = driven(plant, with(Method::cvode_adams, 1e-12), subject.rms, 150);
    for (const double tolerance : {1e-5, 1e-6}) {
      simulation::IntegratorStatistics adaptive, exponential;
      const double of_adaptive = difference(
          plant, driven(plant, with(Method::adaptive, tolerance), subject.rms, 150, &adaptive),
          exact);
      const double found = difference(
          plant,
          driven(plant, with(Method::exponential, tolerance), subject.rms, 150, &exponential),
          exact);
      EXPECT_LE(found, of_adaptive) << subject.name << tolerance;
      EXPECT_LT(static_cast<double>(exponential.evaluations),
                subject.share * static_cast<double>(adaptive.evaluations))
          << subject.name << tolerance;
    }
  }
}

TEST(Exponential, TakesNoStepsForFastValves) {
  const Plant plant(with_valves(1e9, 0.8, 1e12), ModelKind::rigid);
  simulation::IntegratorStatistics statistics;
  const auto states = driven(plant, with(Method::exponential, 1e-6), 0.05, 20, &statistics);
  EXPECT_LE(statistics.steps, 200);
  EXPECT_TRUE(states.back().allFinite());
  const auto loop = [](Method method) {
    const auto machine = with_valves(1e9, 0.8, 100.0);
    simulation::ClosedLoop(machine, machine.neutral(),
                           {.integrator = {.method = method}, .until = 5.0});
  };
  EXPECT_NO_THROW(loop(Method::exponential));
  EXPECT_THROW(loop(Method::adaptive), base::ComputationError);
}

/// A wrench that changes changes the rates at once, a command does not.
TEST(Exponential, TakesNoticeOfEveryInput) {
  const Plant plant(heavy(), ModelKind::guide);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  const auto pushed = [&](const IntegratorOptions& options) {
    Integrator run(plant, options);
    run.start(0.0, rest.x);
    PlantInput input = rest.input;
    for (int k = 1; k <= 30; ++k) {
      input.wrench[k % 6] += k % 2 == 0 ? 170.0 : -90.0;
      run.advance(1.7e-3 * k, input);
    }
    return std::vector{run.state()};
  };
  EXPECT_LE(difference(plant, pushed(with(Method::exponential, 1e-7)),
                       pushed(with(Method::cvode_adams, 1e-12))),
            1e-6);
}

}  // namespace
}  // namespace hydrapod::test
