/// Static equilibrium under gravity.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/published_machine.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using dynamics::StaticsStatus;
using model::FlexibleAxes;
using spatial::Vector3;

constexpr double equilibrium_tolerance = dynamics::StaticsOptions{}.tolerance;

class Statics : public testing::TestWithParam<AxesAndKind> {};

TEST_P(Statics, LegsCarryThePlatformAndTheirOwnBendIsBalanced) {
  const auto [axes, kind] = GetParam();
  Random random(1687);
  for (int i = 0; i < 30; ++i) {
    const auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
    const auto& X_BP = machine.poses[1].X_BP;
    const auto statics = dynamics::static_equilibrium(machine, X_BP, kind);
    ASSERT_EQ(statics.status, StaticsStatus::converged);
    EXPECT_LE(statics.residual, equilibrium_tolerance);
    const Vector3 weight = machine.platform.mass * machine.gravity;
    Vector3 force = weight, moment = Vector3::Zero();
    for (int leg = 0; leg < model::leg_count; ++leg) {
      const Vector3 a = X_BP * machine.legs[leg].platform_joint;
      const auto bent =
          dynamics::bent_leg(machine.legs[leg], a, axes, machine.gravity, statics.legs[leg]);
      force -= bent.joint_force;
      moment -= (a - kinematics::mass_center(machine, X_BP)).cross(bent.joint_force);
      EXPECT_LE(bent.flexible_gradient.head(dynamics::flexible_per_leg(kind)).norm(),
                2.0 * equilibrium_tolerance * 2.0 * weight.norm());
      EXPECT_TRUE(
          statics.legs[leg].flexible.tail(4 - dynamics::flexible_per_leg(kind)).isZero(0.0));
    }
    EXPECT_LE(force.norm(), 4.0 * equilibrium_tolerance * weight.norm());
    EXPECT_LE(moment.norm(), 4.0 * equilibrium_tolerance * weight.norm());
  }
}

TEST_P(Statics, WithoutGravityNothingBends) {
  const auto [axes, kind] = GetParam();
  Random random(5);
  const auto machine = random_machine(random, {.axes = axes});
  const auto statics = dynamics::static_equilibrium(machine, machine.neutral(), kind);
  EXPECT_EQ(statics.status, StaticsStatus::converged);
  EXPECT_EQ(statics.iterations, 0);
  for (const auto& leg : statics.legs) {
    EXPECT_TRUE(leg.flexible.isZero(0.0));
    EXPECT_EQ(leg.oil_force, 0.0);
  }
}

TEST_P(Statics, AWeakGravityIsTheLimitOfNoGravity) {
  const auto [axes, kind] = GetParam();
  Random random(6);
  auto machine = random_machine(random, {.axes = axes});
  const auto lambda = [&] {
    const auto model = dynamics::linear_model(machine, machine.poses[1].X_BP, kind);
    return omega_squared(model.M, model.K);
  };
  const Eigen::VectorXd without = lambda();
  machine.gravity = 1e-10 * random.direction();  // [m/s²]
  EXPECT_LE(worst_frequency_error(lambda(), without), 1e-10);
}

/// Stiff seals hold the rods straight: oil forces are those of rigid legs. Rounding of the seals'
/// forces is above the tolerance then.
TEST_P(Statics, OfVeryStiffSealsIsThatOfRigidLegs) {
  const auto [axes, kind] = GetParam();
  Random random(311);
  for (const double stiffness : {3e9, 2e11, 1e13, 1e15}) {
    auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
    for (auto& leg : machine.legs) {
      leg.guide_sleeve.stiffness = stiffness;
      leg.piston_ring = model::PistonRing{.stiffness = 0.7 * stiffness};
    }
    const auto& X_BP = machine.poses[1].X_BP;
    const auto bent = dynamics::static_equilibrium(machine, X_BP, kind);
    const auto straight = dynamics::static_equilibrium(machine, X_BP, ModelKind::rigid);
    ASSERT_EQ(bent.status, StaticsStatus::converged) << stiffness << ": " << bent.residual;
    const double weight = machine.platform.mass * machine.gravity.norm();
    for (int leg = 0; leg < model::leg_count; ++leg)
      EXPECT_NEAR(bent.legs[leg].oil_force, straight.legs[leg].oil_force, 1e-4 * weight)
          << stiffness;
  }
}

TEST_P(Statics, StartedAtANeighbourItNeedsNoMoreIterations) {
  const auto [axes, kind] = GetParam();
  Random random(7);
  for (int i = 0; i < 10; ++i) {
    const auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::down});
    const auto& X_BP = machine.poses[1].X_BP;
    const auto cold = dynamics::static_equilibrium(machine, X_BP, kind);
    const auto neighbour = dynamics::static_equilibrium(
        machine, spatial::displaced(X_BP, random.displacement(1e-5, 1e-5)), kind);
    const auto warm = dynamics::static_equilibrium(machine, X_BP, kind, {}, &neighbour);
    EXPECT_LE(warm.iterations, cold.iterations);
    EXPECT_LE(warm.iterations, 2);
    for (int leg = 0; leg < model::leg_count; ++leg)
      EXPECT_LE((warm.legs[leg].flexible - cold.legs[leg].flexible).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(, Statics,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

model::Machine symmetric_machine() {
  auto machine = published_machine();
  machine.flexible_axes = FlexibleAxes::transverse;
  machine.gravity = {0.0, 0.0, -9.81};
  return machine;
}

/// Direction of the rod in the case frame from its tilts.
Vector3 rod_direction(const dynamics::LegState& state) {
  const double phi_1 = state.flexible[0], phi_2 = state.flexible[1];
  return {std::sin(phi_2), -std::sin(phi_1) * std::cos(phi_2), std::cos(phi_1) * std::cos(phi_2)};
}

TEST(SymmetricMachine, StandsSymmetrically) {
  const auto machine = symmetric_machine();
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto& first = model.statics.legs[0];
  const double first_tilt = rod_direction(first).head<2>().norm();
  constexpr double same = 1e-10;  // an unbalanced 1e-11 of the weight tilts the knees by 4e-10 rad
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& state = model.statics.legs[i];
    EXPECT_NEAR(state.oil_force / first.oil_force, 1.0, same);
    const Vector3 rod = rod_direction(state);
    EXPECT_NEAR(rod.head<2>().norm(), first_tilt, same);
    // Case and rod stand in the vertical plane of the leg.
    const Vector3 bend_axis = model.legs[i].frame.R_BL * Vector3::UnitZ().cross(rod);
    EXPECT_NEAR(bend_axis.z(), 0.0, same);
    EXPECT_GT(bend_axis.norm(), 0.01);
  }
  EXPECT_NEAR(first_tilt, 13.5e-3, 0.05e-3);
  // Upright, six legs carry the platform and between nothing and all of their own weight.
  const double upward = -6.0 * first.oil_force * model.legs[0].frame.R_BL(2, 2);
  const auto& leg = machine.legs[0];
  EXPECT_GT(upward, 894.0 * 9.81);
  EXPECT_LT(upward, (894.0 + 6.0 * (leg.cylinder_case.mass + leg.rod.mass)) * 9.81);
}

/// Light legs on hard oil: the platform cannot move, so each knee buckles on its own.
TEST(SymmetricMachine, BucklesAtTheLoadOfItsKnees) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) {
    leg.oil_spring.stiffness = 1e14;
    leg.cylinder_case.mass = leg.rod.mass = 1e-9;
  }
  const auto legs = kinematics::inverse_kinematics(machine, machine.neutral());
  const auto& leg = machine.legs[0];
  const double l = legs[0].length, l_m = l - leg.rod.length;
  const double l_mh = leg.guide_sleeve.position - l_m;
  const double buckling_force =
      leg.guide_sleeve.stiffness * l_mh * l_mh * l / (l_m * leg.rod.length);
  const double buckling_mass = 6.0 * buckling_force * legs[0].n.z() / 9.81;
  const auto softest = [&](double share) {
    machine.platform.mass = share * buckling_mass;
    const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
    return omega_squared(model.M, model.K)[0];
  };
  EXPECT_GT(softest(1.0 - 1e-4), 0.0);
  EXPECT_LT(softest(1.0 + 1e-4), 0.0);
}

std::string message_of(const model::Machine& machine) {
  try {
    dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  } catch (const base::ComputationError& error) {
    return error.what();
  }
  return "nothing thrown";
}

/// Between the load that a bent leg can hold and the one past which a straight one is an unstable
/// equilibrium there is none at all.
TEST(SymmetricMachine, WithLegsTooHeavyForItsSealsHasNoEquilibriumAndSaysSo) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) {
    leg.cylinder_case.mass *= 10.0;
    leg.rod.mass *= 10.0;
  }
  EXPECT_THAT(message_of(machine),
              testing::MatchesRegex(
                  "no static equilibrium of the guide model at this pose: not converged after 60 "
                  "iterations, residual .* of the weight; the legs may be past buckling \\(see "
                  "`hydrapod check`\\)"));
}

/// Newton's way out of too heavy a load is often a leg folded past its guide sleeve.
TEST(OverloadedMachines, NeverStandWithAPistonPastItsGuideSleeve) {
  Random random(23);
  int folded = 0;
  for (int i = 0; i < 200; ++i) {
    auto machine = random_machine(random, {.gravity = Gravity::down});
    for (auto& leg : machine.legs) {
      leg.cylinder_case.mass *= 15.0;
      leg.rod.mass *= 15.0;
    }
    const auto statics = dynamics::static_equilibrium(machine, machine.neutral(), ModelKind::guide);
    if (statics.status == StaticsStatus::converged) {
      const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
      for (const auto& leg : model.legs) EXPECT_GT(leg.l_mh, 0.0);
    }
    if (statics.status != StaticsStatus::folded) continue;
    ++folded;
    EXPECT_THAT(message_of(machine), testing::HasSubstr("at this pose: a leg folds up after"));
  }
  EXPECT_GT(folded, 5);
  RecordProperty("folded", folded);
}

}  // namespace
}  // namespace hydrapod::test
