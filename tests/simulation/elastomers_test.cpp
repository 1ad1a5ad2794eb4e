/// Elastomers in the plant: poles of its linearisation, energy, a step against the exact response
/// of arms.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/plant.hpp"
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
      const auto linear = plant.linearise(rest.x, rest.input);
      Eigen::VectorXd d(linear.A.rows());  // the rotation has three numbers there
      d << plant.scales().head(3), plant.scales().segment(4, linear.A.rows() - 3);
      const auto poles =
          numerics::eigen_pairs(d.cwiseInverse().asDiagonal() * linear.A * d.asDiagonal()).values;
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

/// Ė = −(what is dissipated) in any state, by a central difference along the motion.
TEST(PlantWithElastomers, LosesTheEnergyThatItsArmsDissipate) {
  test::Random random(412);
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    const auto machine = machine_with_elastomers(random, model::FlexibleAxes::gimbal);
    const auto& X_BP = machine.poses.front().X_BP;
    const Plant plant(machine, kind, {.hydraulics = false, .friction = Friction::none}, X_BP);
    const auto rest = plant.equilibrium(X_BP);
    for (int trial = 0; trial < 5; ++trial) {
      Eigen::VectorXd x = rest.x;
      const Eigen::VectorXd scales = plant.scales();
      for (Eigen::Index k = 0; k < x.size(); ++k)
        x[k] += 0.3 * random.uniform(-1.0, 1.0) * scales[k];
      Eigen::VectorXd rate(x.size());
      ASSERT_TRUE(plant.derivative(0.0, x.data(), rest.input, rate.data()));
      const auto energy = [&](double h) {
        const Eigen::VectorXd at = x + h * rate;
        const auto out = plant.outputs(at.data(), rest.input);
        return out.energies.total() + out.oil_spring_energy + out.seal_arms_energy;
      };
      const double h = 1e-6;
      const double change =
          (8.0 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12.0 * h);
      const double lost = plant.outputs(x.data(), rest.input).dissipation;
      EXPECT_GT(lost, 0.0);
      // rounding of the energy over h
      const double rounding = 1e-14 * std::abs(energy(0.0)) / h;
      EXPECT_NEAR(change, -lost, 1e-6 * lost + 10.0 * rounding);
    }
  }
}

}  // namespace
}  // namespace hydrapod::simulation
