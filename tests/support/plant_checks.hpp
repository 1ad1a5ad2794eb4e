#pragma once
/// What is asked of every plant: its poles, and where its energy goes.

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

/// Of small motions about x, which need not be a rest.
inline Eigen::VectorXcd poles_of(const simulation::Plant& plant, const Eigen::VectorXd& x,
                                 const simulation::PlantInput& input = {}) {
  const auto linear = plant.linearise(x, input);
  Eigen::VectorXd d(linear.A.rows());  // the rotation has three numbers there
  d << plant.scales().head(3), plant.scales().segment(4, linear.A.rows() - 3);
  return numerics::eigen_pairs(d.cwiseInverse().asDiagonal() * linear.A * d.asDiagonal()).values;
}

/// Away from x by up to 0.3 of the scales.
inline Eigen::VectorXd beside(const simulation::Plant& plant, Eigen::VectorXd x, Random& random) {
  const Eigen::VectorXd scales = plant.scales();
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += 0.3 * random.uniform(-1.0, 1.0) * scales[k];
  return x;
}

/// Ė = −(what is dissipated) at x, by a central difference along the motion. Of plants without
/// hydraulics. Returns what is dissipated [W].
inline double expect_energy_account(const simulation::Plant& plant, const Eigen::VectorXd& x,
                                    const simulation::PlantInput& input) {
  Eigen::VectorXd rate(x.size());
  EXPECT_TRUE(plant.derivative(0.0, x.data(), input, rate.data()));
  const auto energy = [&](double h) {
    const Eigen::VectorXd at = x + h * rate;
    const auto out = plant.outputs(at.data(), input);
    return out.energies.total() + out.oil_spring_energy + out.seal_arms_energy;
  };
  const double h = 1e-6;
  const double change =
      (8.0 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12.0 * h);
  const double lost = plant.outputs(x.data(), input).dissipation;
  const double rounding = 1e-14 * std::abs(energy(0.0)) / h;  // of the energy
  EXPECT_NEAR(change, -lost, 1e-6 * std::abs(lost) + 10.0 * rounding);
  return lost;
}

}  // namespace hydrapod::test
