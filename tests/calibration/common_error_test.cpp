/// Fits to frequencies whose errors have a part in common are those of generalised least squares.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "recovery.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using dynamics::ModelKind;

/// Both break the symmetry of the machine: no modes repeat.
constexpr std::array uneven_poses{"surge", "pitched"};

/// The heavy machine, whose platform is 3.1 % heavier than stated, measured at two poses with
/// errors of a few tenths of a per cent, of which more than half are common.
struct Measured {
  model::MachineFile file =
      test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")));
  observation::Targets targets{};
  Eigen::MatrixXd covariance{};

  Measured() {
    const double off[]{0.9, -0.4, 0.3, 1.1, 0.2, -0.7, 0.5, 0.8, -0.1, 0.6, 0.4, -0.2};
    const auto truth = with_mass(1.031 * file.machine.platform.mass);
    int i = 0;
    for (const char* pose : uneven_poses)
      for (auto mode : test::modes_of(truth, pose, ModelKind::rigid)) {
        mode.damped = false;
        mode.deviation = (2.3e-3 + 3e-4 * (i % 4)) * mode.omega;
        mode.common_deviation = 1.9e-3 * mode.omega;
        mode.omega *= 1.0 + 1.6e-3 + 1.1e-3 * off[i++ % 12];
        targets.modes.push_back(mode);
      }
    const auto n = static_cast<Eigen::Index>(targets.modes.size());
    covariance.resize(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < n; ++b) {
        const auto &one = targets.modes[a], &other = targets.modes[b];
        covariance(a, b) =
            a == b ? one.deviation * one.deviation : one.common_deviation * other.common_deviation;
      }
  }

  [[nodiscard]] model::MachineFile with_mass(double mass) const {
    return test::machine_file(file.text, {fmt::format("platform.mass={:.17g}", mass)});
  }

  /// Model less measured [rad/s].
  [[nodiscard]] Eigen::VectorXd differences(double mass) const {
    const auto machine = with_mass(mass).machine;
    Eigen::VectorXd r(covariance.rows());
    Eigen::Index i = 0;
    for (const char* pose : uneven_poses) {
      const auto modes = modal::normal_modes(
          dynamics::linear_model(machine, model::find_pose(machine, pose)->X_BP, ModelKind::rigid));
      for (int k = 0; k < 6; ++k, ++i) r[i] = modes.omega(k) - targets.modes[i].omega;
    }
    return r;
  }
};

/// At the minimum Jᵀ C⁻¹ r is zero, the deviation is (Jᵀ C⁻¹ J)^(−1/2), the misfit rᵀ C⁻¹ r: with
/// the covariance C of the frequencies and their differences by the mass.
TEST(CommonError, OfAFitIsThatOfGeneralisedLeastSquares) {
  const Measured measured;
  Plan plan{.free = test::free_paths({"platform.mass"})};
  plan.options = {.starts = 1, .loss = Loss::squares};
  const auto best = calibrate(measured.file, measured.targets, plan, ModelKind::rigid).best();
  const auto& p = best.parameters.at(0);
  const double h = 1e-5 * p.value;
  const Eigen::VectorXd r = measured.differences(p.value);
  const Eigen::VectorXd J =
      (measured.differences(p.value + h) - measured.differences(p.value - h)) / (2.0 * h);
  const Eigen::MatrixXd weight = measured.covariance.inverse();
  const double curvature = J.dot(weight * J);
  EXPECT_NEAR(best.misfit, r.dot(weight * r), 1e-8 * best.misfit);
  EXPECT_LT(std::abs(J.dot(weight * r)) / std::sqrt(curvature), 1e-4);
  ASSERT_EQ(best.scatter, 1.0) << best.misfit;
  EXPECT_NEAR(p.deviation, 1.0 / std::sqrt(curvature), 1e-4 * p.deviation);
  // as if errors were independent the mass would be known better
  auto alone = measured.targets;
  for (auto& mode : alone.modes) mode.common_deviation = 0.0;
  const auto other = calibrate(measured.file, alone, plan, ModelKind::rigid).best();
  EXPECT_LT(other.parameters.at(0).deviation, 0.98 * p.deviation);
}

}  // namespace
}  // namespace hydrapod::calibration
