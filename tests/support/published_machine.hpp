#pragma once
/// The mechanism of Zhang & Jiang, Energies 2021, 14, 1604, as one admissible set of the parameters
/// that its Table 1 leaves out (docs/validation/published-machine.md). Four values carry one or two
/// digits more than the rounded set that is printed there, so that the frequencies come out to
/// their last digit.

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::test {

/// Flexible axes `gimbal`, no gravity, as in the paper; pose "neutral" only; no piston rings.
inline model::Machine published_machine() {
  model::Machine machine{.name = "Zhang & Jiang 2021"};
  machine.gravity.setZero();
  machine.flexible_axes = model::FlexibleAxes::gimbal;
  machine.poses = {{"neutral", {.p_BP = {0.0, 0.0, 0.783}}}};
  machine.platform = {.mass = 894.0,
                      .mass_center = {0.0, 0.0, -0.163},
                      .inertia = spatial::Vector3(45.1022, 45.1022, 54.5344).asDiagonal()};
  const auto base = model::base_joint_points({.radius = 0.5995, .spacing = 0.17});
  const auto platform = model::platform_joint_points({.radius = 0.4, .spacing = 0.17});
  for (int i = 0; i < model::leg_count; ++i) {
    machine.legs[i].base_joint = base[i];
    machine.legs[i].platform_joint = platform[i];
  }
  constexpr double l_m = 0.488, l_mh = 0.060665;
  const double l = kinematics::leg_lengths(machine, machine.neutral())[0];  // 0.8734 m
  for (auto& leg : machine.legs) {
    leg.cylinder_case = {.mass = 7.207,
                         .mass_center = 0.1602,
                         .transverse_inertia = 0.2627,
                         .axial_inertia = 0.0035};
    leg.rod = {.length = l - l_m,
               .mass = 1.620,
               .mass_center = 0.183,
               .transverse_inertia = 0.305114,
               .axial_inertia = 0.0084};
    leg.guide_sleeve = {.position = l_m + l_mh, .stiffness = 1.5732e5};
    leg.oil_spring.stiffness = 3.85353e6;
    leg.gimbal_axis = spatial::Vector3::UnitY();
  }
  return machine;
}

}  // namespace hydrapod::test
