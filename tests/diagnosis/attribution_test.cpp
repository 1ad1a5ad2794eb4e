/// Drops below the rigid calculation, what they belong to, and how stiff the sleeves must be.

#include "hydrapod/diagnosis/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "hydrapod/report/measured_results.hpp"
#include "support/calibration_machine.hpp"
#include "support/round_trip.hpp"
#include "support/run_program.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;

model::Machine heavy(const std::vector<std::string>& overrides = {}) {
  return model::read_machine_file(test::source_file("models/heavy-platform.toml"), overrides,
                                  kinematics::check_machine)
      .machine;
}

const FirstResonance& in(const std::array<FirstResonance, 6>& all, int direction) {
  for (const auto& found : all)
    if (found.main_direction == direction) return found;
  throw std::runtime_error("no such direction");
}

TEST(FirstResonances, OfTheHeavyPlatformAreTheLowerOnesInXAndY) {
  const auto machine = heavy();
  const auto all = first_resonances(machine, machine.neutral(), ModelKind::guide);
  const auto table = modal::mode_table(machine, machine.neutral(), ModelKind::guide);
  for (const int direction : {0, 1}) {
    const auto& found = in(all, direction);
    EXPECT_LT(found.mode, 4);
    EXPECT_NEAR(found.omega, table.real.normal.omega(found.mode), 1e-9 * found.omega);
    EXPECT_GT(found.drop(), 0.3);
  }
}

/// Their seals are as stiff as at the frequency of the mode, not as at quick motions.
TEST(FirstResonances, OfElastomersAreThoseOfDampedModes) {
  const auto machine = heavy({"legs.guide_sleeve.elastomer.dynamic_ratio=1.6",
                              "legs.guide_sleeve.elastomer.loss_factor=0.2",
                              "legs.guide_sleeve.elastomer.frequency=8 Hz"});
  const auto all = first_resonances(machine, machine.neutral(), ModelKind::guide);
  const auto table = modal::mode_table(machine, machine.neutral(), ModelKind::guide);
  for (const int direction : {0, 1}) {
    const auto& found = in(all, direction);
    const auto& mode = table.real.modes[static_cast<std::size_t>(found.mode)].mode;
    EXPECT_NEAR(found.omega, mode.omega, 1e-9 * found.omega);
    EXPECT_LT(found.omega, 0.98 * table.real.normal.omega(found.mode));
  }
}

/// The published machine with transverse axes under gravity: `hydrapod modes` has x at 31.372 rad/s
/// with 17 % of the motion and at 49.321 rad/s with 83 % (docs/validation/zhang-jiang-2021.md).
TEST(FirstResonances, HoldMostOfTheirDirection) {
  const auto machine =
      model::read_machine_file(test::source_file("models/zhang-jiang-2021-transverse.toml"),
                               {"environment.gravity=9.80665"}, kinematics::check_machine)
          .machine;
  const auto all = first_resonances(machine, machine.neutral(), ModelKind::guide);
  const auto any =
      first_resonances(machine, machine.neutral(), ModelKind::guide, {.of_largest = 0.2});
  for (const int direction : {0, 1}) {
    const auto& found = in(all, direction);
    EXPECT_NEAR(found.omega, 49.321, 6e-4);
    EXPECT_NEAR(found.mac, 0.83, 5e-3);
    EXPECT_LT(found.drop(), 0.0);
    ASSERT_TRUE(found.below);
    EXPECT_NEAR(found.below->omega, 31.372, 6e-4);
    EXPECT_NEAR(found.below->mac, 0.17, 5e-3);
    EXPECT_NEAR(found.mac + found.below->mac, 1.0, 1e-3);
    EXPECT_EQ(in(any, direction).omega, found.below->omega);
    EXPECT_FALSE(in(any, direction).below);
  }
  const CaseFile file{.drops = attribute_drops(machine, machine.neutral(), ModelKind::guide)};
  EXPECT_THAT(report::summary(file),
              testing::Contains(testing::AllOf(
                  testing::HasSubstr("a mode at 4.99 Hz, 33 % below the rigid-leg model"),
                  testing::HasSubstr("17 % of the motion, peak 0.38 times"),
                  testing::HasSubstr("resonance is at 7.85 Hz (83 % of the motion"))));
  test::expect_round_trip(report::diagnosis_json(file), report::diagnosis_from_json,
                          report::diagnosis_json);
}

/// 74 % of rx of the heavy machine is above the rigid frequency, and 26 % at 4.29 Hz below.
TEST(FirstResonances, OfTheHeavyPlatformAreTheUpperOnesInRotation) {
  const auto machine = heavy();
  const auto& rx = in(first_resonances(machine, machine.neutral(), ModelKind::guide), 3);
  EXPECT_GT(rx.mac, 0.7);
  EXPECT_LT(rx.drop(), 0.0);
  ASSERT_TRUE(rx.below);
  EXPECT_NEAR(rx.below->omega / (2.0 * std::numbers::pi), 4.289, 5e-4);
  EXPECT_NEAR(rx.below->mac, 0.26, 5e-3);
}

/// Half of the stiffness does not carry the weight, and less does not either, wherever the knees'
/// modes are.
TEST(FirstResonances, OfLegsThatFoldAreNone) {
  for (const double k_s : {0.131e6, 0.437e6}) {
    const auto machine = heavy({fmt::format("legs.guide_sleeve.stiffness={}", k_s)});
    for (const auto& found : first_resonances(machine, machine.neutral(), ModelKind::guide)) {
      EXPECT_EQ(found.omega, 0.0) << k_s;
      EXPECT_EQ(found.drop(), 1.0) << k_s;
    }
  }
}

TEST(Attribution, GivesTheWholeDropToTheOnlyComplianceThereIs) {
  const auto machine = heavy();
  for (const auto& drop : attribute_drops(machine, machine.neutral(), ModelKind::guide)) {
    ASSERT_EQ(drop.parts.size(), 7U);
    EXPECT_EQ(report::part_name(drop.parts[0].part), "guide sleeves of all legs");
    EXPECT_EQ(report::part_name(drop.parts[3].part), "guide sleeve of leg 3");
    // with all sleeves rigid the machine is the rigid one, preload and all
    EXPECT_NEAR(drop.parts[0].omega, drop.resonance.omega_rigid, 1e-4 * drop.resonance.omega_rigid);
  }
}

/// One soft sleeve among stiff ones: stiffening it alone brings back what is lost, the others
/// nothing.
TEST(Attribution, FindsTheOneLegThatIsSoft) {
  const auto machine =
      heavy({"legs.guide_sleeve.stiffness=60 kN/mm", "leg.4.guide_sleeve.stiffness=0.84 kN/mm"});
  const auto drops = attribute_drops(machine, machine.neutral(), ModelKind::guide);
  const AttributedDrop* largest = &drops[0];
  for (const auto& drop : drops)
    if (drop.resonance.drop() > largest->resonance.drop()) largest = &drop;
  ASSERT_GT(largest->resonance.drop(), 0.01);
  for (const auto& share : largest->parts) {
    if (!share.part.leg) continue;
    if (*share.part.leg == 3)
      EXPECT_GT(share.share, 0.95);
    else
      EXPECT_LT(std::abs(share.share), 0.05) << report::part_name(share.part);
  }
}

TEST(Attribution, TellsSleevesFromRings) {
  const auto machine = heavy({"legs.piston_ring.stiffness=40 kN/mm"});
  const auto drops = attribute_drops(machine, machine.neutral(), ModelKind::full);
  for (const auto& drop : drops) {
    if (drop.resonance.main_direction > 1) continue;
    ASSERT_EQ(drop.parts.size(), 14U);
    EXPECT_GT(drop.parts[0].share, 0.8);            // sleeves
    EXPECT_LT(std::abs(drop.parts[1].share), 0.2);  // rings
    EXPECT_EQ(report::part_name(drop.parts[1].part), "piston rings of all legs");
  }
}

/// Seals and beams in series: with stiff sleeves what is lost belongs to the beams.
TEST(Attribution, GivesToRodsAndCasesWhatStiffSleevesLeave) {
  const auto machine = heavy({"legs.bending=elastic", "legs.guide_sleeve.stiffness=400 kN/mm"});
  for (const auto& drop : attribute_drops(machine, machine.neutral(), ModelKind::guide)) {
    ASSERT_EQ(drop.parts.size(), 14U);
    EXPECT_EQ(report::part_name(drop.parts[1].part), "bending of rods and cases of all legs");
    EXPECT_EQ(report::part_name(drop.parts[10].part), "rod and case of leg 3");
    if (drop.resonance.main_direction > 1) continue;
    EXPECT_GT(drop.parts[1].share, 0.9);
    EXPECT_LT(drop.parts[0].share, 0.1);
  }
}

TEST(Remedy, OfSleevesEndsWhereRodsAndCasesBend) {
  const auto machine = heavy({"legs.bending=elastic"});
  const std::vector<model::NamedPose> neutral{machine.poses.front()};
  const auto found = find_remedy(machine, neutral, ModelKind::guide, {.drop = 0.02});
  ASSERT_TRUE(found.limit_without_bending);
  EXPECT_GT(found.limit.drop, found.limit_without_bending->drop + 1e-5);
  EXPECT_LT(found.limit.omega, found.limit_without_bending->omega);
  auto straight = heavy();
  for (auto& leg : straight.legs) leg.guide_sleeve.stiffness *= 1e5;
  const auto rigid = first_resonances(straight, straight.neutral(), ModelKind::guide);
  double drop = 0.0;
  for (const auto& resonance : rigid) drop = std::max(drop, resonance.drop());
  EXPECT_NEAR(found.limit_without_bending->drop, drop, 1e-12);
  const double half_way = 0.5 * (found.limit.drop + found.limit_without_bending->drop);
  CaseFile file{.machine = machine, .kind = ModelKind::guide, .pose = "neutral"};
  file.goal = {.drop = half_way};
  file.remedy = find_remedy(machine, neutral, ModelKind::guide, file.goal);
  EXPECT_EQ(file.remedy->status, RemedyStatus::out_of_reach);
  EXPECT_THAT(report::summary(file),
              testing::Contains(testing::HasSubstr("Bending of rods and cases limits")));
  EXPECT_FALSE(
      find_remedy(heavy(), neutral, ModelKind::guide, {.drop = 0.02}).limit_without_bending);
}

TEST(Remedy, StiffnessPutIntoTheMachineGivesThePromisedDrop) {
  const auto machine = heavy();
  const auto found = find_remedy(machine, machine.poses, ModelKind::guide, {.drop = 0.02});
  ASSERT_EQ(found.status, RemedyStatus::found);
  EXPECT_GT(found.needed.factor, 1.0);
  auto mended = machine;
  for (auto& leg : mended.legs) leg.guide_sleeve.stiffness = found.needed.stiffness;
  double largest = 0.0;
  std::string where;
  for (const auto& pose : mended.poses)
    for (const auto& r : first_resonances(mended, pose.X_BP, ModelKind::guide))
      if (r.drop() > largest) {
        largest = r.drop();
        where = pose.name;
      }
  EXPECT_NEAR(largest, 0.02, 1e-6);
  EXPECT_EQ(where, found.pose);
}

/// With the published weight x is 5.5 % above rigid legs, as a part of it is a third below. Sleeves
/// that are softer would raise it more: they are no remedy.
TEST(Remedy, IsNoSleeveThatPushesResonancesUp) {
  auto machine =
      model::read_machine_file(test::source_file("models/zhang-jiang-2021-transverse.toml"),
                               {"environment.gravity=9.81"}, kinematics::check_machine)
          .machine;
  const std::vector<model::NamedPose> neutral{machine.poses.front()};
  const auto found = find_remedy(machine, neutral, ModelKind::guide, {.drop = 0.023});
  ASSERT_EQ(found.status, RemedyStatus::found);
  EXPECT_GT(found.needed.factor, 1.0);
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= found.needed.factor;
  double largest = 0.0;
  for (const auto& r : first_resonances(machine, machine.neutral(), ModelKind::guide))
    largest = std::max(largest, std::abs(r.drop()));
  EXPECT_NEAR(largest, 0.023, 1e-6);
}

/// One factor on all sleeves keeps the differences between legs: softest and stiffest are stated.
TEST(Remedy, SaysTheRangeOfSleevesThatDiffer) {
  const auto machine =
      heavy({"legs.guide_sleeve.stiffness=900 kN/m", "leg.1.guide_sleeve.stiffness=1.2 MN/m"});
  CaseFile file{.machine = machine,
                .nominal_sleeves = sleeves_of(machine),
                .kind = ModelKind::guide,
                .pose = "neutral",
                .goal = {.drop = 0.02}};
  file.remedy = find_remedy(machine, machine.poses, ModelKind::guide, file.goal);
  ASSERT_EQ(file.remedy->status, RemedyStatus::found);
  const double factor = file.remedy->needed.factor;
  EXPECT_DOUBLE_EQ(file.remedy->needed.stiffness, factor * 1.2e6);
  EXPECT_DOUBLE_EQ(file.remedy->needed.softest.value(), factor * 0.9e6);
  EXPECT_THAT(report::summary(file),
              testing::Contains(testing::HasSubstr(
                  "that of the nominal machine, 900 kN/m to 1.2 MN/m; highest")));
  EXPECT_FALSE(sleeves_of(heavy()).softest);
}

TEST(Remedy, SaysTheLowestResonanceAndTheLargestDropOfToday) {
  const auto machine = heavy();
  const auto found = find_remedy(machine, machine.poses, ModelKind::guide, {.drop = 0.02});
  std::vector<double> omega, drop;
  for (const auto& pose : machine.poses)
    for (const auto& r : first_resonances(machine, pose.X_BP, ModelKind::guide)) {
      omega.push_back(r.omega);
      drop.push_back(1.0 - r.omega / r.omega_rigid);
    }
  EXPECT_DOUBLE_EQ(found.today.omega, std::ranges::min(omega));
  EXPECT_NEAR(found.today.drop, std::ranges::max(drop), 1e-12);
}

TEST(Remedy, ReachesAFrequencyOrSaysWhatRigidSleevesWouldGive) {
  const auto machine = heavy();
  const double rigid =
      in(first_resonances(machine, machine.neutral(), ModelKind::guide), 0).omega_rigid;
  const std::vector<model::NamedPose> neutral{machine.poses.front()};
  const auto found =
      find_remedy(machine, neutral, ModelKind::guide, {.omega = 0.95 * rigid, .direction = 0});
  ASSERT_EQ(found.status, RemedyStatus::found);
  EXPECT_NEAR(found.needed.omega, 0.95 * rigid, 1e-5 * rigid);
  // from where x itself is the first of its resonances
  for (std::size_t k = 1; k < found.curve.size(); ++k)
    if (found.curve[k - 1].factor > 1.0) {
      EXPECT_GE(found.curve[k].omega, found.curve[k - 1].omega * (1.0 - 1e-9));
    }
  const auto beyond =
      find_remedy(machine, neutral, ModelKind::guide, {.omega = 1.1 * rigid, .direction = 0});
  EXPECT_EQ(beyond.status, RemedyStatus::out_of_reach);
  EXPECT_NEAR(beyond.limit.omega, rigid, 1e-3 * rigid);
  const auto met =
      find_remedy(machine, neutral, ModelKind::guide, {.omega = 0.5 * rigid, .direction = 0});
  EXPECT_EQ(met.status, RemedyStatus::met_already);
  EXPECT_LT(met.needed.factor, 1.0);
  EXPECT_THROW(find_remedy(machine, neutral, ModelKind::guide, {}), std::invalid_argument);
}

/// Without gravity sleeves of 500 kN/m lower the frequencies by 0.6 %: there is nothing to mend.
/// Sleeves a quarter stiffer would put their own modes beside z, which they lower by 2 %.
TEST(Remedy, IsNotNeededWhereTheNominalSleevesMeetTheGoal) {
  const auto machine = heavy({"environment.gravity=0", "legs.guide_sleeve.stiffness=500 kN/m"});
  const std::vector<model::NamedPose> neutral{machine.poses.front()};
  const auto found = find_remedy(machine, neutral, ModelKind::guide, {.drop = 0.01});
  EXPECT_EQ(found.status, RemedyStatus::met_already);
  EXPECT_LT(found.needed.factor, 1.0);
  EXPECT_LT(found.needed.drop, 0.01);
  const CaseFile file{.drops = attribute_drops(machine, machine.neutral(), ModelKind::guide),
                      .goal = {.drop = 0.01},
                      .remedy = found};
  const auto words = report::summary(file);
  test::expect_round_trip(report::diagnosis_json(file), report::diagnosis_from_json,
                          report::diagnosis_json);
  const bool worse = std::ranges::any_of(
      found.curve, [](const auto& point) { return point.factor > 1.0 && point.drop > 0.01; });
  ASSERT_TRUE(worse);
  EXPECT_THAT(words.back(), testing::HasSubstr(" Stiffer guide sleeves, from about "));
}

TEST(Workspace, PosesAreSoundAndReachTheirLimits) {
  const auto machine = heavy();
  const auto poses = workspace_poses(machine);
  EXPECT_GT(poses.size(), 80U);
  for (const auto& pose : poses)
    for (const auto& finding : kinematics::check_pose(machine, pose.X_BP, pose.name))
      EXPECT_NE(finding.severity, base::Severity::error) << pose.name << finding.message;
}

}  // namespace
}  // namespace hydrapod::diagnosis
