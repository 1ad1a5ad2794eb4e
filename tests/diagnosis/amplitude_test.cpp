/// Causes that show at amplitudes alone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "diagnosis/evidence.hpp"
#include "support/modes_at_amplitude.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;
using test::BlindCase;
using test::names_of;

const std::vector<std::string> stated_softening{
    "legs.guide_sleeve.elastomer.dynamic_ratio=1.73",
    "legs.guide_sleeve.elastomer.loss_factor=0.17", "legs.guide_sleeve.elastomer.frequency=7.3 Hz",
    "legs.guide_sleeve.elastomer.softening=0.17",
    "legs.guide_sleeve.elastomer.softening_amplitude=0.03 mm"};

/// Modes at 0.01 and 0.1 mm, by their branches, with noise.
observation::Targets at_two_amplitudes(const BlindCase&, const model::MachineFile& truth) {
  test::Random random(41);
  observation::Targets all;
  for (const double amplitude : {1.1e-5, 9.7e-5}) {
    auto some = test::noisy_modes(
        {test::modes_at_amplitude(amplitude)(truth.machine, *find_pose(truth.machine, "surge"))},
        0.02, {.frequency = 5e-4, .shape = 0.015}, random);
    for (auto& mode : some.modes) {
      mode.amplitude = amplitude;
      all.modes.push_back(mode);
    }
  }
  return all;
}

/// Of the two causes that make the seals softer the softening alone does so at one amplitude more
/// than at the other.
TEST(CausesAtAmplitudes, SofteningIsToldFromSofterSeals) {
  const BlindCase planted{.machine = "heavy-platform.toml",
                          .fault = {"legs.guide_sleeve.elastomer.softening=0.47"}};
  auto faulty = stated_softening;
  faulty.insert(faulty.end(), planted.fault.begin(), planted.fault.end());
  const auto file = test::machine_file(planted.text(), stated_softening);
  const auto targets =
      weighted_targets(file, at_two_amplitudes(planted, test::machine_file(planted.text(), faulty)),
                       {.frequency_error = 1e-4});
  std::vector<Cause> both;
  for (const auto& cause : causes_of(file))
    if (cause.kind == Cause::Kind::softening ||
        (cause.kind == Cause::Kind::guide_sleeves && !cause.leg))
      both.push_back(cause);
  ASSERT_EQ(both.size(), 2U);
  const Evidence evidence(file, targets, ModelKind::guide, both);
  const auto softer = evidence.explain({0}, nullptr, {}),
             softening = evidence.explain({1}, nullptr, {});
  const auto& number = softening.fit.parameters.at(0);
  EXPECT_NEAR(number.value, 0.47, 3.0 * number.deviation);
  EXPECT_LT(number.deviation, 0.1);
  EXPECT_GT(softer.misfit, softening.misfit + 20.0);
  EXPECT_GT(evidence.nominal().misfit, softening.misfit + 100.0);
}

/// Without amplitudes it changes nothing, and is no cause.
TEST(CausesAtAmplitudes, AreLeftOutWhereNoModeHasOne) {
  auto overrides = stated_softening;
  overrides.insert(
      overrides.end(),
      {"legs.friction.coulomb=310 N", "legs.friction.bristles.stiffness=23 kN/mm",
       "legs.joint_friction.coulomb=5 N m", "legs.joint_friction.bristle_stiffness=3e5"});
  const auto file =
      test::machine_file(BlindCase{.machine = "heavy-platform.toml"}.text(), overrides);
  const auto causes = causes_of(file);
  EXPECT_EQ(std::ranges::count_if(causes, needs_amplitude), 3);
  test::Random random(43);
  auto targets = test::noisy_modes(file.machine, {"surge"}, ModelKind::guide, {}, random);
  const auto d = diagnose(file, targets, ModelKind::guide, {}, {}, [](double) { return true; });
  EXPECT_EQ(std::ranges::count_if(d.causes, needs_amplitude), 0);
  EXPECT_EQ(d.causes.size() + 3, causes.size());
}

}  // namespace
}  // namespace hydrapod::diagnosis
