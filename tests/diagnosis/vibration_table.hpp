#pragma once
/// A third machine for the series on records: small, fast and without symmetry.

namespace hydrapod::test {

inline constexpr const char* vibration_table = R"(
name = "Vibration table"
description = "2.4-tonne table on cylinders 50/36 x 270 mm, its load off centre"

[base.joints]
circle = { radius = "0.731 m", spacing = "0.193 m" }
[base.mount]                            # a steel frame, believed not to give way
mass = "1.87 t"
inertia = ["517 kg m^2", "483 kg m^2", "871 kg m^2"]
stiffness = { z = "1.9 kN/um" }

[platform.joints]
circle = { radius = "0.473 m", spacing = "0.137 m" }
[platform]
mass = "2.371 t"
mass_center = ["0.037 m", "-0.021 m", "0.163 m"]
inertia = { xx = "271.3 kg m^2", yy = "318.7 kg m^2", zz = "447.1 kg m^2", xy = "13.3 kg m^2", xz = "-21.7 kg m^2", yz = "9.1 kg m^2" }

[legs]
added_axial_inertia = "2.3 kg"
[legs.case]
mass = "13.7 kg"
mass_center = "0.227 m"
transverse_inertia = "0.371 kg m^2"
axial_inertia = "0.0083 kg m^2"
[legs.rod]
length = "0.623 m"
mass = "9.31 kg"
mass_center = "0.293 m"
transverse_inertia = "0.347 kg m^2"
axial_inertia = "0.0021 kg m^2"
[legs.guide_sleeve]
position = "0.571 m"
stiffness = "3.37 kN/mm"
damping = "83 N s/m"
[legs.stroke]
retracted = "0.273 m"
length = "0.27 m"
[legs.oil_spring]
damping = "3.1 kN s/m"
[legs.oil_spring.cylinder]
bore = "50 mm"
rod_diameter = "36 mm"
bulk_modulus = "1.13 GPa"
cap_dead_volume = "31 ml"
rod_dead_volume = "29 ml"
cap_line_volume = "113 ml"
rod_line_volume = "97 ml"
air = { fraction = "0.1 %", pressure = "57 bar" }
[supply]
pressure = "137 bar"

[poses.neutral]
position = [0, 0, "0.937 m"]
[poses.tilted]
position = ["0.043 m", "-0.029 m", "0.891 m"]
rotation = ["2.3 deg", "-3.1 deg", "4.1 deg"]
)";

}  // namespace hydrapod::test
