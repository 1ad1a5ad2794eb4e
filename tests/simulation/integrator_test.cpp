/// The integrators on the full plant.

#include "hydrapod/simulation/closed_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

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

model::Machine heavy_machine() {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 3.0;
  return machine;
}

IntegratorOptions options_with(Method method, double tolerance) {
  return {.method = method, .relative_tolerance = tolerance, .absolute_tolerance = tolerance};
}

/// 60 ms with commands that change every 2 ms.
VectorXd end_state(const Plant& plant, const IntegratorOptions& options,
                   simulation::IntegratorStatistics* statistics = nullptr) {
  const auto rest = plant.equilibrium(plant.machine().neutral());
  Integrator run(plant, options);
  run.start(0.0, rest.x);
  PlantInput input = rest.input;
  for (int k = 1; k <= 30; ++k) {
    for (int i = 0; i < 6; ++i)
      input.command[i] = rest.input.command[i] + 0.1 * std::sin(k + 2.0 * i);
    run.advance(2e-3 * k, input);
    EXPECT_EQ(run.time(), 2e-3 * k);
  }
  if (statistics) *statistics = run.statistics();
  return run.state();
}

double scaled_difference(const Plant& plant, const VectorXd& a, const VectorXd& b) {
  return (a - b).cwiseQuotient(plant.scales()).lpNorm<Eigen::Infinity>();
}

TEST(Integrators, AgreeWithinTheirTolerances) {
  const Plant plant(heavy_machine(), ModelKind::guide);
  const VectorXd exact = end_state(plant, options_with(Method::cvode_adams, 1e-12));
  for (const auto method :
       {Method::exponential, Method::adaptive, Method::cvode_adams, Method::cvode_bdf}) {
    double before = 1.0;
    for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
      const auto x = end_state(plant, options_with(method, tolerance));
      const double error = scaled_difference(plant, x, exact);
      EXPECT_LE(error, 300.0 * tolerance) << name(method);  // local errors add up over the steps
      EXPECT_LT(error, before) << name(method);
      before = error;
    }
  }
}

TEST(Integrators, FixedStepsHaveOrderFour) {
  auto machine = heavy_machine();  // edges that stay open have no corner
  for (auto& leg : machine.legs) leg.hydraulics.valve.overlap = -0.6;
  const Plant plant(machine, ModelKind::guide, {.friction = simulation::Friction::viscous});
  const VectorXd exact = end_state(plant, options_with(Method::cvode_adams, 1e-12));
  const auto error = [&](double step) {
    return scaled_difference(plant, end_state(plant, {.method = Method::fixed, .fixed_step = step}),
                             exact);
  };
  const double coarse = error(2e-4), fine = error(1e-4), finest = error(5e-5);
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.5);
  EXPECT_NEAR(std::log2(fine / finest), 4.0, 0.5);
  EXPECT_LT(finest, 1e-6);
}

TEST(Integrators, CountWhatTheyDo) {
  const Plant plant(heavy_machine(), ModelKind::guide);
  simulation::IntegratorStatistics statistics;
  end_state(plant, {.method = Method::fixed, .fixed_step = 2.5e-4}, &statistics);
  EXPECT_EQ(statistics.steps, 30 * 8);
  EXPECT_EQ(statistics.evaluations, 4 * 30 * 8);
  for (const auto method : {Method::adaptive, Method::exponential}) {
    end_state(plant, {.method = method}, &statistics);
    EXPECT_GE(statistics.steps, 30);
    EXPECT_GE(statistics.evaluations, 6 * (statistics.steps + statistics.rejected));
  }
  // the rates at the end of a step are those at the begin of the next one, under any command
  EXPECT_EQ(statistics.evaluations, 6 * (statistics.steps + statistics.rejected) + 1);
  end_state(plant, {.method = Method::cvode_bdf}, &statistics);
  EXPECT_GE(statistics.jacobians, 30);
  EXPECT_GE(statistics.evaluations, statistics.jacobians * plant.layout().size);
}

TEST(Integrators, GoOnFromAnyStateAgain) {
  const Plant plant(heavy_machine(), ModelKind::rigid);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  PlantInput input = rest.input;
  input.command[0] += 0.05;
  for (const auto method :
       {Method::exponential, Method::adaptive, Method::cvode_adams, Method::fixed}) {
    Integrator run(plant, {.method = method});
    run.start(3.0, rest.x);
    run.advance(3.02, input);
    const VectorXd first = run.state();
    run.start(3.0, rest.x);
    run.advance(3.02, input);
    EXPECT_LE(scaled_difference(plant, run.state(), first), 1e-9) << name(method);
  }
}

TEST(Integrators, RefuseWhatMakesNoSense) {
  const Plant plant(heavy_machine(), ModelKind::rigid);
  EXPECT_THROW(Integrator(plant, {.relative_tolerance = 0.0}), std::invalid_argument);
  EXPECT_THROW(Integrator(plant, {.absolute_tolerance = NAN}), std::invalid_argument);
  EXPECT_THROW(Integrator(plant, {.method = Method::fixed, .fixed_step = 0.0}),
               std::invalid_argument);
  Integrator run(plant);
  EXPECT_THROW(run.start(0.0, VectorXd::Zero(3)), std::invalid_argument);
  run.start(0.0, plant.equilibrium(plant.machine().neutral()).x);
  EXPECT_THROW(run.advance(-1.0, {}), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::test
