/// The published machine: the frequencies of docs/validation, to the digits printed there.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/mujoco_equilibrium.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using testing::DoubleNear;
using testing::Pointwise;

/// Descending, as the paper prints them [rad/s].
std::vector<double> frequencies(const model::Machine& machine, ModelKind kind) {
  const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
  const Eigen::VectorXd lambda = omega_squared(model.M, model.K);
  std::vector<double> omega(lambda.size());
  for (Eigen::Index i = 0; i < lambda.size(); ++i)
    omega[i] = std::sqrt(lambda[lambda.size() - 1 - i]);
  return omega;
}

/// Half a unit of the last of three printed decimals.
constexpr double printed = 0.5e-3;

TEST(PublishedMachine, HasItsEighteenFrequenciesToThePrintedDigit) {
  EXPECT_THAT(frequencies(published_machine(), ModelKind::guide),
              Pointwise(DoubleNear(printed),
                        {189.320, 189.319, 143.380, 112.210, 53.473, 53.434, 53.387, 53.387, 53.387,
                         53.386, 53.382, 53.364, 53.364, 53.353, 53.298, 53.281, 46.781, 46.781}));
}

TEST(PublishedMachine, HasItsSixRigidFrequenciesToThePrintedDigit) {
  EXPECT_THAT(frequencies(published_machine(), ModelKind::rigid),
              Pointwise(DoubleNear(printed), {189.241, 189.241, 143.364, 112.065, 46.839, 46.839}));
}

/// The paper's Table 2: platform modes to its two decimals, seal modes to 0.08 %.
TEST(PublishedMachine, ReproducesTable2) {
  const std::vector<double> table{189.32, 189.32, 143.38, 112.21, 53.51, 53.39,
                                  53.39,  53.39,  53.39,  53.39,  53.39, 53.35,
                                  53.35,  53.35,  53.30,  53.30,  46.78, 46.78};
  const auto omega = frequencies(published_machine(), ModelKind::guide);
  ASSERT_EQ(omega.size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const bool platform_mode = i < 4 || i > 15;
    constexpr double half_digit = 0.005;
    EXPECT_NEAR(omega[i], table[i], half_digit + (platform_mode ? 0.0 : 8e-4 * table[i]))
        << "mode " << i + 1;
  }
}

model::Machine published_machine_under_gravity(model::FlexibleAxes axes) {
  auto machine = published_machine();
  machine.flexible_axes = axes;
  machine.gravity = {0.0, 0.0, -9.81};
  return machine;
}

/// Gravity is what makes the seals matter: x and y fall from 46.84 rad/s by a third, not by a
/// thousandth. The expected values were found once from the exact potential energy by differences,
/// from parameters that are rounded a little differently.
TEST(PublishedMachine, UnderGravityLosesAThirdOfItsLowestFrequencies) {
  const auto machine = published_machine_under_gravity(model::FlexibleAxes::transverse);
  const std::vector<double> expected{189.93, 189.93, 144.1, 112.2, 49.33, 49.33,
                                     33.1,   33.1,   33.1,  33.1,  33.1,  33.1,
                                     33.0,   33.0,   33.0,  32.9,  31.36, 31.36};
  const auto omega = frequencies(machine, ModelKind::guide);
  ASSERT_EQ(omega.size(), expected.size());
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const bool two_decimals = i < 2 || i == 4 || i == 5 || i > 15;
    const double half_digit = two_decimals ? 0.005 : 0.05;
    EXPECT_NEAR(omega[i], expected[i], half_digit + 1e-4 * expected[i]) << "mode " << i + 1;
  }
  const auto rigid = frequencies(machine, ModelKind::rigid);
  EXPECT_NEAR(omega[17] / rigid[5], 2.0 / 3.0, 0.01);
}

class PublishedMachineUnderGravity : public testing::TestWithParam<model::FlexibleAxes> {};

TEST_P(PublishedMachineUnderGravity, HasTheFrequenciesOfMujoco) {
  const auto machine = published_machine_under_gravity(GetParam());
  auto equilibrium = mujoco_equilibrium(machine, machine.neutral(), ModelKind::guide);
  const MatrixXd K = stiffness_at(equilibrium);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  constexpr double differences = 1e-8;  // as in mujoco_gravity_test.cpp
  EXPECT_LE(worst_frequency_error(omega_squared(model.M, model.K),
                                  omega_squared(mass_at(equilibrium), 0.5 * (K + K.transpose()))),
            differences);
}

INSTANTIATE_TEST_SUITE_P(, PublishedMachineUnderGravity, both_axes(),
                         [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace hydrapod::test
