/// Gimbals that give way along the leg, in series with the oil: energy, limits, a run in time.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "hydrapod/simulation/closed_loop.hpp"
#include "support/published_machine.hpp"
#include "support/random.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using simulation::Plant;
using simulation::PlantInput;

constexpr double k_h = 3.85353e6;  // of the published machine

model::Machine heavy(double gimbal_stiffness) {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.stiffness *= 20.0;
    if (gimbal_stiffness > 0.0) leg.gimbal_stiffness = gimbal_stiffness;
  }
  return machine;
}

/// What the oil does on its pistons, less friction and dampers, is what mechanism and gimbals hold
/// more: valves open, leaking, moving.
TEST(Gimbals, KeepTheWorkOfTheOil) {
  auto machine = heavy(0.9 * k_h);
  machine.legs[3].gimbal_stiffness = 0.2 * k_h;
  machine.legs[5].gimbal_stiffness.reset();
  for (auto& leg : machine.legs) leg.hydraulics.friction.viscous = 310.0;
  const Plant plant(machine, ModelKind::rigid);
  const auto rest = plant.equilibrium(machine.neutral());
  simulation::Integrator run(plant, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-12});
  run.start(0.0, rest.x);
  PlantInput input = rest.input;
  for (int i = 0; i < 6; ++i) input.command[i] += 0.11 * std::cos(1.0 + 2.0 * i);
  const auto energy = [](const simulation::PlantOutput& out) {
    return out.energies.total() + out.gimbal_energy;
  };
  const auto power = [](const simulation::PlantOutput& out) {
    double sum = -out.dissipation;
    for (const auto& leg : out.legs) sum += leg.oil_force * leg.piston_rate;
    return sum;
  };
  const auto first = plant.outputs(rest.x.data(), rest.input);
  EXPECT_NEAR(power(first), 0.0, 1e-6);
  constexpr int samples = 4000;
  constexpr double interval = 5e-5;
  double work = 0.0, lowest = first.gimbal_energy, highest = lowest;
  work += power(plant.outputs(rest.x.data(), input));
  for (int k = 1; k <= samples; ++k) {
    run.advance(k * interval, input);
    const auto out = plant.outputs(run.state().data(), input);
    work += (k == samples ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * power(out);
    lowest = std::min(lowest, out.gimbal_energy);
    highest = std::max(highest, out.gimbal_energy);
  }
  work *= interval / 3.0;
  const auto last = plant.outputs(run.state().data(), input);
  const double gained = energy(last) - energy(first);
  EXPECT_GT(highest - lowest, 1e-2 * gained);  // the gimbals took part
  EXPECT_NEAR(work, gained, 1e-8 * gained);
}

/// A state in motion, off rest in everything.
Eigen::VectorXd moved(const Plant& plant, PlantInput& input) {
  Random random(31);
  auto rest = plant.equilibrium(plant.machine().neutral());
  for (int k = 0; k < 6; ++k) {
    rest.x[plant.layout().velocity() + k] = random.uniform(-0.1, 0.1);
    rest.x[plant.layout().cap(k)] += random.uniform(-1e6, 1e6);
    rest.x[plant.layout().spool(k)] += random.uniform(-0.3, 0.3);
  }
  input = rest.input;
  return rest.x;
}

TEST(Gimbals, ThatAreStiffComeAsCloseToRigidOnesAsOnePerTheirStiffness) {
  PlantInput input;
  const Plant rigid(heavy(0.0), ModelKind::guide);
  const Eigen::VectorXd x = moved(rigid, input);
  Eigen::VectorXd expected(x.size()), found(x.size());
  ASSERT_TRUE(rigid.derivative(0.0, x.data(), input, expected.data()));
  const auto error = [&](double ratio) {
    const Plant plant(heavy(ratio * k_h), ModelKind::guide);
    EXPECT_TRUE(plant.derivative(0.0, x.data(), input, found.data()));
    return (found - expected).cwiseQuotient(rigid.scales()).cwiseAbs().maxCoeff();
  };
  const double scale = expected.cwiseQuotient(rigid.scales()).cwiseAbs().maxCoeff();
  const double at_1e4 = error(1e4), at_1e6 = error(1e6);
  EXPECT_LT(at_1e4, 1e-3 * scale);
  EXPECT_NEAR(at_1e4 / at_1e6, 100.0, 0.1);
  EXPECT_LE(error(1e18), 1e-14 * scale);
}

/// The file's lengths hold at the reference pose; elsewhere the pistons make up for what the load
/// presses out of the gimbals.
TEST(Gimbals, LeaveThePistonWhereTheFileSaysAtTheReferencePose) {
  const auto machine = heavy(0.3 * k_h);
  const Plant plant(machine, ModelKind::rigid);
  const auto legs_at = [&](const spatial::Pose& X_BP) {
    const auto rest = plant.equilibrium(X_BP);
    return plant.outputs(rest.x.data(), rest.input).legs;
  };
  auto tilted = machine.neutral();
  tilted.R_BP = spatial::rotation_from_rpy({0.0, 0.12, 0.0});
  const auto neutral = legs_at(machine.neutral()), away = legs_at(tilted);
  for (int i = 0; i < 6; ++i) {
    const double rod = machine.legs[i].rod.length;
    EXPECT_NEAR(neutral[i].piston, neutral[i].length - rod, 1e-12);
    EXPECT_NEAR(away[i].piston - (away[i].length - rod),
                (away[i].oil_force - neutral[i].oil_force) / (0.3 * k_h), 1e-12);
  }
  EXPECT_GT(std::abs(away[0].piston - (away[0].length - machine.legs[0].rod.length)), 1e-5);
}

/// Inputs that change every millisecond, gimbals from as good as rigid to a fiftieth of the oil.
TEST(Gimbals, RunInTimeFromVeryStiffToVerySoft) {
  const auto end_of_run = [](double gimbal_stiffness, simulation::Method method) {
    const auto machine = heavy(gimbal_stiffness);
    const Plant plant(machine, ModelKind::guide);
    const auto rest = plant.equilibrium(machine.neutral());
    simulation::Integrator run(plant, {.method = method});
    run.start(0.0, rest.x);
    Random random(3);
    PlantInput input = rest.input;
    for (int k = 1; k <= 400; ++k) {
      for (int i = 0; i < 6; ++i)
        input.command[i] = rest.input.command[i] + random.uniform(-0.2, 0.2);
      run.advance(1e-3 * k, input);
    }
    EXPECT_TRUE(run.state().allFinite());
    struct End {
      Eigen::VectorXd moved;
      long steps;
    };
    return End{(run.state() - rest.x).head<3>(), run.statistics().steps};
  };
  using simulation::Method;
  for (const auto method :
       {Method::exponential, Method::adaptive, Method::cvode_bdf, Method::fixed}) {
    const auto rigid = end_of_run(0.0, method), stiff = end_of_run(1e9 * k_h, method);
    EXPECT_GT(rigid.moved.norm(), 1e-4);
    EXPECT_LT((stiff.moved - rigid.moved).norm(), 1e-3 * rigid.moved.norm());
    EXPECT_LE(static_cast<double>(stiff.steps), 1.05 * static_cast<double>(rigid.steps));
    const auto soft = end_of_run(0.02 * k_h, method);
    EXPECT_LT(soft.moved.norm(), 0.05);
    EXPECT_LE(static_cast<double>(soft.steps), 2.0 * static_cast<double>(rigid.steps));
  }
}

}  // namespace
}  // namespace hydrapod::test
