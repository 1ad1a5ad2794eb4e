/// What runs in real time allocates nothing: the plant's right-hand side and the integrators.

#include <gtest/gtest.h>

#include "allocations/allocations.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using simulation::Plant;

TEST(RealTime, ThePlantAndItsIntegratorsAllocateNothing) {
  auto machine = published_machine();
  machine.hydraulics.supply.pump_flow = 1e-3;
  for (auto& leg : machine.legs) {
    leg.piston_ring = model::PistonRing{.stiffness = 2e6, .damping = 500.0};
    leg.hydraulics.joint_friction = {.viscous = 1.0, .coulomb = 2.0, .bristle_stiffness = 4e4};
    leg.hydraulics.friction.bristles = model::LuGreBristles{3e7, 1e3};
    leg.gimbal_stiffness = 1.3e7;
    leg.guide_sleeve.elastomer = {
        .dynamic_ratio = 1.6, .loss_factor = 0.2, .frequency = 9.0, .softening = 0.31};
    leg.piston_ring->elastomer = leg.guide_sleeve.elastomer;
  }
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full})
    for (const auto method : {simulation::Method::fixed, simulation::Method::exponential}) {
      const Plant plant(machine, kind);
      const auto rest = plant.equilibrium(machine.neutral());
      Eigen::VectorXd rate(plant.layout().size);
      simulation::Integrator run(plant, {.method = method, .fixed_step = 5e-5});
      run.start(0.0, rest.x);
      simulation::PlantInput input = rest.input;
      const long before = allocations;
      ASSERT_TRUE(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
      for (int k = 1; k <= 10; ++k) {
        input.command[k % 6] += 0.02;
        run.advance(1e-3 * k, input);
      }
      EXPECT_EQ(allocations - before, 0) << dynamics::name(kind) << name(method);
    }
}

}  // namespace
}  // namespace hydrapod::test
