#include <fmt/format.h>

#include <algorithm>

#include "mechanism.hpp"

namespace hydrapod::exchange {

namespace {

std::string sdf_pose(const std::string& frame, const Vector3& p, const Matrix3& R) {
  return fmt::format("<pose relative_to='{}'>{} {}</pose>\n", frame, vector_text(p), rpy_text(R));
}

std::string sdf_inertial(double mass, const Vector3& center, const Matrix3& inertia) {
  return fmt::format(
      "<inertial><pose>{} 0 0 0</pose><mass>{:.17g}</mass><inertia><ixx>{:.17g}</ixx>"
      "<ixy>{:.17g}</ixy><ixz>{:.17g}</ixz><iyy>{:.17g}</iyy><iyz>{:.17g}</iyz>"
      "<izz>{:.17g}</izz></inertia></inertial>\n",
      vector_text(center), mass, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
      inertia(1, 2), inertia(2, 2));
}

std::string sdf_visual(const char* name, double from, double to, double radius) {
  return fmt::format(
      "<visual name='{}'><pose>0 0 {:.6g} 0 0 0</pose><geometry><cylinder><radius>{:.6g}</radius>"
      "<length>{:.6g}</length></cylinder></geometry></visual>\n",
      name, 0.5 * (from + to), radius, to - from);
}

/// An axis in the frame of the child link, with spring and damper.
std::string sdf_axis(const char* element, const std::string& frame, const Vector3& axis,
                     const Spring& spring) {
  const double reference = spring.stiffness != 0.0 ? -spring.rest_force / spring.stiffness : 0.0;
  return fmt::format(
      "<{0}><xyz expressed_in='{1}'>{2}</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit>"
      "<dynamics><damping>{3:.17g}</damping><spring_reference>{4:.17g}</spring_reference>"
      "<spring_stiffness>{5:.17g}</spring_stiffness></dynamics></{0}>\n",
      element, frame, vector_text(axis), spring.damping, reference, spring.stiffness);
}

std::string sdf_joint(const std::string& name, const char* type, const std::string& parent,
                      const std::string& child, const std::string& axes) {
  return fmt::format(
      "<joint name='{}' type='{}'><parent>{}</parent><child>{}</child>\n{}</joint>\n", name, type,
      parent, child, axes);
}

Matrix3 axisymmetric(double transverse, double axial, bool spins) {
  constexpr double slim = 1e-6;  // of the transverse inertia: SDF takes no zero
  return Vector3(transverse, transverse, spins && axial > 0.0 ? axial : slim * transverse)
      .asDiagonal();
}

/// Case, slider, rod. The slider parts the slide from the hinges: SDF joins links one to one.
std::string sdf_leg(const Machine& machine, const Mechanism& all, std::size_t i) {
  const auto& leg = machine.legs[i];
  const auto& m = all.legs[i];
  const bool spins = machine.flexible_axes == model::FlexibleAxes::gimbal;
  const std::string name = fmt::format("leg{}", i + 1), tube = name + "_case", rod = name + "_rod",
                    piston = name + "_piston";
  std::string out = fmt::format("<link name='{}'>\n", tube) +
                    sdf_pose("__model__", leg.base_joint, m.R_BL) +
                    sdf_inertial(leg.cylinder_case.mass, {0.0, 0.0, leg.cylinder_case.mass_center},
                                 axisymmetric(leg.cylinder_case.transverse_inertia,
                                              leg.cylinder_case.axial_inertia, spins)) +
                    sdf_visual("case", 0.0, m.sleeve, m.case_radius) + "</link>\n";
  const bool tilts = all.kind != dynamics::ModelKind::rigid;
  constexpr double share = 1e-6;  // of the rod, for the piston link
  const double piston_mass = tilts ? share * leg.rod.mass : 0.0;
  if (tilts)
    out += fmt::format("<link name='{}'>\n", piston) + sdf_pose(tube, m.p_LR, Matrix3::Identity()) +
           sdf_inertial(piston_mass, Vector3::Zero(),
                        share * leg.rod.transverse_inertia * Matrix3::Identity()) +
           "</link>\n";
  out += fmt::format("<link name='{}'>\n", rod) + sdf_pose(tube, m.p_LR, m.R_LR) +
         sdf_inertial(leg.rod.mass - piston_mass, {0.0, 0.0, leg.rod.mass_center},
                      axisymmetric(leg.rod.transverse_inertia, leg.rod.axial_inertia, spins)) +
         sdf_visual("rod", 0.0, m.rod_end, m.rod_radius) + "</link>\n";
  out += sdf_joint(name + "_base", "universal", "world", tube,
                   sdf_axis("axis", "__model__", m.R_BL * m.base_axis, {}) +
                       sdf_axis("axis2", tube, Vector3::UnitY(), {}));
  const auto springs = single_springs(m);
  out += sdf_joint(name + "_s", "prismatic", tube, tilts ? piston : rod,
                   sdf_axis("axis", tube, Vector3::UnitZ(), springs.slide));
  if (tilts)
    out += sdf_joint(name + "_tilt", "universal", piston, rod,
                     sdf_axis("axis", piston, m.R_LR * m.piston_axis, springs.tilt[0]) +
                         sdf_axis("axis2", rod, Vector3::UnitY(), springs.tilt[1]));
  return out + fmt::format(
                   "<joint name='{}_platform' type='ball'><pose relative_to='{}'>0 0 {:.17g} 0 0 0"
                   "</pose><parent>platform</parent><child>{}</child></joint>\n",
                   name, rod, m.rod_end, rod);
}

}  // namespace

std::string sdf_text(const Machine& machine, const Mechanism& all) {
  double radius = 0.0;
  for (const auto& leg : machine.legs) radius = std::max(radius, leg.platform_joint.norm());
  std::string out = fmt::format(
      "<?xml version='1.0'?>\n<!-- hydrapod export -->\n<sdf version='1.9'>\n<world "
      "name='world_of_{0}'>\n"
      "<gravity>{1}</gravity>\n<model name='hexapod'>\n<link name='platform'>\n{2}{3}"
      "<visual name='plate'><pose>0 0 {4:.6g} 0 0 0</pose><geometry><cylinder><radius>{5:.6g}"
      "</radius><length>{6:.6g}</length></cylinder></geometry></visual>\n</link>\n",
      "hexapod", vector_text(machine.gravity), sdf_pose("__model__", all.X_BP.p_BP, all.X_BP.R_BP),
      sdf_inertial(machine.platform.mass, machine.platform.mass_center, machine.platform.inertia),
      0.5 * all.plate, radius, all.plate);
  for (std::size_t i = 0; i < model::leg_count; ++i) out += sdf_leg(machine, all, i);
  return out + "</model>\n</world>\n</sdf>\n";
}

}  // namespace hydrapod::exchange
