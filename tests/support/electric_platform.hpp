#pragma once
/// The heavy platform on electric cylinders, whose motors stay below their limits, where torques
/// have corners.

#include "support/loop_machine.hpp"

namespace hydrapod::test {

inline model::Machine electric_platform() {
  auto machine = simulation::machine_of("heavy-platform", simulation::smooth);
  for (auto& leg : machine.legs) {
    leg.oil_spring = {};
    leg.screw = model::Screw{.stiffness = 310e6,
                             .damping = 7.3e3,
                             .lead = 0.0117,
                             .inertia = 0.043,
                             .torque_limit = 4e3,
                             .speed_limit = 303.7,
                             .friction_torque = 0.83,
                             .viscous_friction = 0.019};
  }
  machine.legs[1].screw->speed_bandwidth = 37.0;
  machine.legs[4].screw->speed_integral_time = 0.0193;
  return machine;
}

}  // namespace hydrapod::test
