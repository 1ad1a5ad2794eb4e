/// Forward kinematics undoes inverse kinematics.

#include "hydrapod/kinematics/legs.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using kinematics::forward_kinematics;
using kinematics::ForwardStatus;
using kinematics::leg_lengths;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

/// Distance between poses, metres and radians mixed.
double distance(const Pose& A, const Pose& B) {
  return (A.p_BP - B.p_BP).norm() + (A.R_BP - B.R_BP).norm();
}

TEST(ForwardKinematics, UndoesInverseKinematics) {
  Random random(1965);
  double worst_residual = 0.0, worst_distance = 0.0;
  int most_iterations = 0;
  for (int i = 0; i < 250; ++i) {
    const auto machine = random_machine(random);
    const double height = machine.neutral().p_BP.z();
    for (int k = 0; k < 4; ++k) {
      const Pose there =
          spatial::displaced(machine.poses[k % 2].X_BP, random.displacement(0.1 * height, 0.15));
      const Pose start = spatial::displaced(there, random.displacement(0.05 * height, 0.1));
      const auto found = forward_kinematics(machine, leg_lengths(machine, there), start);
      ASSERT_EQ(found.status, ForwardStatus::converged);
      EXPECT_LE(found.residual, 1e-12);
      const Vector6 error = leg_lengths(machine, found.X_BP) - leg_lengths(machine, there);
      EXPECT_LE(error.lpNorm<Eigen::Infinity>(), 1e-12);
      worst_residual = std::max(worst_residual, found.residual);
      worst_distance = std::max(worst_distance, distance(found.X_BP, there));
      most_iterations = std::max(most_iterations, found.iterations);
    }
  }
  EXPECT_LE(worst_distance, 1e-10);  // residual times condition, below 100 here
  EXPECT_LE(most_iterations, 7);
  RecordProperty("worst", fmt::format("residual {:.1e} m, pose {:.1e}, {} iterations",
                                      worst_residual, worst_distance, most_iterations));
}

TEST(ForwardKinematics, KeepsARotationMatrix) {
  Random random(4);
  const auto machine = random_machine(random);
  const auto found =
      forward_kinematics(machine, leg_lengths(machine, machine.poses[1].X_BP), machine.neutral());
  ASSERT_EQ(found.status, ForwardStatus::converged);
  const auto& R = found.X_BP.R_BP;
  EXPECT_LE((R.transpose() * R - spatial::Matrix3::Identity()).norm(), 1e-14);
}

TEST(ForwardKinematics, ConvergesQuadratically) {
  Random random(1669);
  for (int i = 0; i < 20; ++i) {
    const auto machine = random_machine(random);
    const Pose& there = machine.poses[1].X_BP;
    const Vector6 lengths = leg_lengths(machine, there);
    const Vector6 direction = random.displacement(1.0, 1.0);
    const auto residual_after_one_step = [&](double h) {
      return forward_kinematics(machine, lengths, spatial::displaced(there, h * direction),
                                {.max_iterations = 1})
          .residual;
    };
    const double order = std::log10(residual_after_one_step(1e-3) / residual_after_one_step(1e-4));
    EXPECT_NEAR(order, 2.0, 0.05) << "machine " << i;
  }
}

TEST(ForwardKinematics, AtTheAnswerTakesNoStep) {
  const auto machine = published_machine();
  const auto found =
      forward_kinematics(machine, leg_lengths(machine, machine.neutral()), machine.neutral());
  EXPECT_EQ(found.status, ForwardStatus::converged);
  EXPECT_EQ(found.iterations, 0);
}

TEST(ForwardKinematics, SaysWhenNoPoseHasTheseLengths) {
  const auto machine = published_machine();
  Vector6 lengths = leg_lengths(machine, machine.neutral());
  lengths[0] += 5.0;
  const auto unreachable = forward_kinematics(machine, lengths, machine.neutral());
  EXPECT_NE(unreachable.status, ForwardStatus::converged);
  EXPECT_GT(unreachable.residual, 1.0);
  lengths[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(forward_kinematics(machine, lengths, machine.neutral()).status,
            ForwardStatus::not_converged);
}

TEST(ForwardKinematics, SaysWhenItStartsAtASingularPose) {
  const auto machine = published_machine();
  const Pose quarter_turn{spatial::rotation_from_vector({0.0, 0.0, M_PI / 2.0}),
                          machine.neutral().p_BP};
  const auto found =
      forward_kinematics(machine, leg_lengths(machine, machine.neutral()), quarter_turn);
  EXPECT_EQ(found.status, ForwardStatus::singular);
  EXPECT_LE(distance(found.X_BP, quarter_turn), 0.0);
}

TEST(ForwardKinematics, TakesStepsNoLongerThanItsLimits) {
  const auto machine = published_machine();
  const Pose far = spatial::displaced(machine.neutral(),
                                      (Vector6() << 0.3, -0.2, 0.25, 0.2, 0.1, 0.3).finished());
  const kinematics::ForwardOptions options{
      .max_iterations = 1, .max_translation = 0.01, .max_rotation = 0.02};
  const auto found =
      forward_kinematics(machine, leg_lengths(machine, far), machine.neutral(), options);
  EXPECT_LE((found.X_BP.p_BP - machine.neutral().p_BP).norm(), 0.01 * (1.0 + 1e-14));
  const double cosine = 0.5 * (found.X_BP.R_BP.trace() - 1.0);
  EXPECT_LE(std::acos(std::min(1.0, cosine)), 0.02 * (1.0 + 1e-6));
  EXPECT_EQ(found.status, ForwardStatus::not_converged);
}

/// A turn far away and hardly a shift: one step turns by the limit, whatever it shifts.
TEST(ForwardKinematics, TurnsByItsLimitWhereTheShiftIsSmall) {
  const auto machine = published_machine();
  const Pose far = spatial::displaced(
      machine.neutral(), (Vector6() << 1e-4, -2e-4, 3e-4, 0.11, -0.13, 0.21).finished());
  const kinematics::ForwardOptions options{
      .max_iterations = 1, .max_translation = 10.0, .max_rotation = 0.037};
  const auto found =
      forward_kinematics(machine, leg_lengths(machine, far), machine.neutral(), options);
  const double cosine = 0.5 * (found.X_BP.R_BP.trace() - 1.0);
  EXPECT_NEAR(std::acos(cosine), 0.037, 1e-12);
  EXPECT_EQ(found.status, ForwardStatus::not_converged);
}

}  // namespace
}  // namespace hydrapod::test
