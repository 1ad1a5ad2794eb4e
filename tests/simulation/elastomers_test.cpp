/// Elastomers in the plant: poles of its linearisation, energy, a step against the exact response
/// of arms.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/plant_checks.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::simulation {
namespace {

using Complex = std::complex<double>;

model::Machine machine_with_elastomers(test::Random& random, model::FlexibleAxes axes) {
  auto machine = test::random_machine(random, {.axes = axes, .gravity = test::Gravity::down});
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const double d = static_cast<double>(i);
    if (i != 2)
      machine.legs[i].guide_sleeve.elastomer = {
          .dynamic_ratio = 1.27 + 0.13 * d, .loss_factor = 0.14, .frequency = 6.7 + d};
    if (i % 2 == 1)
      machine.legs[i].piston_ring->elastomer = {
          .dynamic_ratio = 1.9, .loss_factor = 0.33 - 0.02 * d, .frequency = 11.3};
  }
  return machine;
}

/// Valves shut and oil as springs: the plant is the mechanics of the linear model.
TEST(PlantWithElastomers, OscillatesAtThePolesOfTheLinearModel) {
  test::Random random(411);
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal})
    for (const auto kind : {ModelKind::guide, ModelKind::full}) {
      const auto machine = machine_with_elastomers(random, axes);
      const auto& X_BP = machine.poses.back().X_BP;
      const Plant plant(machine, kind, {.hydraulics = false, .friction = Friction::none}, X_BP);
      const auto rest = plant.equilibrium(X_BP);
      Eigen::VectorXd rate(plant.layout().size);
      ASSERT_TRUE(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
      EXPECT_LT(rate.segment(0, plant.layout().positions).norm(), 1e-12);
      EXPECT_LT(rate.tail(plant.layout().size - plant.layout().arms).norm(), 1e-12);
      for (std::size_t i = 0; i < model::leg_count; ++i) {
        EXPECT_EQ(plant.layout().sleeve_arms[i] >= 0, i != 2);
        EXPECT_EQ(plant.layout().ring_arms[i] >= 0, kind == ModelKind::full && i % 2 == 1);
      }
      const auto poles = test::poles_of(plant, rest.x, rest.input);
      const auto model = dynamics::linear_model(machine, X_BP, kind);
      const auto modes =
          modal::damped_modes(model, modal::normal_modes(model), model::modal_ratio(machine).value);
      // A state of a seal that is no elastomer would have a pole at zero.
      EXPECT_GT(poles.cwiseAbs().minCoeff(), 1e-6);
      for (const auto& mode : modes) {
        if (!(mode.pole.imag() > 0.0)) continue;
        double nearest = 1e300;
        for (const Complex pole : poles) nearest = std::min(nearest, std::abs(pole - mode.pole));
        // by differences of the plant
        EXPECT_LT(nearest, 1e-7 * std::abs(mode.pole)) << mode.pole;
      }
    }
}

/// In any state.
TEST(PlantWithElastomers, LosesTheEnergyThatItsArmsDissipate) {
  test::Random random(412);
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    const auto machine = machine_with_elastomers(random, model::FlexibleAxes::gimbal);
    const auto& X_BP = machine.poses.front().X_BP;
    const Plant plant(machine, kind, {.hydraulics = false, .friction = Friction::none}, X_BP);
    const auto rest = plant.equilibrium(X_BP);
    for (int trial = 0; trial < 5; ++trial)
      EXPECT_GT(test::expect_energy_account(plant, test::beside(plant, rest.x, random), rest.input),
                0.0);
  }
}

}  // namespace
}  // namespace hydrapod::simulation
