/// Machines on the rig that give way where the rigid calculation does not expect it: their records
/// show the modes of the linear models.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/modal/normal_modes.hpp"
#include "support/loop_machine.hpp"
#include "support/rig_record.hpp"

namespace hydrapod::test {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Frequencies [Hz] of the linear model's lowest modes.
Eigen::VectorXd calculated(const model::Machine& machine, dynamics::ModelKind kind) {
  const auto modes = modal::normal_modes(dynamics::linear_model(machine, machine.neutral(), kind));
  return modes.omega2.cwiseSqrt() / two_pi;
}

/// The identified frequency next to `frequency` [Hz].
double nearest(const identification::Identification& found, double frequency) {
  double best = 0.0;
  for (const auto& mode : found.modes) {
    const double f = mode.fit.omega() / two_pi;
    if (std::abs(f - frequency) < std::abs(best - frequency)) best = f;
  }
  return best;
}

}  // namespace

TEST(RigWithSoftGimbals, ShowsTheLowerFrequencies) {
  auto machine = simulation::machine_of("zhang-jiang-2021", simulation::smooth);
  const auto rigid = calculated(machine, dynamics::ModelKind::rigid);
  const double k_h = *machine.legs[0].oil_spring.stiffness;
  for (auto& leg : machine.legs) leg.gimbal_stiffness = 1.9 * k_h;
  const auto soft = calculated(machine, dynamics::ModelKind::rigid);
  const auto found = identified_on_rig(machine, {.kind = dynamics::ModelKind::rigid,
                                                 .X_BP = machine.neutral(),
                                                 .duration = 60.0,
                                                 .level = 1.7e-4,
                                                 .seed = 21});
  for (int k = 0; k < 4; ++k) {
    ASSERT_LT(soft[k], 0.85 * rigid[k]);
    // a minute of record; the valves hold the pistons a little
    EXPECT_NEAR(nearest(found, soft[k]), soft[k], 7e-3 * soft[k]);
  }
}

}  // namespace hydrapod::test
