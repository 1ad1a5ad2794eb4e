/// What is said of poses that a machine cannot take.

#include "hydrapod/kinematics/legs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using kinematics::check_machine;
using spatial::Vector3;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> messages(const model::Machine& machine) {
  std::vector<std::string> texts;
  for (const auto& finding : check_machine(machine)) {
    EXPECT_EQ(finding.severity, base::Severity::error);
    texts.push_back(finding.key + ": " + finding.message);
  }
  return texts;
}

/// The published machine with a second pose "high" that stays neutral until a test moves it.
model::Machine machine_with_second_pose() {
  auto machine = published_machine();
  machine.poses.push_back({"high", machine.neutral()});
  return machine;
}

TEST(CheckMachine, FindsNothingWrongWithSoundMachines) {
  EXPECT_THAT(messages(published_machine()), IsEmpty());
  Random random(1);
  for (int i = 0; i < 20; ++i) EXPECT_THAT(messages(random_machine(random)), IsEmpty());
}

TEST(CheckMachine, NamesALegShorterThanItsRod) {
  auto machine = machine_with_second_pose();
  for (auto& leg : machine.legs) leg.guide_sleeve.position = 0.75;
  machine.legs[3].rod.length = 0.88;
  machine.legs[3].guide_sleeve.position = 0.75;
  machine.poses.resize(1);
  EXPECT_THAT(
      messages(machine),
      ElementsAre("poses.neutral: leg 4 is 0.8734 m long, shorter than its rod of 0.88 m; move the "
                  "platform away from the base or shorten the rod"));
}

TEST(CheckMachine, NamesAPistonOutsideItsStroke) {
  auto machine = published_machine();
  machine.legs[1].stroke = model::Stroke{.retracted = 0.49, .length = 0.05};
  machine.legs[4].stroke = model::Stroke{.retracted = 0.40, .length = 0.08};
  EXPECT_THAT(
      messages(machine),
      ElementsAre("poses.neutral: the piston of leg 5 is 0.488 m from its base joint, 0.008 m "
                  "beyond its stroke from 0.4 m to 0.48 m; also leg 2"));
  machine.legs[2].stroke = model::Stroke{.retracted = 0.49, .length = 0.05};
  EXPECT_THAT(messages(machine), ElementsAre(testing::EndsWith(" m; also legs 2 and 3")));
}

/// Base and platform numbered from another leg on, or the one clockwise: some legs are far too
/// long.
TEST(CheckMachine, NamesTheOrderOfJointsInWhichAllLegsReach) {
  const auto sound = published_machine();
  const auto numbered = [&](std::array<std::size_t, 6> order) {
    auto machine = sound;
    for (std::size_t i = 0; i < 6; ++i) {
      machine.legs[i].platform_joint = sound.legs[order[i]].platform_joint;
      machine.legs[i].stroke = model::Stroke{.retracted = 0.3, .length = 0.24};
    }
    return messages(machine);
  };
  EXPECT_THAT(numbered({0, 1, 2, 3, 4, 5}), IsEmpty());
  EXPECT_THAT(numbered({2, 3, 4, 5, 0, 1}),
              ElementsAre(testing::HasSubstr("; all legs reach where the platform joints are taken "
                                             "in the order 5, 6, 1, 2, 3, 4: are base and")));
  EXPECT_THAT(numbered({5, 4, 3, 2, 1, 0}),
              ElementsAre(testing::HasSubstr("in the order 6, 5, 4, 3, 2, 1: are base and")));
}

/// A leg that is too short has its sleeve and its joints in the wrong place for that reason.
TEST(CheckMachine, OneCauseAtAPoseIsOneMessage) {
  auto machine = machine_with_second_pose();
  for (auto& leg : machine.legs) {
    leg.stroke = model::Stroke{.retracted = 0.31, .length = 0.22};
    leg.joint_limits = {.base = 0.02, .platform = 0.02};
  }
  machine.poses[1].X_BP.p_BP += Vector3(0.03, 0.0, 0.17);
  EXPECT_THAT(messages(machine),
              ElementsAre(testing::AllOf(testing::HasSubstr("beyond its stroke"),
                                         testing::EndsWith("; also all other legs"))));
  for (auto& leg : machine.legs) leg.rod.length = 0.42;
  machine.poses[1].X_BP.p_BP -= Vector3(0.0, 0.0, 1.0);
  EXPECT_THAT(messages(machine), ElementsAre(testing::HasSubstr("shorter than its rod")));
}

TEST(CheckMachine, NamesAGuideSleeveOffTheRod) {
  auto machine = machine_with_second_pose();
  machine.poses[1].X_BP.p_BP.z() = 0.9;
  ASSERT_EQ(messages(machine).size(), 1U);
  EXPECT_EQ(
      messages(machine)[0],
      "poses.high: the guide sleeve of leg 1 stands 0.5487 m from its base joint; it must lie on "
      "the rod, between the piston at 0.5943 m and the platform joint at 0.9797 m; also all other "
      "legs");
}

TEST(CheckMachine, NamesAJointBeyondItsLimit) {
  auto machine = machine_with_second_pose();
  machine.poses[1].X_BP.R_BP = spatial::rotation_from_vector({0.0, 0.0, 0.05});
  constexpr double degree = std::numbers::pi / 180.0;
  machine.legs[0].joint_limits.base = 1.0 * degree;
  machine.legs[5].joint_limits.platform = 0.5 * degree;
  EXPECT_THAT(
      messages(machine),
      ElementsAre("poses.high: the base joint of leg 1 is tilted 1.19° from the neutral pose, "
                  "limit 1°",
                  "poses.high: the platform joint of leg 6 is tilted 1.87° from the neutral "
                  "pose, limit 0.5°"));
}

/// Under gravity it was an equilibrium that could not be found.
TEST(CheckMachine, NamesALegInGimbalLock) {
  auto machine = published_machine();
  const auto legs = kinematics::inverse_kinematics(machine, machine.neutral());
  for (const std::size_t i : {2, 4}) machine.legs[i].gimbal_axis = -legs[i].n;
  machine.flexible_axes = model::FlexibleAxes::transverse;  // do not depend on it
  EXPECT_THAT(messages(machine), IsEmpty());
  machine.flexible_axes = model::FlexibleAxes::gimbal;
  EXPECT_THAT(messages(machine),
              ElementsAre("poses.neutral: leg 3 points along the first axis of its lower gimbal "
                          "(gimbal lock); also leg 5; choose another legs.gimbal_axis, or "
                          "model.flexible_axes = \"transverse\""));
}

TEST(CheckMachine, NamesASingularPose) {
  auto machine = machine_with_second_pose();
  machine.poses[1].X_BP.R_BP = spatial::rotation_from_vector({0.0, 0.0, std::numbers::pi / 2.0});
  for (auto& leg : machine.legs) {  // long enough for the quarter turn
    leg.rod.length = 0.5;
    leg.guide_sleeve.position = 0.8;
  }
  const auto texts = messages(machine);
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_THAT(
      texts[0],
      testing::MatchesRegex(
          "poses.high: singular pose: the legs cannot resist the platform motion \\(x, y, z, "
          "rx, ry, rz\\) = \\(0.00, 0.00, -0.51, 0.00, 0.00, 2.15\\) \\[m, rad\\]; condition "
          "of the Jacobian [0-9.]+e\\+[0-9]+, accepted below 1e\\+06"));
}

TEST(CheckMachine, DoesNotGoOnToPosesWhenTheNumbersThemselvesAreWrong) {
  auto machine = published_machine();
  machine.legs[0].stroke = model::Stroke{.retracted = 0.49, .length = 0.05};
  machine.platform.mass = -1.0;
  const auto findings = check_machine(machine);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].key, "platform.mass");
}

}  // namespace
}  // namespace hydrapod::test
