/// What a measurement sees of mechanics with chambers that relax.

#include <gtest/gtest.h>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/observation/observation.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::observation {
namespace {

model::Machine leaking_machine() {
  auto machine = test::symmetric_machine();
  machine.damping = {.modal_ratio = 0.004, .oil = model::OilDamping::chambers};
  for (std::size_t i = 0; i < 6; ++i)
    machine.legs[i].hydraulics.leakage.internal = 1.3e-12 * (1.0 + static_cast<double>(i));
  return machine;
}

/// By residues of all poles here, by elimination there.
TEST(ObservedMechanics, WithChambersRespondAsTheirFrequencyResponse) {
  const auto machine = leaking_machine();
  for (const auto kind : {dynamics::ModelKind::rigid, dynamics::ModelKind::guide}) {
    const auto seen = observe(machine, machine.neutral(), kind, Observed::mechanics);
    const auto linear = dynamics::linear_model(machine, machine.neutral(), kind);
    const auto model = response::response_model(linear, modal::normal_modes(linear), 0.0,
                                                machine.platform.mass_center);
    for (const double omega : {3.0, 41.0, 53.0, 113.0, 190.0, 700.0}) {
      const auto H = response::frequency_response(model, {&omega, 1})[0];
      const auto by_poles =
          seen.response({0.0, omega}, Entry::forces, MotionAgainst::ground, nullptr);
      EXPECT_LT((by_poles - H).norm(), 1e-7 * H.norm()) << omega;
    }
  }
}

TEST(ObservedMechanics, WithChambersHaveTheDampedModes) {
  const auto machine = leaking_machine();
  const auto seen =
      observe(machine, machine.neutral(), dynamics::ModelKind::rigid, Observed::mechanics);
  const auto linear =
      dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::rigid);
  const auto modes = modal::damped_modes(linear, modal::normal_modes(linear), 0.0);
  std::size_t found = 0;
  for (const auto& mode : modes)
    for (const auto& other : seen.modes)
      if (std::abs(other.pole - mode.pole) < 1e-8 * std::abs(mode.pole)) {
        ++found;
        break;
      }
  EXPECT_EQ(found, 6U);
}

}  // namespace
}  // namespace hydrapod::observation
