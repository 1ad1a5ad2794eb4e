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

constexpr const char* of_softening = "softening of the guide sleeves' elastomers";

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

TEST(CausesAtAmplitudes, SofteningIsFound) {
  const BlindCase planted{.machine = "heavy-platform.toml",
                          .design = stated_softening,
                          .fault = {"legs.guide_sleeve.elastomer.softening=0.47"},
                          .planted = {of_softening}};
  const auto d = test::run_blind(planted, at_two_amplitudes).diagnosis;
  EXPECT_THAT(names_of(d), testing::ElementsAre(of_softening)) << test::verdict(d);
  const auto& number = test::find(d, of_softening)->fit.parameters.at(0);
  EXPECT_NEAR(number.value, 0.47, 3.0 * number.deviation);
  EXPECT_LT(number.deviation, 0.05);
  test::expect_round_trip_of({.diagnosis = d});
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
