/// One leg: straight against bent, bent against its potential energy, the knee under compression.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "exact/leg_potential.hpp"
#include "hydrapod/dynamics/leg.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::bent_leg;
using dynamics::LegState;
using dynamics::Matrix7;
using dynamics::Vector7;
using model::FlexibleAxes;
using spatial::Vector3;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Brings tilts to metres, so that entries of a leg matrix can be compared with each other.
Matrix7 in_metres(const Matrix7& A, double l) {
  Vector7 scale = Vector7::Ones();
  scale.segment<2>(3).setConstant(1.0 / l);
  return scale.asDiagonal() * A * scale.asDiagonal();
}

/// Largest difference relative to the largest entry.
double difference(const Matrix7& A, const Matrix7& B, double l) {
  const double largest = in_metres(B, l).lpNorm<Eigen::Infinity>();
  return in_metres(A - B, l).lpNorm<Eigen::Infinity>() / largest;
}

class Leg : public testing::TestWithParam<FlexibleAxes> {
 protected:
  /// Calls `check(leg, a)` for legs of random machines at random poses.
  template <class Check>
  void for_random_legs(int machines, const Check& check) {
    for (int i = 0; i < machines; ++i) {
      const auto machine = random_machine(random_, {.axes = GetParam()});
      const auto& pose = machine.poses[i % 2].X_BP;
      for (const auto& leg : machine.legs) check(leg, Vector3(pose * leg.platform_joint));
    }
  }

  LegState random_state() {
    LegState state;
    for (int k = 0; k < 2; ++k) {
      state.flexible[k] = random_.uniform(-0.15, 0.15);
      state.flexible[2 + k] = random_.uniform(-0.01, 0.01);
    }
    state.oil_force = random_.uniform(-2e4, 1e4);
    return state;
  }

  Random random_{2718281828};
};

kinematics::LegGeometry geometry_of(const model::Leg& leg, const Vector3& a) {
  const Vector3 L = a - leg.base_joint;
  return {a, L.normalized(), L.norm()};
}

TEST_P(Leg, BentByNothingIsTheStraightLeg) {
  // A leg matrix takes some ten products in a row, of rotations known to ε.
  constexpr double tolerance = 40.0 * epsilon;
  double worst = 0.0;
  for_random_legs(200, [&](const model::Leg& leg, const Vector3& a) {
    const auto straight = dynamics::straight_leg(leg, geometry_of(leg, a), GetParam());
    const auto bent = bent_leg(leg, a, GetParam(), Vector3::Zero(), {});
    ASSERT_TRUE(bent.exists);
    const auto& element = bent.element;
    const double l = straight.l;
    EXPECT_NEAR(element.l_m, straight.l_m, 4.0 * epsilon * l);
    EXPECT_NEAR(element.l_mh, straight.l_mh, 8.0 * epsilon * l);
    EXPECT_NEAR(element.k_h, straight.k_h, 1e2 * epsilon * straight.k_h);  // 1/volume near the end
    EXPECT_LE((element.frame.R_BL - straight.frame.R_BL).norm(), tolerance);
    worst = std::max({worst, difference(element.M, straight.M, l),
                      difference(element.K, straight.K, l), difference(element.C, straight.C, l),
                      (element.s_x - straight.s_x).norm(), (element.d_x - straight.d_x).norm() / l,
                      bent.joint_force.norm(), bent.flexible_gradient.norm()});
  });
  EXPECT_LE(worst, tolerance);
  RecordProperty("worst_in_epsilon", fmt::format("{:.0f}", worst / epsilon));
}

TEST_P(Leg, BentIsTheDerivativeOfItsPotentialEnergy) {
  // Rounding; differences of eighth order in extended precision add less than 1e-15.
  constexpr double tolerance = 100.0 * epsilon;
  double worst = 0.0;
  const auto include = [&](double error) { worst = std::max(worst, error); };
  for_random_legs(5, [&](const model::Leg& leg, const Vector3& a) {
    const LegState state = random_state();
    const Vector3 gravity = 9.81 * random_.direction();
    const auto bent = bent_leg(leg, a, GetParam(), gravity, state);
    ASSERT_TRUE(bent.exists);
    LegPotential::Coordinates x;
    x << a.cast<long double>(), state.flexible.cast<long double>();
    const Vector3 a1 =
        dynamics::frame_axis((a - leg.base_joint).normalized(), leg.gimbal_axis, GetParam());
    const LegPotential potential(leg, a1, gravity, state.oil_force, x);
    const double l = bent.element.l;

    Vector7 gradient;
    gradient << bent.joint_force, bent.flexible_gradient;
    const Vector7 expected = potential.gradient(x);
    include((gradient - expected).norm() / expected.norm());

    Matrix7 to_base = Matrix7::Identity();
    to_base.topLeftCorner<3, 3>() = bent.element.frame.R_BL;
    const Matrix7 hessian = to_base.transpose() * potential.hessian(x) * to_base;
    include(difference(bent.K_without_oil, hessian, l));
    EXPECT_NEAR(bent.element.l_m, static_cast<double>(potential.extension(x)), 8.0 * epsilon * l);

    Vector7 s_x;
    Eigen::Matrix<double, 2, 7> d_x;
    for (int k = 0; k < 7; ++k) {
      s_x[k] = static_cast<double>(
          derivative([&](const auto& at) { return potential.extension(at); }, x, k));
      d_x.col(k) = derivative([&](const auto& at) { return potential.sleeve_offset(at); }, x, k)
                       .template cast<double>();
    }
    include((bent.element.s_x - to_base.transpose() * s_x).norm());
    if (GetParam() == FlexibleAxes::gimbal)  // else a part of the spin is taken out on purpose
      include((bent.element.d_x - d_x * to_base).norm() / l);
    const Matrix7 oil = bent.element.k_h * bent.element.s_x * bent.element.s_x.transpose();
    include(difference(bent.element.K - bent.K_without_oil, oil, l));
  });
  EXPECT_LE(worst, tolerance);
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

/// End shortening of a knee under compression F, u and φ towards the same side:
/// s = l − l_mn + l_mn φ²/2 − (u + l_mn φ)² / (2 l), so that F does work on φ and is resisted by u.
TEST_P(Leg, CompressedKneeSoftensAsItsEndsComeNearer) {
  for_random_legs(50, [&](const model::Leg& leg, const Vector3& a) {
    const double F = random_.uniform(-1e4, 3e4);
    const auto bent = bent_leg(leg, a, GetParam(), Vector3::Zero(), {.oil_force = -F});
    const auto& K = bent.element.K;
    const double l = bent.element.l, l_m = bent.element.l_m, l_mh = bent.element.l_mh;
    const double k_s = leg.guide_sleeve.stiffness, k_g = leg.piston_ring->stiffness;
    const double l_mn = leg.rod.length;
    const double scale = k_s + k_g + std::abs(F) / l;
    const double tolerance = 40.0 * epsilon * scale;
    EXPECT_NEAR(K(3, 3), k_s * l_mh * l_mh - F * l_m * l_mn / l, tolerance * l * l);
    EXPECT_NEAR(K(4, 4), k_s * l_mh * l_mh - F * l_m * l_mn / l, tolerance * l * l);
    EXPECT_NEAR(K(4, 5), k_s * l_mh + F * l_mn / l, tolerance * l);
    EXPECT_NEAR(K(3, 6), -k_s * l_mh - F * l_mn / l, tolerance * l);
    EXPECT_NEAR(K(5, 5), k_s + k_g + F / l, tolerance);
    EXPECT_NEAR(K(6, 6), k_s + k_g + F / l, tolerance);
    EXPECT_NEAR(K(0, 0), -F / l, tolerance);
    EXPECT_NEAR(K(1, 1), -F / l, tolerance);
    EXPECT_NEAR(K(2, 2), bent.element.k_h, 40.0 * epsilon * (scale + bent.element.k_h));
  });
}

TEST_P(Leg, FoldedTooFarDoesNotExist) {
  model::Leg leg;
  leg.rod.length = 0.5;
  leg.oil_spring.stiffness = 1e6;
  const Vector3 a(0.0, 0.0, 0.2);  // nearer to the base than the rod's end can be from the axis
  LegState state;
  state.flexible[0] = 1.0;
  EXPECT_FALSE(bent_leg(leg, a, GetParam(), Vector3::Zero(), state).exists);
  state.flexible[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(bent_leg(leg, a, GetParam(), Vector3::Zero(), state).exists);
}

INSTANTIATE_TEST_SUITE_P(, Leg, both_axes(), [](const auto& test) { return name(test.param); });

TEST(LegFrame, IsMadeOfTheLowerGimbalsAxes) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Vector3 n = random.direction(), a1 = random.direction();
    if (std::abs(n.dot(a1)) > 0.95) continue;
    const auto frame = dynamics::leg_frame(n, a1, FlexibleAxes::gimbal);
    const auto& R = frame.R_BL;
    EXPECT_LE((R.transpose() * R - spatial::Matrix3::Identity()).norm(), 10.0 * epsilon);
    EXPECT_NEAR(R.determinant(), 1.0, 10.0 * epsilon);
    EXPECT_LE((R.col(2) - n).norm(), 4.0 * epsilon);
    EXPECT_NEAR(R.col(1).dot(a1), 0.0, 10.0 * epsilon);
    EXPECT_NEAR(frame.tan_gimbal * R.col(0).dot(a1), n.dot(a1), 10.0 * epsilon);
    EXPECT_EQ(dynamics::leg_frame(n, a1, FlexibleAxes::transverse).tan_gimbal, 0.0);
  }
}

TEST(LegFrame, AlongItsGimbalAxisIsAnErrorOnlyWhereThatAxisCounts) {
  const Vector3 n = Vector3(0.3, 0.2, 1.0).normalized();
  const auto transverse = dynamics::leg_frame(n, n, FlexibleAxes::transverse);
  EXPECT_LE((transverse.R_BL.transpose() * transverse.R_BL - spatial::Matrix3::Identity()).norm(),
            10.0 * epsilon);
  try {
    dynamics::leg_frame(n, n, FlexibleAxes::gimbal);
    FAIL() << "nothing thrown";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "gimbal_axis: the leg points along its lower gimbal's first axis (gimbal lock)");
  }
}

}  // namespace
}  // namespace hydrapod::test
