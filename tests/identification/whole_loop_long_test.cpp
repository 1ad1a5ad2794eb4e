/// From the rig's record to modes, the sharp and weak ones too.

#include "hydrapod/base/units.hpp"
#include "whole_loop.hpp"

namespace hydrapod::identification {
namespace {

using base::two_pi;

TEST(WholeLoopLong, PublishedMachineWithBothResonancesInXAndY) {
  const auto machine = simulation::machine_of("zhang-jiang-2021");
  const test::RigExperiment experiment{
      .X_BP = machine.neutral(), .duration = 3600.0, .level = 3e-4, .seed = 21};
  const auto found = test::identified_on_rig(machine, experiment);
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.004});
}

TEST(WholeLoopLong, HeavyPlatform) {
  const auto machine = simulation::machine_of("heavy-platform");
  const test::RigExperiment experiment{
      .X_BP = machine.neutral(), .duration = 600.0, .level = 1e-4, .seed = 22};
  const auto found = test::identified_on_rig(machine, experiment);
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.04});
}

/// As `--excite "noise all=0.01 mm, to=40"` does. Of 300 s the intervals of the lowest frequencies
/// are wider than 0.3 %.
TEST(WholeLoopLong, HeavyPlatformExcitedUpTo40Hz) {
  const auto machine = simulation::machine_of("heavy-platform");
  const test::RigExperiment experiment{.X_BP = machine.neutral(),
                                       .duration = 600.0,
                                       .level = 1e-5,
                                       .form = signals::Noise{.to = 40.0},
                                       .seed = 1};
  const auto found = test::identified_on_rig(machine, experiment);
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.04});
  // the controller's integral and the drives' friction prevail in the lowest lines
  ASSERT_EQ(found.responses.warnings.size(), 2U);
  EXPECT_EQ(found.responses.warnings[0].kind, data::ResponseWarning::Kind::excited_band);
  EXPECT_NEAR(found.responses.warnings[0].highest, 40.0, 2.0);
  EXPECT_EQ(found.responses.warnings[1].kind, data::ResponseWarning::Kind::weak_excitation);
  EXPECT_LT(found.responses.warnings[1].highest, 1.5);
}

/// Longer guided rods with soft piston rings: x and y have a third resonance, at 40 Hz.
TEST(WholeLoopLong, FullModelWithThreeResonancesInXAndY) {
  const auto machine = simulation::machine_of(
      "zhang-jiang-2021-transverse",
      {"legs.guide_sleeve.stiffness=30 kN/m", "legs.guide_sleeve.position=0.738",
       "legs.piston_ring={ stiffness = 3e4 }", "platform.mass=400", "damping.modal_ratio=0.01"});
  const test::RigExperiment experiment{.kind = dynamics::ModelKind::full,
                                       .X_BP = machine.neutral(),
                                       .duration = 1200.0,
                                       .level = 3e-4,
                                       .seed = 23};
  const auto found = test::identified_on_rig(machine, experiment);
  expect_found(found, exact_poles(machine, experiment), {.least_share = 0.004});
  for (const double f : {10.284, 11.00, 39.84})
    EXPECT_EQ(std::ranges::count_if(found.modes,
                                    [&](const IdentifiedMode& m) {
                                      return std::abs(m.fit.omega() / two_pi / f - 1.0) < 3e-3;
                                    }),
              2)
        << f;
}

}  // namespace
}  // namespace hydrapod::identification
