#pragma once
/// The published mechanism with equal electric cylinders without mass, in mirror images, so that
/// heave moves alone.

#include <cmath>
#include <numbers>

#include "symmetric_machine.hpp"

namespace hydrapod::test {

struct SymmetricScrews {
  static constexpr double lead = 0.0117, inertia = 0.0043, k_a = 91e6, torque = 37.0, speed = 303.7,
                          friction = 0.83, mass = 1387.3;
  /// Of damped_screws(): along the screw [N s/m], of the motor [N m s/rad].
  static constexpr double c_a = 7.1e3, b = 0.019;
  /// 2π/p [rad/m].
  static constexpr double ratio = 2.0 * std::numbers::pi / lead;
  /// m_r [kg].
  static constexpr double reflected = inertia * ratio * ratio;
};

inline model::Machine symmetric_screws(double gravity) {
  using S = SymmetricScrews;
  auto machine = symmetric_machine(gravity);
  machine.platform.mass = S::mass;
  for (auto& leg : machine.legs) {
    leg.piston_ring.reset();
    leg.cylinder_case.mass = leg.cylinder_case.transverse_inertia = 0.0;
    leg.rod.mass = leg.rod.transverse_inertia = 0.0;
    leg.added_axial_inertia = 0.0;
    leg.oil_spring = {};
    leg.screw = model::Screw{.stiffness = S::k_a,
                             .lead = S::lead,
                             .inertia = S::inertia,
                             .torque_limit = S::torque,
                             .speed_limit = S::speed,
                             .friction_torque = S::friction};
  }
  return machine;
}

/// The same without gravity, with dampers.
inline model::Machine damped_screws() {
  auto machine = symmetric_screws(0.0);
  for (auto& leg : machine.legs) {
    leg.screw->damping = SymmetricScrews::c_a;
    leg.screw->viscous_friction = SymmetricScrews::b;
  }
  return machine;
}

/// n_z of every leg at the neutral pose.
inline double rise(const model::Machine& machine) {
  const auto& leg = machine.legs[0];
  const spatial::Vector3 L = machine.neutral() * leg.platform_joint - leg.base_joint;
  return L.z() / L.norm();
}

}  // namespace hydrapod::test
