/// The points that pictures of a leg show, and how they move to first order.

#include "hydrapod/dynamics/leg.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "dynamics/legs_in_motion.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "support/kinds.hpp"
#include "support/other_legs.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::DrawnLeg;
using dynamics::DrawnPoint;
using dynamics::ModelKind;
using model::FlexibleAxes;
using spatial::Vector3;

using Points = std::array<Vector3, 3>;  ///< guide sleeve, piston, rod at the guide sleeve

/// Where the exact nonlinear mechanics have them. `l_mh` is fixed in the rod.
Points exact_points(const dynamics::NonlinearModel& model, const Eigen::VectorXd& y, int i,
                    double l_mh) {
  dynamics::Motion motion;
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(model.velocities());
  model.motion(y.data(), still.data(), motion);
  const auto& at = dynamics::side_by_side(motion);
  const auto& leg = model.machine().legs[i];
  Eigen::Matrix3d R;
  for (int k = 0; k < 9; ++k) R(k / 3, k % 3) = at.R_BL(k / 3, k % 3)[i];
  const Vector3 e(at.e[0][i], at.e[1][i], at.e[2][i]);
  const Vector3 piston(motion.legs[i].flexible[2], motion.legs[i].flexible[3], motion.legs[i].s);
  return {leg.base_joint + R * Vector3(0.0, 0.0, leg.guide_sleeve.position),
          leg.base_joint + R * piston, leg.base_joint + R * (piston + l_mh * e)};
}

/// y with coordinate `k` of the linear models (mass centre, rotation, flexible ones) moved by `by`.
Eigen::VectorXd moved(Eigen::VectorXd y, int k, double by) {
  if (k < 3) {
    y[k] += by;
  } else if (k < 6) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(by, Vector3::Unit(k - 3)));
    const auto q = turn * Eigen::Quaterniond(y[3], y[4], y[5], y[6]);
    y.segment<4>(3) << q.w(), q.x(), q.y(), q.z();
  } else {
    y[k + 1] += by;
  }
  return y;
}

void expect_exact(const DrawnLeg& drawn, const dynamics::NonlinearModel& model,
                  const Eigen::VectorXd& y, const dynamics::LinearModel& linear, int i) {
  constexpr double step = 1e-5;       // central differences: their error is some step²,
  constexpr double tolerance = 1e-7;  // more of it near a gimbal lock
  const double l_mh = linear.legs[i].l_mh;
  const Vector3 a = linear.X_BP * model.machine().legs[i].platform_joint;
  Eigen::Matrix<double, 3, 6> joint;
  joint << Eigen::Matrix3d::Identity(), -spatial::skew(a - linear.p_BC);
  const std::array<const DrawnPoint*, 3> points{&drawn.sleeve, &drawn.piston, &drawn.rod_at_sleeve};
  const auto rest = exact_points(model, y, i, l_mh);
  const int n = model.flexible();
  for (int p = 0; p < 3; ++p) EXPECT_LE((points[p]->p - rest[p]).norm(), 1e-12) << p;
  for (int k = 0; k < 6 + n; ++k) {
    const int coordinate = k < 6 ? k : k + n * i;
    const auto up = exact_points(model, moved(y, coordinate, step), i, l_mh);
    const auto down = exact_points(model, moved(y, coordinate, -step), i, l_mh);
    for (int p = 0; p < 3; ++p) {
      const Vector3 slope = (up[p] - down[p]) / (2.0 * step);
      const Vector3 found =
          k < 6 ? Vector3(points[p]->p_x.leftCols<3>() * joint.col(k)) : points[p]->p_x.col(k - 3);
      EXPECT_LE((found - slope).norm(), tolerance) << "point " << p << ", coordinate " << k;
    }
  }
}

class DrawnLegs : public testing::TestWithParam<AxesAndKind> {};

TEST_P(DrawnLegs, MoveAsTheExactLegDoesToFirstOrder) {
  const auto [axes, kind] = GetParam();
  Random random(20817);
  for (int trial = 0; trial < 10; ++trial) {
    const auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
    const auto& X_BP = machine.poses[1].X_BP;
    const auto linear = dynamics::linear_model(machine, X_BP, kind);
    const dynamics::NonlinearModel model(machine, kind, X_BP);
    Eigen::VectorXd y(model.positions());
    model.configuration(X_BP, linear.statics.legs, y.data());
    const auto geometry = kinematics::inverse_kinematics(machine, X_BP);
    for (int i = 0; i < model::leg_count; ++i) {
      const auto& leg = machine.legs[i];
      expect_exact(dynamics::drawn_leg(leg, linear.legs[i], axes, linear.statics.legs[i]), model, y,
                   linear, i);
      if (kind != ModelKind::rigid) continue;
      const auto straight = dynamics::straight_leg(leg, geometry[i], axes);
      expect_exact(dynamics::drawn_leg(leg, straight, axes, {}), model, y, linear, i);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AxesAndKinds, DrawnLegs,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

TEST(DrawnLeg, OfAStrutIsItsBaseJoint) {
  const auto machine = machine_of(strut_file);
  const auto linear = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const auto drawn =
      dynamics::drawn_leg(machine.legs[4], linear.legs[4], machine.flexible_axes, {});
  for (const auto* point : {&drawn.sleeve, &drawn.piston, &drawn.rod_at_sleeve}) {
    EXPECT_EQ(point->p, machine.legs[4].base_joint);
    EXPECT_TRUE(point->p_x.isZero(0.0));
  }
}

}  // namespace
}  // namespace hydrapod::test
