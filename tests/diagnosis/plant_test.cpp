/// Diagnoses of what the drives of the valves see: modes of mechanics, oil and valves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"

namespace hydrapod::diagnosis {
namespace {

using test::BlindCase;
using testing::HasSubstr;

/// As by_noise, of the plant.
calibration::Targets by_plant(const BlindCase& test, const model::MachineFile& truth) {
  test::Random random(7919u * static_cast<std::uint64_t>(test.repetition) + 17u);
  return test::noisy_plant_modes(
      truth.machine, test.poses, test.kind,
      {.frequency = test.noise, .shape = std::min(0.05, 30.0 * test.noise)}, random);
}

calibration::Targets taken_for_mechanics(const BlindCase& test, const model::MachineFile& truth) {
  auto targets = by_plant(test, truth);
  targets.observed = calibration::Observed::mechanics;
  return targets;
}

/// The knees' resonance lies 3 % above x and y and is damped ten times less: undamped modes are not
/// where the poles are.
const BlindCase soft_sleeves{.machine = "zhang-jiang-2021.toml",
                             .fault = {"legs.guide_sleeve.stiffness=0.12586 kN/mm"},
                             .planted = {"guide sleeves of all legs"}};

TEST(DiagnosePlant, TellsTheSleevesOfAllLegsThoughTheirKneeLiesBesideXAndY) {
  const auto result = test::run_blind(soft_sleeves, by_plant);
  EXPECT_TRUE(result.found) << test::verdict(result.diagnosis);
  EXPECT_TRUE(result.diagnosis.notes.empty());
  const auto* sleeves = result.diagnosis.find("guide sleeves of all legs");
  ASSERT_NE(sleeves, nullptr);
  EXPECT_FALSE(sleeves->by_mechanics);
  EXPECT_NEAR(sleeves->fit.parameters[0].value, 0.12586e6, 0.01 * 0.12586e6);
  // what the file states, not where the last fit began
  const auto stated = test::machine_file(soft_sleeves.text(), {}).machine;
  EXPECT_DOUBLE_EQ(sleeves->fit.parameters[0].start, stated.legs[0].guide_sleeve.stiffness);
  // the same taken for modes of mechanics
  const auto other = test::run_blind(soft_sleeves, taken_for_mechanics);
  EXPECT_FALSE(other.first) << test::verdict(other.diagnosis);
}

/// Oil with 4 % of air gets stiffer under the load: as mechanics it is payload and oil at once.
TEST(DiagnosePlant, TellsAPayloadOnOilWithAir) {
  const auto result = test::run_blind({.machine = "heavy-platform.toml",
                                       .fault = {"platform.mass=15.31 t"},
                                       .planted = {"payload (platform mass)"},
                                       .poses = {"neutral"},
                                       .repetition = 4},
                                      by_plant);
  EXPECT_TRUE(result.found) << test::verdict(result.diagnosis);
}

/// A sound machine is not blamed for what the plant adds to mechanics.
TEST(DiagnosePlant, BlamesNothingInASoundMachine) {
  const auto result = test::run_blind({.machine = "zhang-jiang-2021.toml"}, by_plant);
  EXPECT_EQ(result.diagnosis.finding, Finding::as_stated) << test::verdict(result.diagnosis);
  EXPECT_LT(result.diagnosis.as_stated().misfit, 2.0 * result.diagnosis.targets.modes.size());
}

TEST(DiagnosePlant, SaysWhyWhereThePlantCannotBeHad) {
  // legs along the machine's lower end of stroke cannot be held by a supply of 20 bar
  const auto file = test::machine_file(
      test::read_text(test::source_file("models/heavy-platform.toml")), {"supply.pressure=20 bar"});
  test::Random random(3);
  auto targets =
      test::noisy_modes(file.machine, {"neutral"}, dynamics::ModelKind::guide, {}, random);
  targets.observed = calibration::Observed::plant;
  DiagnoseOptions options;
  options.strongest = 0;
  const auto d = diagnose(file, targets, dynamics::ModelKind::guide, file.machine.poses, options);
  ASSERT_EQ(d.notes.size(), 1U);
  EXPECT_THAT(d.notes[0], HasSubstr("compared with mechanics"));
  EXPECT_THAT(d.notes[0], HasSubstr("supply"));
  EXPECT_EQ(d.finding, Finding::as_stated);
}

}  // namespace
}  // namespace hydrapod::diagnosis
