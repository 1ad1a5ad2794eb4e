/// Rest, limits of the machine, and what stops a simulation.

#include "hydrapod/simulation/plant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/kinds.hpp"
#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::VectorXd;
using simulation::Integrator;
using simulation::Method;
using simulation::Plant;
using simulation::PlantInput;

model::Machine heavy() {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 20.0;
  return machine;
}

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const base::ComputationError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

class Rest : public testing::TestWithParam<AxesAndKind> {};

TEST_P(Rest, OfRandomMachinesRests) {
  const auto [axes, kind] = GetParam();
  Random random(61);
  int rested = 0;
  for (int k = 0; k < 15; ++k) {
    auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::down});
    machine.hydraulics.supply.pressure = 3e7;
    if (random.chance(0.5)) machine.hydraulics.supply.pump_flow = 0.1;
    const Plant plant(machine, kind);
    for (const auto& pose : machine.poses) {
      Plant::Rest rest;
      try {
        rest = plant.equilibrium(pose.X_BP);
      } catch (const base::ComputationError&) {
        continue;  // some of the drawn cylinders are too thin for their load
      }
      ++rested;
      VectorXd rate(plant.layout().size);
      ASSERT_TRUE(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
      // Per second, in the scales of the states: statics ends at 1e-11 of the weight, which then
      // accelerates a seal's small inertia.
      EXPECT_LE(rate.cwiseQuotient(plant.scales()).lpNorm<Eigen::Infinity>(), 1e-4) << pose.name;
    }
  }
  EXPECT_GE(rested, 10);
}

INSTANTIATE_TEST_SUITE_P(, Rest,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

TEST(PublishedMachine, StaysWhereItsValvesHoldIt) {
  const Plant plant(heavy(), ModelKind::guide);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  Integrator run(plant);
  run.start(0.0, rest.x);
  for (int k = 1; k <= 200; ++k) run.advance(1e-2 * k, rest.input);
  EXPECT_LE((run.state() - rest.x).head<3>().norm(), 1e-9);
  EXPECT_TRUE(run.events().empty());
}

TEST(EndStops, CatchThePistonAndAreNoticed) {
  for (const auto method : {Method::exponential, Method::adaptive, Method::cvode_adams,
                            Method::cvode_bdf, Method::fixed}) {
    const Plant plant(heavy(), ModelKind::rigid);
    const auto rest = plant.equilibrium(plant.machine().neutral());
    Integrator run(plant, {.method = method});
    run.start(0.0, rest.x);
    PlantInput input;
    input.command.setConstant(0.7);  // all legs out: the platform rises to the stops
    double highest = 0.0;
    for (int k = 1; k <= 300; ++k) {
      run.advance(1e-3 * k, input);
      highest = std::max(highest, plant.outputs(run.state().data(), input).legs[0].piston);
    }
    const double stop = plant.axis(0).stops.high;
    EXPECT_GT(highest, stop) << name(method);
    EXPECT_LT(highest, stop + 2e-3) << name(method);
    ASSERT_FALSE(run.events().empty()) << name(method);
    const auto& first = run.events().front();
    EXPECT_EQ(first.event, Plant::Event::extended);
    EXPECT_TRUE(first.begins);
    EXPECT_NEAR(first.time, 0.1051, 2e-4) << name(method);  // the same for all
  }
}

TEST(Cavitation, OfATornCylinderIsNoticedAndPressuresStayPositive) {
  auto machine = heavy();
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.overlap = 0.3;
    leg.hydraulics.valve.leakage = 0.0;
    leg.hydraulics.leakage.internal = 0.0;
  }
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant);
  run.start(0.0, rest.x);
  PlantInput input = rest.input;
  input.wrench[2] = 9e4;  // lifts the platform off its closed valves
  double lowest = 1e9;
  for (int k = 1; k <= 60; ++k) {
    run.advance(1e-3 * k, input);
    for (int i = 0; i < 6; ++i) lowest = std::min(lowest, run.state()[plant.layout().cap(i)]);
  }
  EXPECT_GT(lowest, 0.0);
  EXPECT_LT(lowest, 5.5e4);
  ASSERT_FALSE(run.events().empty());
  EXPECT_EQ(run.events().front().event, Plant::Event::cavitation_cap);
}

TEST(Cavitation, OfAPressedCylinderIsNoticedOnTheRodSide) {
  auto machine = heavy();
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.overlap = 0.3;
    leg.hydraulics.valve.leakage = 0.0;
    leg.hydraulics.leakage.internal = 0.0;
  }
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant);
  run.start(0.0, rest.x);
  PlantInput input = rest.input;
  input.wrench[2] = -9e4;  // presses the platform down on its closed valves
  double lowest_cap = 1e9, lowest_rod = 1e9;
  for (int k = 1; k <= 60; ++k) {
    run.advance(1e-3 * k, input);
    for (int i = 0; i < 6; ++i) {
      lowest_cap = std::min(lowest_cap, run.state()[plant.layout().cap(i)]);
      lowest_rod = std::min(lowest_rod, run.state()[plant.layout().rod(i)]);
    }
    if (!run.events().empty()) break;
  }
  ASSERT_FALSE(run.events().empty());
  EXPECT_EQ(run.events().front().event, Plant::Event::cavitation_rod);
  EXPECT_LT(lowest_rod, machine.hydraulics.cavitation_pressure);
  EXPECT_GT(lowest_cap, machine.hydraulics.cavitation_pressure);
}

TEST(PumpLimit, LetsTheSupplyPressureFallAndTheAccumulatorHoldsItLonger) {
  const auto pressure_after = [](std::optional<model::Accumulator> accumulator) {
    auto machine = heavy();
    machine.hydraulics.supply.pump_flow = 4e-4;
    machine.hydraulics.supply.accumulator = accumulator;
    const Plant plant(machine, ModelKind::rigid);
    const auto rest = plant.equilibrium(machine.neutral());
    Integrator run(plant);
    run.start(0.0, rest.x);
    PlantInput input;
    input.command.setConstant(0.4);
    run.advance(0.05, input);
    return run.state()[plant.layout().supply];
  };
  const double bare = pressure_after({});
  const double held = pressure_after(model::Accumulator{.gas_volume = 2e-3, .precharge = 9e6});
  EXPECT_LT(bare, 10e6);
  EXPECT_GT(held, 13e6);
  EXPECT_LT(held, 14e6);
}

TEST(Bristles, HoldTheRodUnderALoadBelowBreakawayWhereTheSmoothLawCreeps) {
  const auto creep = [](std::optional<model::LuGreBristles> bristles) {
    auto machine = heavy();
    for (auto& leg : machine.legs)
      leg.hydraulics.friction = {.coulomb = 200.0, .breakaway = 300.0, .bristles = bristles};
    const Plant plant(machine, ModelKind::rigid);
    const auto rest = plant.equilibrium(machine.neutral());
    Integrator run(plant);
    run.start(0.0, rest.x);
    PlantInput input = rest.input;
    input.wrench[2] = 300.0;  // some 50 N per leg
    run.advance(0.3, input);
    const double early = run.state()[2];
    run.advance(0.6, input);
    return run.state()[2] - early;
  };
  const double smooth = creep({}), bristles = creep(model::LuGreBristles{2e7, 2e4});
  EXPECT_GT(smooth, 0.0);
  EXPECT_LT(std::abs(bristles), 0.1 * smooth);
}

TEST(Failures, NameTimeAndPart) {
  auto machine = heavy();
  machine.legs[2].hydraulics.end_stops.stiffness = 10.0;  // hardly there
  for (auto& leg : machine.legs) leg.hydraulics.end_stops.stiffness = 10.0;
  const Plant plant(machine, ModelKind::guide);
  const auto rest = plant.equilibrium(machine.neutral());
  Integrator run(plant);
  run.start(0.0, rest.x);
  PlantInput input;
  input.command.setConstant(0.9);
  const auto message = message_of([&] {
    for (int k = 1; k <= 1000; ++k) run.advance(1e-3 * k, input);
  });
  EXPECT_THAT(message, testing::MatchesRegex("simulation stopped at 0\\.[0-9]+ s: leg [1-6]: the "
                                             "piston leaves the guide sleeve, where the model "
                                             "ends"));
  EXPECT_TRUE(run.state().allFinite());
  EXPECT_GT(run.time(), 0.05);
}

TEST(Failures, NumbersThatAreNone) {
  const Plant plant(heavy(), ModelKind::rigid);
  const auto rest = plant.equilibrium(plant.machine().neutral());
  for (const auto method : {Method::exponential, Method::adaptive, Method::cvode_adams,
                            Method::cvode_bdf, Method::fixed}) {
    Integrator run(plant, {.method = method});
    run.start(0.0, rest.x);
    PlantInput input = rest.input;
    input.command[3] = NAN;
    EXPECT_EQ(message_of([&] { run.advance(1e-3, input); }),
              "simulation stopped at 0 s: a command or a wrench is not finite");
    auto x = rest.x;
    x[plant.layout().cap(1)] = NAN;
    run.start(0.0, x);
    EXPECT_THAT(message_of([&] { run.advance(1e-3, rest.input); }),
                testing::HasSubstr("leg2.p_cap is not finite"));
  }
}

TEST(Failures, PosesThatCannotBeHeld) {
  auto machine = heavy();
  const Plant plant(machine, ModelKind::rigid);
  auto high = machine.neutral();
  high.p_BP.z() += 0.2;
  EXPECT_THAT(message_of([&] { static_cast<void>(plant.equilibrium(high)); }),
              testing::HasSubstr("leg 1: at this pose the piston stands at"));
  machine.hydraulics.supply.pressure = 2e6;
  for (auto& leg : machine.legs) leg.hydraulics.equivalent_cylinder.area = 7e-4;
  const Plant weak(machine, ModelKind::rigid);
  EXPECT_THAT(message_of([&] { static_cast<void>(weak.equilibrium(machine.neutral())); }),
              testing::HasSubstr("cannot hold the static force of"));
}

}  // namespace
}  // namespace hydrapod::test
