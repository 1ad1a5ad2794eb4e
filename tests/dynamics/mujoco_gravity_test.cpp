/// Equilibrium, stiffness and frequencies of machines under gravity, against the same mechanisms in
/// MuJoCo, whose equilibrium and stiffness are found from its forces alone.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/mujoco_equilibrium.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using model::FlexibleAxes;

/// Worst differences between a machine here and in MuJoCo.
struct Differences {
  double oil_force{};    ///< relative to the largest of the six
  double bend{};         ///< case and rod directions [rad], piston offset relative to the leg
  double frequency{};    ///< relative
  double lowest{1e300};  ///< smallest ω², to know on which side of buckling the cases are

  void include(const Differences& other) {
    oil_force = std::max(oil_force, other.oil_force);
    bend = std::max(bend, other.bend);
    frequency = std::max(frequency, other.frequency);
    lowest = std::min(lowest, other.lowest);
  }
};

Differences compare(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind) {
  auto expected = mujoco_equilibrium(machine, X_BP, kind);
  EXPECT_LE(expected.residual, 1e-11);
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  Differences differ;
  const double largest_force = expected.oil_force.lpNorm<Eigen::Infinity>();
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& state = model.statics.legs[i];
    const Matrix3& R_BL = model.legs[i].frame.R_BL;
    const Vector3 rod =
        R_BL * (Eigen::AngleAxisd(state.flexible[0], Vector3::UnitX()) *
                Eigen::AngleAxisd(state.flexible[1], Vector3::UnitY()) * Vector3::UnitZ());
    const Vector3 offset = R_BL * Vector3(state.flexible[2], state.flexible[3], 0.0);
    differ.include({.oil_force = std::abs(state.oil_force - expected.oil_force[i]) / largest_force,
                    .bend = std::max(
                        {(R_BL.col(2) - expected.hexapod.case_axes(i).col(2)).norm(),
                         (rod - expected.hexapod.rod_direction(i)).norm(),
                         (offset - expected.hexapod.piston_offset(i)).norm() / model.legs[i].l})});
  }
  const MatrixXd K = stiffness_at(expected);
  const VectorXd lambda = omega_squared(mass_at(expected), 0.5 * (K + K.transpose()));
  differ.frequency = worst_frequency_error(omega_squared(model.M, model.K), lambda);
  differ.lowest = lambda[0];
  return differ;
}

class UnderGravity : public testing::TestWithParam<std::tuple<FlexibleAxes, ModelKind>> {};

TEST_P(UnderGravity, EquilibriumAndFrequenciesAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(19640519);
  Differences worst;
  for (int i = 0; i < 12; ++i) {
    const auto machine = random_machine(
        random, {.axes = axes, .gravity = i % 3 ? Gravity::down : Gravity::anywhere});
    for (const auto& pose : machine.poses) {
      const auto differ = compare(machine, pose.X_BP, kind);
      fmt::print("{} {}: load {:.2f} force {:.2e} bend {:.2e} freq {:.2e} lowest {:.3g}\n", i,
                 pose.name, largest_load_share(machine, pose.X_BP), differ.oil_force, differ.bend,
                 differ.frequency, differ.lowest);
      worst.include(differ);
    }
  }
  EXPECT_LE(worst.oil_force, 1e-9);
  EXPECT_LE(worst.bend, 1e-9);
  EXPECT_LE(worst.frequency, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    , UnderGravity,
    testing::Combine(testing::Values(FlexibleAxes::transverse, FlexibleAxes::gimbal),
                     testing::Values(ModelKind::rigid, ModelKind::guide, ModelKind::full)),
    [](const auto& test) {
      const bool gimbal = std::get<0>(test.param) == FlexibleAxes::gimbal;
      return std::string(gimbal ? "gimbal_" : "transverse_") +
             dynamics::name(std::get<1>(test.param));
    });

}  // namespace
}  // namespace hydrapod::test
