/// Laws of rotations and poses: at the identity, at tiny angles, at random ones.

#include "hydrapod/spatial/pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/random.hpp"

namespace hydrapod::test {
namespace {

using spatial::Matrix3;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
constexpr double pi = std::numbers::pi;

/// Rotation vectors: none, ever smaller ones, half turns, and a thousand anywhere.
std::vector<Vector3> rotation_vectors() {
  std::vector<Vector3> list{Vector3::Zero()};
  Random random(9);
  for (int exponent = -320; exponent < 0; exponent += 20)
    list.push_back(std::pow(10.0, exponent) * random.direction());
  for (const auto& axis : {Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()}) {
    list.push_back(0.5 * pi * axis);
    list.push_back(pi * axis);
  }
  for (int i = 0; i < 1000; ++i) {
    const Vector3 axis = random.direction();
    list.push_back(random.uniform(-pi, pi) * axis);
  }
  return list;
}

void expect_rotation(const Matrix3& R) {
  EXPECT_LE((R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff(), rounding);
  EXPECT_NEAR(R.determinant(), 1.0, rounding);
}

TEST(Skew, IsTheCrossProduct) {
  Random random(10);
  for (int i = 0; i < 100; ++i) {
    const Vector3 v = random.vector(3.0), w = random.vector(3.0);
    EXPECT_LE((spatial::skew(v) * w - v.cross(w)).norm(), rounding * v.norm() * w.norm());
    EXPECT_EQ(spatial::skew(v).transpose(), -spatial::skew(v));
  }
}

TEST(RotationVector, TurnsByItsLengthAboutItself) {
  for (const Vector3& w : rotation_vectors()) {
    const Matrix3 R = spatial::rotation_from_vector(w);
    expect_rotation(R);
    EXPECT_LE((R * w - w).norm(), rounding * w.norm()) << w.transpose();
    EXPECT_NEAR(R.trace(), 1.0 + 2.0 * std::cos(w.norm()), 4 * rounding);
    EXPECT_LE((spatial::rotation_from_vector(-w) * R - Matrix3::Identity()).norm(), rounding);
  }
}

/// exp(w^×) by its series, summed until nothing is added.
TEST(RotationVector, IsTheMatrixExponential) {
  for (const Vector3& w : rotation_vectors()) {
    Matrix3 sum = Matrix3::Identity(), term = Matrix3::Identity();
    for (int k = 1; k < 60; ++k) {
      term = (term * spatial::skew(w) / k).eval();
      sum += term;
    }
    EXPECT_LE((sum - spatial::rotation_from_vector(w)).norm(), 8 * rounding) << w.transpose();
  }
}

TEST(RotationVector, OfTinyAnglesIsExactToFirstOrder) {
  const Vector3 w(1e-9, -2e-9, 3e-9);
  const Matrix3 R = spatial::rotation_from_vector(w);
  EXPECT_LE((R - Matrix3::Identity() - spatial::skew(w)).norm(), w.squaredNorm());
  EXPECT_EQ(spatial::rotation_from_vector(Vector3::Zero()), Matrix3::Identity());
}

TEST(RollPitchYaw, TurnsAboutXThenYThenZ) {
  EXPECT_EQ(spatial::rotation_from_rpy(Vector3::Zero()), Matrix3::Identity());
  Random random(11);
  for (int i = 0; i < 1000; ++i) {
    const Vector3 rpy = random.vector(pi);
    const Matrix3 R = spatial::rotation_from_rpy(rpy);
    expect_rotation(R);
    const Matrix3 expected = spatial::rotation_from_vector({0.0, 0.0, rpy.z()}) *
                             spatial::rotation_from_vector({0.0, rpy.y(), 0.0}) *
                             spatial::rotation_from_vector({rpy.x(), 0.0, 0.0});
    EXPECT_LE((R - expected).norm(), rounding);
  }
}

TEST(RollPitchYaw, ComesBackFromTheRotation) {
  Random random(12);
  for (int i = 0; i < 1000; ++i) {
    const double size = i % 2 == 0 ? 1.0 : 1e-8;
    const Vector3 rpy(size * random.uniform(-pi, pi), 0.499 * size * random.uniform(-pi, pi),
                      size * random.uniform(-pi, pi));
    const Vector3 back = spatial::rpy_from_rotation(spatial::rotation_from_rpy(rpy));
    const double steep = 1.0 / std::cos(rpy.y());  // near the pole roll and yaw are told apart less
    EXPECT_LE((back - rpy).norm(), rounding * (1.0 + steep) * 2.0) << rpy.transpose();
  }
}

/// At the pole roll is zero by choice, and the rotation is kept. Pitch comes from an arc sine
/// there, which knows it to √ε only.
TEST(RollPitchYaw, KeepsTheRotationAtThePole) {
  for (const double pitch : {0.5 * pi, -0.5 * pi})
    for (const double roll : {-2.0, 0.0, 0.7})
      for (const double yaw : {-1.0, 0.0, 3.0}) {
        const Matrix3 R = spatial::rotation_from_rpy({roll, pitch, yaw});
        const Vector3 rpy = spatial::rpy_from_rotation(R);
        EXPECT_EQ(rpy.x(), 0.0);
        EXPECT_LE((spatial::rotation_from_rpy(rpy) - R).norm(), rounding);
      }
}

TEST(RollPitchYaw, IsAccurateNearThePoleToo) {
  for (const double short_of_pole : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) {
    const Vector3 rpy(0.3, 0.5 * pi - short_of_pole, -0.4);
    const Matrix3 R = spatial::rotation_from_rpy(rpy);
    const Matrix3 back = spatial::rotation_from_rpy(spatial::rpy_from_rotation(R));
    EXPECT_LE((back - R).norm(), rounding);
  }
}

TEST(Displaced, AddsTheShiftAndTurnsInBaseAxes) {
  Random random(13);
  const Pose start{random.rotation(), random.vector(2.0)};
  EXPECT_EQ(spatial::displaced(start, Vector6::Zero()).R_BP, start.R_BP);
  EXPECT_EQ(spatial::displaced(start, Vector6::Zero()).p_BP, start.p_BP);
  for (int i = 0; i < 100; ++i) {
    const Vector6 step = random.displacement(1.0, pi);
    const Pose there = spatial::displaced(start, step);
    EXPECT_EQ(there.p_BP, start.p_BP + step.head<3>());
    const Vector3 point = random.vector(1.0);
    const Vector3 expected =
        spatial::rotation_from_vector(step.tail<3>()) * (start * point - start.p_BP) + there.p_BP;
    EXPECT_LE((there * point - expected).norm(), 4 * rounding * (1.0 + point.norm()));
    const Pose back = spatial::displaced(there, -step);
    EXPECT_LE((back.R_BP - start.R_BP).norm(), 2 * rounding);
    EXPECT_LE((back.p_BP - start.p_BP).norm(), rounding * 4.0);
  }
}

TEST(Displaced, BySmallStepsIsATwist) {
  Random random(14);
  const Pose start{random.rotation(), random.vector(2.0)};
  for (int i = 0; i < 100; ++i) {
    const Vector6 twist = random.displacement(1.0, 1.0);
    const Vector3 point = random.vector(1.0);
    constexpr double h = 1e-6;
    const Vector3 rate = (spatial::displaced(start, h * twist) * point -
                          spatial::displaced(start, -h * twist) * point) /
                         (2.0 * h);
    const Vector3 arm = start.R_BP * point;
    EXPECT_LE((rate - twist.head<3>() - twist.tail<3>().cross(arm)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace hydrapod::test
