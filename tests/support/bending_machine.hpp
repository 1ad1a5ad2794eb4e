#pragma once
/// Random machines whose rods and cases bend.

#include "hydrapod/dynamics/leg.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {

/// A machine of random legs that bend half as much as their seals give way, or as much. Seals are
/// stiffer than those of the random machine, so that both together carry its load.
inline model::Machine bending_machine(Random& random, const RandomMachineOptions& options) {
  auto machine = random_machine(random, options);
  for (auto& leg : machine.legs) {
    leg.bending = model::LegBending::elastic;
    leg.rod.diameter = random.uniform(0.04, 0.07) * leg.rod.length;
    leg.rod.wall = 0.3 * *leg.rod.diameter;
    leg.cylinder_case.diameter = 1.7 * *leg.rod.diameter;
    leg.cylinder_case.wall = 0.1 * *leg.rod.diameter;
    leg.rod.youngs_modulus = 2.1e11;
    kinematics::LegGeometry geometry;
    geometry.a = machine.neutral() * leg.platform_joint;
    geometry.length = (geometry.a - leg.base_joint).norm();
    geometry.n = (geometry.a - leg.base_joint) / geometry.length;
    const double f = dynamics::straight_leg(leg, geometry, model::FlexibleAxes::transverse).bending;
    const double share = random.uniform(0.5, 1.0);
    leg.guide_sleeve.stiffness *= 1.0 + share;
    leg.rod.youngs_modulus *= f * leg.guide_sleeve.stiffness / share;
  }
  return machine;
}

}  // namespace hydrapod::test
