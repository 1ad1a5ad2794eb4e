/// Frequencies and damping of machines without preload, against the same mechanisms in MuJoCo.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/mujoco_hexapod.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using model::FlexibleAxes;

/// Rounding in two long chains of rotations, seen through matrices whose condition reaches 1e6; the
/// worst of 12000 cases was 430 ε.
constexpr double tolerance = 2000.0 * std::numeric_limits<double>::epsilon();
constexpr int machine_count = 110;  // two poses each
constexpr int mounted_count = 20;

/// Worst relative error of one model at one pose: of the frequencies, and of the square roots of
/// the eigenvalues of M⁻¹C.
double model_error(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind) {
  const MujocoHexapod mujoco(machine, X_BP, kind);
  const MatrixXd N = mujoco.allowed_motions();
  const MatrixXd M = N.transpose() * mujoco.mass() * N;
  const MatrixXd K = N.transpose() * mujoco.stiffness_without_preload() * N;
  const MatrixXd C = N.transpose() * mujoco.damping() * N;
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  EXPECT_EQ(model.M.rows(), mujoco.dof());
  // nothing damps motions of a base with all that stands on it: these come first
  const int damped = dynamics::degrees_of_freedom(kind);
  return std::max(worst_frequency_error(omega_squared(model.M, model.K), omega_squared(M, K)),
                  worst_frequency_error(omega_squared(model.M, model.C).tail(damped),
                                        omega_squared(M, C).tail(damped)));
}

class WithoutPreload : public testing::TestWithParam<AxesAndKind> {};

TEST_P(WithoutPreload, FrequenciesAndDampingAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(20210314);
  double worst = 0.0;
  for (int i = 0; i < machine_count; ++i) {
    const auto machine = random_machine(random, {.axes = axes});
    for (const auto& pose : machine.poses) {
      const double error = model_error(machine, pose.X_BP, kind);
      EXPECT_LE(error, tolerance) << "machine " << i << ", pose " << pose.name;
      worst = std::max(worst, error);
    }
  }
  RecordProperty("worst_relative_error", fmt::format("{:.1e}", worst));
}

/// A base as heavy as the platform, on a mount about as stiff as the legs.
model::BaseMount random_mount(Random& random, const model::Machine& machine) {
  const auto some = [&] { return random.uniform(0.4, 2.5); };
  const double k = hydraulics::oil_stiffness(machine.legs[0], 0.4);
  const double inertia = machine.platform.inertia.trace() / 3.0;
  model::BaseMount mount{.mass = some() * machine.platform.mass,
                         .inertia = some() * inertia * Vector3(1.0, 1.3, 0.9)};
  for (std::size_t d = 0; d < 6; ++d)
    mount.stiffness[d] = some() * k * (d < 3 ? 1.0 : inertia / machine.platform.mass);
  return mount;
}

TEST_P(WithoutPreload, FrequenciesOnASoftMountAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(20261128);
  double worst = 0.0;
  for (int i = 0; i < mounted_count; ++i) {
    auto machine = random_machine(random, {.axes = axes});
    machine.base_mount = random_mount(random, machine);
    // MuJoCo: inertias of joints know the motion against the base alone, transverse legs have none
    for (auto& leg : machine.legs) {
      leg.gimbal_cross_inertia = 0.0;
      if (axes == FlexibleAxes::gimbal) continue;
      leg.cylinder_case.axial_inertia = leg.rod.axial_inertia = 0.0;  // as in MuJoCo
    }
    for (const auto& pose : machine.poses) {
      const double error = model_error(machine, pose.X_BP, kind);
      EXPECT_LE(error, tolerance) << "machine " << i << ", pose " << pose.name;
      worst = std::max(worst, error);
    }
  }
  RecordProperty("worst_relative_error", fmt::format("{:.1e}", worst));
}

INSTANTIATE_TEST_SUITE_P(, WithoutPreload,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
