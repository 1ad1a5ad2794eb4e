#include "support/vibrations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>
#include <vector>

namespace hydrapod::test {

void block_cylinders(model::Machine& machine) {
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.overlap = 0.3;
    leg.hydraulics.valve.leakage = 0.0;
    leg.hydraulics.leakage.internal = 0.0;
  }
}

Eigen::VectorXd tangent_scales(const simulation::Plant& plant) {
  const Eigen::VectorXd scales = plant.scales();
  Eigen::VectorXd tangent(plant.layout().tangent());
  tangent << scales.head<3>(), scales.tail(tangent.size() - 3);
  return tangent;
}

Eigen::VectorXcd vibrations(const simulation::Plant& plant, const spatial::Pose& X_BP) {
  const auto rest = plant.equilibrium(X_BP);
  const auto linear = plant.linearise(rest.x, rest.input);
  // Pascals beside radians would cost the eigenvalues their digits.
  const Eigen::VectorXd scale = tangent_scales(plant);
  const Eigen::MatrixXd A = scale.cwiseInverse().asDiagonal() * linear.A * scale.asDiagonal();
  std::vector<std::complex<double>> found;
  for (const auto& pole : A.eigenvalues())
    if (pole.imag() >= 1.0 && pole.real() >= -100.0) found.push_back(pole);
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.imag() < b.imag(); });
  return Eigen::Map<Eigen::VectorXcd>(found.data(), static_cast<Eigen::Index>(found.size()));
}

Eigen::VectorXd undamped_frequencies(const simulation::Plant& plant, const spatial::Pose& X_BP) {
  const auto poles = vibrations(plant, X_BP);
  for (const auto& pole : poles) EXPECT_NEAR(pole.real(), 0.0, 1e-4 * pole.imag());
  return poles.imag();
}

}  // namespace hydrapod::test
