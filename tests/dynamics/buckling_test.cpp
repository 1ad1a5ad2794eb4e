/// The payload at which the legs fold.

#include "hydrapod/dynamics/linear_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/modal/normal_modes.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::Buckling;
using dynamics::BucklingStatus;
using dynamics::ModelKind;

Buckling buckling_of(const model::Machine& machine, ModelKind kind = ModelKind::guide) {
  return dynamics::buckling_payload(machine, machine.neutral(), kind);
}

double lowest_omega2(model::Machine machine, double mass, const Buckling& buckling,
                     ModelKind kind = ModelKind::guide) {
  machine.platform.mass = mass;
  const auto model = dynamics::linear_model(machine, machine.neutral(), kind, &buckling.last);
  return modal::normal_modes(model).omega2[0];
}

/// Weightless legs stay straight whatever they carry.
model::Machine with_weightless_legs(double k_s = 1.5732e5) {
  auto machine = symmetric_machine(9.81);
  for (auto& leg : machine.legs) {
    leg.cylinder_case.mass = leg.rod.mass = 0.0;
    leg.guide_sleeve.stiffness = k_s;
  }
  return machine;
}

/// Load per leg at which a knee between fixed joints folds: F l_m l_mn / l = k_s l_mh².
double mass_of_fixed_knees(const model::Machine& machine) {
  const auto legs = kinematics::inverse_kinematics(machine, machine.neutral());
  const auto& leg = machine.legs[0];
  const double l = legs[0].length, l_m = l - leg.rod.length;
  const double l_mh = leg.guide_sleeve.position - l_m;
  const double force = leg.guide_sleeve.stiffness * l_mh * l_mh * l / (l_m * leg.rod.length);
  return 6.0 * force * legs[0].n.z() / 9.81;
}

TEST(Buckling, OfStraightLegsIsWhereAModeReachesZero) {
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    auto machine = with_weightless_legs();
    for (auto& leg : machine.legs) leg.piston_ring->stiffness = 1e7;  // soft ones fold at once
    const auto found = buckling_of(machine, kind);
    ASSERT_EQ(found.status, BucklingStatus::found);
    EXPECT_FALSE(found.limit_point);
    const double mass = machine.platform.mass + found.payload;
    constexpr double bracket = 2.0 * dynamics::BucklingOptions{}.tolerance;
    EXPECT_GT(lowest_omega2(machine, mass * (1.0 - bracket), found, kind), 0.0);
    EXPECT_LT(lowest_omega2(machine, mass * (1.0 + bracket), found, kind), 0.0);
  }
}

/// The platform gives way on its oil springs, so the machine folds before fixed knees would; on
/// hard oil it folds just when they do.
TEST(Buckling, OnHardOilIsThatOfTheKneesAlone) {
  auto machine = with_weightless_legs();
  EXPECT_LT(machine.platform.mass + buckling_of(machine).payload, mass_of_fixed_knees(machine));
  for (auto& leg : machine.legs) leg.oil_spring.stiffness = 1e13;
  const double mass = machine.platform.mass + buckling_of(machine).payload;
  EXPECT_NEAR(mass / mass_of_fixed_knees(machine), 1.0, 1e-5);
}

/// With straight legs on oil that is harder in proportion nothing else has a scale.
TEST(Buckling, LoadOfWeightlessLegsIsProportionalToStiffness) {
  const auto soft = with_weightless_legs(1.5e5);
  const double mass = soft.platform.mass + buckling_of(soft).payload;
  for (const double factor : {2.0, 5.0}) {
    auto stiff = with_weightless_legs(factor * 1.5e5);
    for (auto& leg : stiff.legs) *leg.oil_spring.stiffness *= factor;
    const double stiff_mass = stiff.platform.mass + buckling_of(stiff).payload;
    EXPECT_NEAR(stiff_mass / mass, factor, 3.0 * factor * dynamics::BucklingOptions{}.tolerance);
  }
}

/// Legs that hang by their own weight before they are loaded end at a limit point, below the load
/// of straight ones and with a mode that has sunk but not to zero.
TEST(Buckling, OfHeavyLegsIsALimitPointBelowThatOfStraightOnes) {
  const auto machine = symmetric_machine(9.81);
  const auto bent = buckling_of(machine);
  const auto straight = buckling_of(with_weightless_legs());
  ASSERT_EQ(bent.status, BucklingStatus::found);
  EXPECT_TRUE(bent.limit_point);
  EXPECT_LT(bent.payload, straight.payload);
  EXPECT_GT(bent.payload, 0.0) << "the published machine stands";
  const double mass = machine.platform.mass + bent.payload;
  constexpr double bracket = 2.0 * dynamics::BucklingOptions{}.tolerance;
  EXPECT_GT(lowest_omega2(machine, mass * (1.0 - bracket), bent), 0.0);
  auto beyond = machine;
  beyond.platform.mass = mass * (1.0 + 1e-3);
  const auto statics =
      dynamics::static_equilibrium(beyond, beyond.neutral(), ModelKind::guide, {}, &bent.last);
  bool stands = statics.status == dynamics::StaticsStatus::converged;
  if (stands) stands = lowest_omega2(beyond, beyond.platform.mass, bent) > 0.0;
  EXPECT_FALSE(stands) << "nothing stable a little beyond";
}

TEST(Buckling, OfAnOverloadedMachineSaysWhatMustComeOff) {
  auto machine = with_weightless_legs();
  const double carried = machine.platform.mass + buckling_of(machine).payload;
  machine.platform.mass = 1.5 * carried;
  machine.platform.inertia *= 1.5;
  const auto found = buckling_of(machine);
  EXPECT_EQ(found.status, BucklingStatus::buckled);
  EXPECT_NEAR(found.payload / (-0.5 * carried), 1.0, 1e-4);
}

/// A supply that holds no more than the platform is no limit of the legs.
TEST(Buckling, DoesNotDependOnTheSupply) {
  auto machine = with_weightless_legs();
  const auto wanted = buckling_of(machine);
  ASSERT_EQ(wanted.status, BucklingStatus::found);
  machine.damping.oil = model::OilDamping::chambers;
  for (auto& leg : machine.legs)
    leg.hydraulics.equivalent_cylinder = {.area_ratio = 0.53, .area = 1.3e-3};
  auto& supply = machine.hydraulics.supply;
  const auto rigid = dynamics::static_equilibrium(machine, machine.neutral(), ModelKind::rigid);
  double most = 0.0;
  for (const auto& leg : rigid.legs) most = std::max(most, std::abs(leg.oil_force));
  supply.pressure = supply.return_pressure + 1.31 * most / 1.3e-3;
  ASSERT_GT(wanted.payload, 0.4 * machine.platform.mass) << "beyond what the supply holds";
  const auto found = buckling_of(machine);
  EXPECT_EQ(found.status, wanted.status);
  EXPECT_NEAR(found.payload, wanted.payload, 1e-9 * wanted.payload);
}

TEST(Buckling, IsNotFoundWithoutGravityOrWithStiffSeals) {
  EXPECT_EQ(buckling_of(symmetric_machine(0.0)).status, BucklingStatus::not_found);
  auto stiff = symmetric_machine(9.81);
  for (auto& leg : stiff.legs) {
    leg.guide_sleeve.stiffness = 1e10;
    leg.oil_spring.stiffness = 1e11;
  }
  EXPECT_EQ(buckling_of(stiff).status, BucklingStatus::not_found);
}

TEST(Buckling, OfRandomMachinesIsBeyondTheLoadTheyWereDrawnFor) {
  Random random(41);
  for (int i = 0; i < 20; ++i) {
    const auto machine = random_machine(random, {.gravity = Gravity::down});
    const auto found = buckling_of(machine);
    if (found.status == BucklingStatus::not_found) continue;
    EXPECT_EQ(found.status, BucklingStatus::found);
    EXPECT_GT(found.payload, 0.0);
    const double mass = machine.platform.mass + found.payload;
    EXPECT_GT(lowest_omega2(machine, mass * (1.0 - 2e-6), found), 0.0);
  }
}

}  // namespace
}  // namespace hydrapod::test
