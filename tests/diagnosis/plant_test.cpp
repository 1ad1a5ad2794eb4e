/// Diagnoses of what the drives of the valves see: modes of mechanics, oil and valves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "hydrapod/calibration/observation.hpp"
#include "hydrapod/kinematics/inverse.hpp"

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

/// Modes and responses to drives in directions of the platform, with 1 % of noise.
calibration::Targets with_responses(const BlindCase& test, const model::MachineFile& truth) {
  auto targets = by_plant(test, truth);
  test::Random random(271u);
  for (const auto& name : test.poses) {
    const auto& machine = truth.machine;
    const auto pose = std::ranges::find(machine.poses, name, &model::NamedPose::name);
    const auto plant = calibration::observe_plant(machine, pose->X_BP, test.kind);
    const auto& X_BP = pose->X_BP;
    calibration::ResponseTarget all{.pose = name};
    all.drives = kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), X_BP.p_BP);
    spatial::Matrix6 to_origin = spatial::Matrix6::Identity();
    to_origin.topRightCorner<3, 3>() = -spatial::skew(X_BP.p_BP - plant.mechanics.p_BC);
    constexpr double noise = 0.01;
    for (double hertz = 2.0; hertz < 50.0; hertz *= 1.003) {
      const std::complex<double> s(0.93, 2.0 * std::numbers::pi * hertz);
      Eigen::MatrixXcd H = to_origin * plant.response(s) * all.drives;
      for (auto& h : H.reshaped())
        h *= 1.0 + noise * std::complex<double>(test::normal(random), test::normal(random));
      all.s.push_back(s);
      all.H.push_back(H);
      all.deviation.emplace_back(Eigen::VectorXd::Constant(6, std::sqrt(2.0) * noise));
    }
    targets.responses.push_back(all);
  }
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

/// Which of six like legs has the soft sleeve frequencies and shapes do not tell; how the platform
/// moves between the resonances does.
TEST(DiagnosePlant, ResponsesTellTheLegThatModesDoNot) {
  const BlindCase one_leg{.machine = "zhang-jiang-2021.toml",
                          .fault = {"leg.3.guide_sleeve.stiffness=0.1053 kN/mm"},
                          .planted = {"guide sleeve of leg 3"}};
  const auto modes = test::run_blind(one_leg, by_plant);
  const auto all = test::run_blind(one_leg, with_responses);
  EXPECT_TRUE(all.found) << test::verdict(all.diagnosis);
  EXPECT_LT(all.diagnosis.alike.size(), modes.diagnosis.alike.size())
      << test::verdict(modes.diagnosis) << "\n"
      << test::verdict(all.diagnosis);
}

/// What one line shows that no mode was found for is said.
TEST(DiagnosePlant, SaysWhichResponseAnExplanationMisses) {
  const auto result = test::run_blind({.machine = "zhang-jiang-2021.toml"}, with_responses);
  const auto& d = result.diagnosis;
  EXPECT_EQ(d.finding, Finding::as_stated) << test::verdict(d);
  ASSERT_EQ(d.targets.responses.size(), 1U);
  EXPECT_LE(d.targets.responses[0].s.size(), 48U);
  const auto rigid = std::ranges::find_if(d.explanations, &Explanation::rigid);
  EXPECT_THAT(rigid->wrong, testing::Contains(HasSubstr("with the measured response")));
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
