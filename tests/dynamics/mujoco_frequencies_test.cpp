/// Frequencies of machines without preload, against the same mechanisms in MuJoCo.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/mujoco_hexapod.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using model::FlexibleAxes;

/// Rounding in two long chains of rotations, seen through matrices whose condition reaches 1e6; the
/// worst of 12000 cases was 120 ε.
constexpr double tolerance = 1000.0 * std::numeric_limits<double>::epsilon();
constexpr int machine_count = 110;  // two poses each

/// Worst relative error of the frequencies of one model at one pose.
double frequency_error(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind) {
  const MujocoHexapod mujoco(machine, X_BP, kind);
  const MatrixXd N = mujoco.allowed_motions();
  const VectorXd expected = omega_squared(N.transpose() * mujoco.mass() * N,
                                          N.transpose() * mujoco.stiffness_without_preload() * N);
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  EXPECT_EQ(expected.size(), dynamics::degrees_of_freedom(kind));
  return worst_frequency_error(omega_squared(model.M, model.K), expected);
}

class FrequenciesWithoutPreload : public testing::TestWithParam<AxesAndKind> {};

TEST_P(FrequenciesWithoutPreload, AreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(20210314);
  double worst = 0.0;
  for (int i = 0; i < machine_count; ++i) {
    const auto machine = random_machine(random, {.axes = axes});
    for (const auto& pose : machine.poses) {
      const double error = frequency_error(machine, pose.X_BP, kind);
      EXPECT_LE(error, tolerance) << "machine " << i << ", pose " << pose.name;
      worst = std::max(worst, error);
    }
  }
  RecordProperty("worst_relative_error", fmt::format("{:.1e}", worst));
}

INSTANTIATE_TEST_SUITE_P(, FrequenciesWithoutPreload,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
