/// Motions judged before they run: which leg, when, by how much.

#include "hydrapod/simulation/capability.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<MotionFinding> findings(const model::Machine& machine,
                                    const std::vector<signals::Signal>& commands,
                                    double until = 2.0) {
  const Plant plant(machine, ModelKind::rigid);
  const auto parameters = tune_controller(machine, machine.neutral()).parameters;
  signals::Generator generator(commands, 1e3);
  return check_motion(plant, parameters, machine.neutral(), generator, until);
}

signals::Signal ramp_to(const Vector6& end, double from, double to) {
  return {.form = signals::Trajectory{.times = {from, to}, .points = {Vector6::Zero(), end}}};
}

TEST(MotionCheck, FindsNothingInASmallMotion) {
  const auto machine = machine_of("heavy-platform");
  EXPECT_TRUE(
      findings(machine, {{.size = Vector6::Constant(5e-3), .form = signals::Sine{1.0}}}).empty());
}

TEST(MotionCheck, NamesLegTimeAndAmountOfStroke) {
  const auto machine = machine_of("heavy-platform");
  Vector6 far = Vector6::Zero();
  far[0] = 0.3;
  far[2] = 0.06;
  const auto found = findings(machine, {ramp_to(far, 0.2, 1.3)});
  const Vector6 lengths =
      kinematics::leg_lengths(machine, command_at(machine.neutral(), {.value = far}).X_BP);
  size_t at = 0;
  for (int i = 0; i < 6; ++i) {
    const auto& leg = machine.legs[static_cast<size_t>(i)];
    const double lacking =
        lengths[i] - leg.rod.length - (leg.stroke->retracted + leg.stroke->length);
    if (lacking <= 0.0) continue;
    ASSERT_LT(at, found.size());
    EXPECT_EQ(found[at].severity, base::Severity::error);
    EXPECT_THAT(found[at].message,
                AllOf(HasSubstr(fmt::format("leg {} needs {:.3g} mm more stroke than it has "
                                            "extending at 1.3 s",
                                            i + 1, 1e3 * lacking)),
                      HasSubstr("stroke 0.36 m to 1.22 m")));
    ++at;
  }
  EXPECT_GT(at, 0U);
  EXPECT_LT(at, 6U);  // some legs have enough
}

TEST(MotionCheck, NamesJointsBeyondTheirLimits) {
  auto machine = machine_of("heavy-platform");
  for (auto& leg : machine.legs) leg.joint_limits.platform = 0.2;
  Vector6 tilt = Vector6::Zero();
  tilt[4] = 0.25;
  const auto found = findings(machine, {ramp_to(tilt, 0.0, 1.0)});
  const auto angles =
      kinematics::joint_angles(machine, command_at(machine.neutral(), {.value = tilt}).X_BP);
  int joints = 0;
  for (const auto& finding : found) joints += finding.message.starts_with("the platform joint");
  int expected = 0;
  for (const auto& leg : angles) expected += leg.platform_tilt > 0.2;
  EXPECT_EQ(joints, expected);
  EXPECT_GT(joints, 0);
}

TEST(MotionCheck, WarnsOfSpeedsThatTheValveDoesNotGive) {
  const auto machine = machine_of("heavy-platform");
  const Vector6 heave = 0.05 * Vector6::Unit(2);  // 1.26 m/s
  const auto found = findings(machine, {{.size = heave, .form = signals::Sine{4.0}}});
  ASSERT_EQ(found.size(), 12U);  // each leg, both ways
  for (const auto& finding : found) EXPECT_EQ(finding.severity, base::Severity::warning);
  EXPECT_THAT(found[0].message,
              AllOf(HasSubstr("leg 1 must extend at "), HasSubstr("its valve gives 0.482 m/s")));
}

/// Base and platform circles alike and no difference in their pairs' angles: a platform turned by
/// 90° is the singular pose of every hexapod with similar triangles.
TEST(MotionCheck, SeesASingularPose) {
  auto machine = machine_of("zhang-jiang-2021");
  Vector6 lift = Vector6::Zero();
  // Found by search along rz: where the condition passes its largest value.
  double worst = 0.0;
  for (double rz = 0.0; rz < 2.0; rz += 1e-4) {
    Vector6 turn = Vector6::Zero();
    turn[5] = rz;
    const double condition =
        kinematics::pose_quality(machine, command_at(machine.neutral(), {.value = turn}).X_BP)
            .condition;
    if (condition > worst) {
      worst = condition;
      lift = turn;
    }
  }
  ASSERT_GT(worst, 1e3);
  EXPECT_EQ(leaves_workspace(machine, machine.neutral()), "");
  // At the singular turn itself, to rounding:
  double low = lift[5] - 1e-4, high = lift[5] + 1e-4;
  const auto smallest = [&](double rz) {
    Vector6 turn = Vector6::Zero();
    turn[5] = rz;
    return kinematics::leg_jacobian(
               kinematics::inverse_kinematics(machine,
                                              command_at(machine.neutral(), {.value = turn}).X_BP),
               machine.neutral().p_BP)
        .determinant();
  };
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (smallest(middle) * smallest(low) > 0.0 ? low : high) = middle;
  }
  lift[5] = low;
  const Pose singular = command_at(machine.neutral(), {.value = lift}).X_BP;
  EXPECT_THAT(leaves_workspace(machine, singular), HasSubstr("singular pose"));
  // On both sides of the limit: the condition is proportional to the inverse of the distance.
  const double there = lift[5];
  for (const double off : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
    lift[5] = there + off;
    const Pose near = command_at(machine.neutral(), {.value = lift}).X_BP;
    const bool is_singular =
        kinematics::pose_quality(machine, near).condition >= kinematics::singular_condition;
    EXPECT_EQ(!leaves_workspace(machine, near).empty(), is_singular) << off;
  }
  // to it, and through it from one sample to the next
  for (const double to : {there, there + 0.37}) {
    lift[5] = to;
    bool said = false;
    for (const auto& finding : findings(machine, {ramp_to(lift, 0.0, 1.0)}))
      said |= finding.message.starts_with("the commanded motion passes a singular pose at ");
    EXPECT_TRUE(said) << to;
  }
  lift[5] = there - 0.37;
  for (const auto& finding : findings(machine, {ramp_to(lift, 0.0, 1.0)}))
    EXPECT_FALSE(finding.message.starts_with("the commanded motion passes")) << finding.message;
  // so do excursions, which look at some poses on their way
  for (auto& leg : machine.legs) {
    leg.stroke = {.retracted = 0.01, .length = 20.0};
    leg.joint_limits = {};
  }
  const auto able = capability(machine, machine.neutral(), dynamics::ModelKind::rigid);
  ASSERT_TRUE(able);
  const auto& reach = able->of(Ability::excursion, 5, 0);
  EXPECT_EQ(reach.limit, Limit::singular);
  EXPECT_NEAR(reach.value, there, 5e-6);  // where the condition is 1e6
}

TEST(MotionCheck, LeavesTheSignalAtItsStart) {
  const auto machine = machine_of("heavy-platform");
  const Plant plant(machine, ModelKind::rigid);
  const auto parameters = tune_controller(machine, machine.neutral()).parameters;
  const signals::Signal noise{.size = Vector6::Constant(1e-4), .form = signals::Noise{}};
  signals::Generator used({noise}, 1e3), fresh({noise}, 1e3);
  check_motion(plant, parameters, machine.neutral(), used, 0.7);
  for (int k = 0; k < 50; ++k) ASSERT_EQ(used.next().value, fresh.next().value);
}

/// Of half a second of a motion that ends 0.8 s later beyond the stroke.
TEST(MotionCheck, EndsWhereItIsToldTo) {
  const auto machine = machine_of("heavy-platform");
  const Plant plant(machine, ModelKind::rigid);
  const auto parameters = tune_controller(machine, machine.neutral()).parameters;
  Vector6 far = Vector6::Zero();
  far[2] = 0.7;
  signals::Generator signal({ramp_to(far, 0.2, 1.3)}, 1e3);
  const auto seen = [&](double last) {
    return check_motion(plant, parameters, machine.neutral(), signal, 2.0,
                        [&](double time) { return time < last; });
  };
  const auto is_error = [](const auto& finding) {
    return finding.severity == base::Severity::error;
  };
  EXPECT_TRUE(std::ranges::none_of(seen(0.4), is_error));
  EXPECT_TRUE(std::ranges::any_of(seen(3.0), is_error));
}

}  // namespace
}  // namespace hydrapod::simulation
