#pragma once
/// Machine files whose legs are plain struts, or electric cylinders.

#include <string>

#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::test {

inline const std::string around_the_legs = R"(name = "Ugly"
[environment]
gravity = 9.81
[base.joints]
circle = { radius = 1.137, spacing = 0.263 }
[platform.joints]
circle = { radius = 0.811, spacing = 0.247 }
[platform]
mass = 1387.3
mass_center = [0.013, -0.021, 0.187]
inertia = { xx = 431.7, yy = 517.9, zz = 763.1, xy = 11.3 }
[poses.neutral]
position = [0.031, -0.017, 1.393]
rotation = [0.03, -0.05, 0.02]
[poses.up]
position = [0, 0, 1.471]
)";

inline const std::string strut_file = around_the_legs + R"([legs.strut]
stiffness = "17.3 kN/mm"
damping = "2.7 kN s/m"
)";

inline const std::string screw_file = around_the_legs + R"([legs.case]
mass = 33.7
mass_center = 0.47
transverse_inertia = 2.9
[legs.rod]
length = 1.05
mass = 21.3
mass_center = 0.51
transverse_inertia = 1.9
diameter = "61 mm"
[legs.guide_sleeve]
position = 1.0
stiffness = "5.3 kN/mm"
[legs.stroke]
retracted = 0.25
length = 0.6
[legs.screw]
stiffness = "91 N/um"
damping = "3.1 kN s/m"
lead = "11.7 mm"
inertia = 0.0043
torque_limit = "37 N m"
speed_limit = "2900 rpm"
friction_torque = "0.83 N m"
viscous_friction = "0.0021 N m s/rad"
)";

inline model::Machine machine_of(const std::string& text) {
  return model::parse_machine(text, "m.toml", {}, kinematics::check_machine).machine;
}

/// Electric cylinders with dampers of every kind, compliant gimbals, gravity.
inline model::Machine ugly_screws() {
  auto machine = machine_of(screw_file);
  machine.damping.rayleigh_mass = 0.37;
  machine.damping.rayleigh_stiffness = 1.3e-5;
  machine.damping.modal_ratio = 0.0;
  for (int i = 0; i < 5; ++i)  // the sixth is rigid
    machine.legs[static_cast<std::size_t>(i)].gimbal_stiffness = 1.9e8 + 3e7 * i;
  return machine;
}

/// Without what a linear model leaves out: Coulomb friction, steps of the converter.
inline model::Machine smooth(model::Machine machine) {
  for (auto& leg : machine.legs) leg.screw->friction_torque = 0.0;
  machine.controller.output.resolution = 0.0;
  return machine;
}

}  // namespace hydrapod::test
