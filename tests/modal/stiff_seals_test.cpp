/// Seals made rigid by a huge stiffness, as people do to see what they change: the low modes must
/// keep their digits next to frequencies 10⁵ times higher.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "hydrapod/modal/normal_modes.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

class StiffSeals : public testing::TestWithParam<ModelKind> {
 protected:
  static dynamics::LinearModel model_of(model::Machine machine, double stiffness) {
    for (auto& leg : machine.legs) {
      leg.guide_sleeve.stiffness = stiffness;
      leg.piston_ring = model::PistonRing{.stiffness = 1e7};
    }
    return dynamics::linear_model(machine, machine.poses.back().X_BP, GetParam());
  }

  /// Largest relative error of ω², where the exact ones come from extended precision.
  static double worst_error(const dynamics::LinearModel& model) {
    const auto modes = modal::normal_modes(model);
    const Eigen::VectorXd exact = omega_squared(model.M, model.K);
    return ((modes.omega2 - exact).array() / exact.array()).abs().maxCoeff();
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, StiffSeals, testing::Values(ModelKind::guide, ModelKind::full),
                         [](const auto& test) { return std::string(dynamics::name(test.param)); });

/// A normwise stable solver alone loses ε ω_max²/ω²: 1e-9 (guide) and 1e-7 (full) at the stiffest.
TEST_P(StiffSeals, LeaveTheLowModesOfThePublishedMachineTheirDigits) {
  for (const double stiffness : {1e3, 1.5732e5, 1e8, 1e10, 1e12}) {
    SCOPED_TRACE(fmt::format("k_s = {} N/m", stiffness));
    constexpr double ten_digits = 1e-10;
    EXPECT_LE(worst_error(model_of(published_machine(), stiffness)), ten_digits);
  }
}

TEST_P(StiffSeals, LeaveTheLowModesOfRandomMachinesTheirDigits) {
  Random random(1845);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(fmt::format("machine {}", i));
    constexpr double nine_digits = 1e-9;
    EXPECT_LE(worst_error(model_of(random_machine(random), 1e10)), nine_digits);
  }
}

}  // namespace
}  // namespace hydrapod::test
