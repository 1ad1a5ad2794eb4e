/// No oil is lost: what the valves let in less what leaves is what the chambers hold more.

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/simulation/closed_loop.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using simulation::Integrator;
using simulation::Plant;
using simulation::PlantInput;

struct Account {
  double let_in{};      ///< ∫ (supply − return − external leakage) dt
  double displaced{};   ///< change of the chambers' volumes
  double compressed{};  ///< ∫ V dp / β
  double passed{};      ///< ∫ supply dt: the scale
};

/// Smooth commands, so that Simpson's rule on flows and the trapezoidal rule on (V, p) converge.
Account account(const Plant& plant, double seconds, double interval) {
  const auto rest = plant.equilibrium(plant.machine().neutral());
  const auto& layout = plant.layout();
  Integrator run(plant, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  run.start(0.0, rest.x);
  Account sum;
  auto before = plant.outputs(rest.x.data(), rest.input);
  PlantInput input = rest.input;
  for (int i = 0; i < 6; ++i) input.command[i] += 0.13 * std::cos(1.0 + 2.0 * i);
  const int samples = 2 * static_cast<int>(std::lround(0.5 * seconds / interval));
  const auto flow = [&](const simulation::PlantOutput& out) {
    double leaked = 0.0;
    for (const auto& leg : out.legs) leaked += leg.external_leakage;
    return out.supply_flow - out.return_flow - leaked;
  };
  double simpson = flow(before), drawn = before.supply_flow;
  for (int k = 1; k <= samples; ++k) {
    run.advance(k * interval, input);
    const auto out = plant.outputs(run.state().data(), input);
    const double weight = k == samples ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
    simpson += weight * flow(out);
    drawn += weight * out.supply_flow;
    for (int i = 0; i < 6; ++i) {
      const auto& axis = plant.axis(i);
      const auto from = axis.volumes(before.legs[i].piston), to = axis.volumes(out.legs[i].piston);
      sum.displaced += to.cap - from.cap + to.rod - from.rod;
      const double beta = axis.oil.bulk_modulus;
      sum.compressed += 0.5 * (from.cap + to.cap) / beta *
                            (out.legs[i].cap_pressure - before.legs[i].cap_pressure) +
                        0.5 * (from.rod + to.rod) / beta *
                            (out.legs[i].rod_pressure - before.legs[i].rod_pressure);
    }
    before = out;
  }
  EXPECT_GT(before.legs[0].piston, 0.0);
  EXPECT_LT(layout.cap(0), layout.size);
  sum.let_in = simpson * interval / 3.0;
  sum.passed = drawn * interval / 3.0;
  return sum;
}

TEST(VolumeAccount, IsClosedWhileThePlatformMoves) {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.stiffness *= 10.0;
    leg.hydraulics.leakage = {.internal = 3e-13, .external = 4e-14};
  }
  for (const bool gimbals_give_way : {false, true}) {
    if (gimbals_give_way)
      for (int i = 0; i < 6; ++i) machine.legs[i].gimbal_stiffness = (1.1 + 0.8 * i) * 1e6;
    const Plant plant(machine, ModelKind::rigid);
    const auto sum = account(plant, 0.3, 5e-5);
    EXPECT_GT(std::abs(sum.displaced), 0.01 * sum.passed);
    EXPECT_GT(std::abs(sum.compressed), 1e-5 * sum.passed);
    EXPECT_NEAR(sum.let_in, sum.displaced + sum.compressed, 1e-9 * sum.passed);
  }
}

/// A blocked cylinder, valve shut: oil only goes past the piston, so V_1 p_1 + V_2 p_2 stays, and
/// the difference of pressures falls as exp(−t c β (1/V_1 + 1/V_2)).
TEST(VolumeAccount, OfABlockedCylinderIsClosedToRounding) {
  auto machine = published_machine();
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.overlap = 0.3;
    leg.hydraulics.valve.leakage = 0.0;
    leg.hydraulics.leakage.internal = 5e-12;
  }
  machine.platform.mass = 1e12;  // blocked
  machine.platform.inertia *= 1e12;
  for (auto& leg : machine.legs) leg.hydraulics.equivalent_cylinder.area = 7e-4;
  const Plant plant(machine, ModelKind::rigid, {.friction = simulation::Friction::none});
  auto x = plant.equilibrium(machine.neutral()).x;
  const auto& layout = plant.layout();
  for (int i = 0; i < 6; ++i) x[layout.spool(i)] = 0.0;
  x[layout.cap(0)] = 9.1e6;
  x[layout.rod(0)] = 2.3e6;
  Integrator run(plant, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-12});
  run.start(0.0, x);
  const auto& axis = plant.axis(0);
  const double mean = 0.5 * (9.1e6 + 2.3e6);  // equal volumes
  const double rate = 5e-12 * axis.oil.bulk_modulus * 2.0 / axis.volume.cap;
  for (const double t : {0.003, 0.01, 0.02}) {
    run.advance(t, {});
    const double p_1 = run.state()[layout.cap(0)], p_2 = run.state()[layout.rod(0)];
    EXPECT_NEAR(0.5 * (p_1 + p_2), mean, 1e-9 * mean);
    EXPECT_NEAR(p_1 - p_2, 6.8e6 * std::exp(-rate * t), 1e-8 * 6.8e6);
  }
}

}  // namespace
}  // namespace hydrapod::test
