/// Leg Jacobian, singular poses and joint angles.

#include "hydrapod/kinematics/legs.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using kinematics::joint_angles;
using kinematics::leg_lengths;
using kinematics::pose_quality;
using spatial::Matrix3;
using spatial::Matrix6;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

constexpr double right_angle = std::numbers::pi / 2.0;

Pose turned_about_z(const Pose& pose, double angle) {
  return {spatial::rotation_from_vector({0.0, 0.0, angle}) * pose.R_BP, pose.p_BP};
}

/// The pose after the twist `V` about the point Q has acted for the time one, Q moving with it.
Pose moved_about(const Pose& pose, const Vector3& p_BQ, const Vector6& V) {
  const Matrix3 R = spatial::rotation_from_vector(V.tail<3>());
  return {R * pose.R_BP, p_BQ + V.head<3>() + R * (pose.p_BP - p_BQ)};
}

TEST(InverseKinematics, PutsLegsBetweenTheirJoints) {
  Random random(8);
  const auto machine = random_machine(random);
  const Pose& X_BP = machine.poses[1].X_BP;
  const auto legs = kinematics::inverse_kinematics(machine, X_BP);
  for (int i = 0; i < model::leg_count; ++i) {
    EXPECT_NEAR(legs[i].n.norm(), 1.0, 1e-15);
    const Vector3 joint = machine.legs[i].base_joint + legs[i].length * legs[i].n;
    EXPECT_LE((joint - X_BP * machine.legs[i].platform_joint).norm(), 1e-15);
    EXPECT_EQ(leg_lengths(machine, X_BP)[i], legs[i].length);
  }
}

TEST(LegJacobian, IsTheDerivativeOfTheLegLengths) {
  Random random(1755);
  double worst = 0.0;
  for (int i = 0; i < 100; ++i) {
    const auto machine = random_machine(random);
    const Pose& X_BP = machine.poses[1].X_BP;
    const Vector3 p_BQ = random.vector(1.0);
    const Matrix6 J = kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), p_BQ);
    for (int k = 0; k < 6; ++k) {
      const auto lengths = [&](double h) {
        return leg_lengths(machine, moved_about(X_BP, p_BQ, h * Vector6::Unit(k)));
      };
      constexpr double h = 3e-4;  // fourth order: error about h⁴, rounding ε / h
      const Vector6 slope =
          (8.0 * (lengths(h) - lengths(-h)) - (lengths(2.0 * h) - lengths(-2.0 * h))) / (12.0 * h);
      worst = std::max(worst, (J.col(k) - slope).lpNorm<Eigen::Infinity>());
    }
  }
  EXPECT_LE(worst, 5e-12);
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

TEST(PoseQuality, DoesNotDependOnSizeOrFrame) {
  Random random(9);
  const auto machine = random_machine(random);
  const auto quality = pose_quality(machine, machine.poses[1].X_BP);
  EXPECT_GT(quality.condition, 1.0);
  EXPECT_LT(quality.condition, 30.0);

  auto bigger = machine;
  Pose X_BP = machine.poses[1].X_BP;
  X_BP.p_BP *= 7.0;
  for (auto& leg : bigger.legs) {
    leg.base_joint *= 7.0;
    leg.platform_joint *= 7.0;
  }
  EXPECT_NEAR(pose_quality(bigger, X_BP).condition / quality.condition, 1.0, 1e-13);
  EXPECT_NEAR(pose_quality(bigger, X_BP).characteristic_length / quality.characteristic_length, 7.0,
              1e-13);

  auto other_frame = machine;
  const Vector3 shift(0.2, -0.1, 0.4);
  for (auto& leg : other_frame.legs) leg.platform_joint -= shift;
  const Pose same_place{machine.poses[1].X_BP.R_BP, machine.poses[1].X_BP * shift};
  EXPECT_NEAR(pose_quality(other_frame, same_place).condition / quality.condition, 1.0, 1e-13);
}

TEST(PoseQuality, WeakestDirectionIsWhatTheLegsFeelLeast) {
  Random random(10);
  const auto machine = random_machine(random);
  const Pose& X_BP = machine.poses[1].X_BP;
  const auto quality = pose_quality(machine, X_BP);
  Vector3 center = Vector3::Zero();
  for (const auto& leg : machine.legs) center += X_BP * leg.platform_joint / 6.0;
  const Vector6 rates =
      kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), center) *
      quality.weakest_direction;
  EXPECT_NEAR(rates.norm(), quality.singular_values[5], 1e-14);
  const auto& d = quality.weakest_direction;
  const double r = quality.characteristic_length;
  EXPECT_NEAR(d.head<3>().squaredNorm() + r * r * d.tail<3>().squaredNorm(), 1.0, 1e-14);
}

/// Fichter 1986: with three pairs of joints in mirror symmetry, z and rz move the legs in the same
/// way when the platform is turned by a right angle.
TEST(PoseQuality, QuarterTurnIsSingular) {
  const auto machine = published_machine();
  for (double angle : {right_angle, -right_angle}) {
    const auto quality = pose_quality(machine, turned_about_z(machine.neutral(), angle));
    EXPECT_GT(quality.condition, kinematics::singular_condition);
    const auto& d = quality.weakest_direction;
    EXPECT_GT(std::abs(d[2]), 0.1);
    EXPECT_GT(std::abs(d[5]), 0.1);
    const Vector6 others = (Vector6() << d[0], d[1], 0.0, d[3], d[4], 0.0).finished();
    EXPECT_LE(others.norm(), 1e-12);
  }
  EXPECT_LT(pose_quality(machine, machine.neutral()).condition, 10.0);
  // Near it the condition grows as one over the distance.
  const auto condition = [&](double away) {
    return pose_quality(machine, turned_about_z(machine.neutral(), right_angle - away)).condition;
  };
  EXPECT_NEAR(condition(1e-4) / condition(1e-3), 10.0, 0.01);
}

/// At random poses and on the way to a singular one.
TEST(PoseQuality, ConditionAloneIsThatOfTheSingularValues) {
  double worst = 0.0;
  const auto compare = [&](const model::Machine& machine, const Pose& X_BP) {
    const double condition = pose_quality(machine, X_BP).condition;
    worst = std::max(worst, std::abs(kinematics::pose_condition(machine, X_BP) / condition - 1.0));
    EXPECT_EQ(kinematics::is_singular(machine, X_BP), condition >= kinematics::singular_condition);
  };
  Random random(1917);
  for (int k = 0; k < 300; ++k) {
    const auto machine = random_machine(random);
    for (const auto& pose : machine.poses) compare(machine, pose.X_BP);
  }
  const auto machine = published_machine();
  for (double away = 1.3; away > 1e-8; away *= 0.83)
    compare(machine, turned_about_z(machine.neutral(), right_angle - away));
  EXPECT_LE(worst, 1e-11);
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

TEST(PoseQuality, OfALegWithoutLengthIsSingular) {
  auto machine = published_machine();
  machine.legs[0].base_joint = machine.neutral() * machine.legs[0].platform_joint;
  const auto quality = pose_quality(machine, machine.neutral());
  EXPECT_TRUE(std::isinf(quality.condition));
  EXPECT_TRUE(quality.weakest_direction.allFinite());
  EXPECT_TRUE(std::isinf(kinematics::pose_condition(machine, machine.neutral())));
  EXPECT_TRUE(kinematics::is_singular(machine, machine.neutral()));
}

TEST(JointAngles, AreZeroAtTheNeutralPose) {
  Random random(11);
  const auto machine = random_machine(random, {.axes = model::FlexibleAxes::gimbal});
  // n × n is not zero to the last bit where products are fused into sums
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  for (const auto& angles : joint_angles(machine, machine.neutral())) {
    EXPECT_EQ(angles.gimbal_1, 0.0);
    EXPECT_EQ(angles.gimbal_2, 0.0);
    EXPECT_NEAR(angles.base_tilt, 0.0, rounding);
    EXPECT_NEAR(angles.platform_tilt, 0.0, rounding);
  }
}

TEST(JointAngles, TurnTheNeutralLegIntoTheLeg) {
  Random random(12);
  for (int i = 0; i < 20; ++i) {
    const auto machine = random_machine(random, {.axes = model::FlexibleAxes::gimbal});
    const Pose& X_BP = machine.poses[1].X_BP;
    const auto before = kinematics::inverse_kinematics(machine, machine.neutral());
    const auto after = kinematics::inverse_kinematics(machine, X_BP);
    const auto angles = joint_angles(machine, X_BP);
    for (int leg = 0; leg < model::leg_count; ++leg) {
      const Vector3& a1 = machine.legs[leg].gimbal_axis;
      const Vector3 a2 = before[leg].n.cross(a1).normalized();
      const Vector3 n = Eigen::AngleAxisd(angles[leg].gimbal_1, a1) *
                        (Eigen::AngleAxisd(angles[leg].gimbal_2, a2) * before[leg].n);
      EXPECT_LE((n - after[leg].n).norm(), 1e-14);
      EXPECT_NEAR(std::cos(angles[leg].base_tilt), before[leg].n.dot(after[leg].n), 1e-15);
      EXPECT_NEAR(std::cos(angles[leg].platform_tilt),
                  before[leg].n.dot(X_BP.R_BP.transpose() * after[leg].n), 1e-15);
    }
  }
}

/// A platform that carries base and all with it turns no base joint; one that only turns does.
TEST(JointAngles, OfTheUpperJointsCountThePlatformsRotation) {
  auto machine = published_machine();
  const double lift = 0.2;
  Pose raised = machine.neutral();
  raised.p_BP.z() += lift;
  for (const auto& angles : joint_angles(machine, raised))
    EXPECT_DOUBLE_EQ(angles.base_tilt, angles.platform_tilt);
}

}  // namespace
}  // namespace hydrapod::test
