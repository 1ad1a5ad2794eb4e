#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mechanism.hpp"

namespace hydrapod::exchange {

namespace {

/// The least that MuJoCo takes: bodies of the model with transverse axes do not spin, and a leg may
/// have its mass in one of its parts.
constexpr double least_inertia = 1e-13, least_mass = 1e-12;

std::string mjcf_inertial(double mass, double center, double transverse, double axial) {
  return fmt::format(
      "<inertial pos='0 0 {:.17g}' mass='{:.17g}' diaginertia='{:.17g} {:.17g} {:.17g}'/>\n",
      center, std::max(mass, least_mass), std::max(transverse, least_inertia),
      std::max(transverse, least_inertia), std::max(axial, least_inertia));
}

/// V = f q + ½ k q²: MuJoCo's spring pulls towards springref.
std::string mjcf_joint(const std::string& name, const char* type, const Vector3& axis,
                       const Spring& spring, double armature = 0.0) {
  const double reference = spring.stiffness != 0.0 ? -spring.rest_force / spring.stiffness : 0.0;
  return fmt::format(
      "<joint name='{}' type='{}' axis='{}' stiffness='{:.17g}' springref='{:.17g}' "
      "damping='{:.17g}' armature='{:.17g}'/>\n",
      name, type, vector_text(axis), spring.stiffness, reference, spring.damping, armature);
}

std::string mjcf_cylinder(double from, double to, double radius, const char* material) {
  return fmt::format(
      "<geom type='cylinder' fromto='0 0 {:.6g} 0 0 {:.6g}' size='{:.6g}' material='{}'/>\n", from,
      to, radius, material);
}

std::string mjcf_leg(const Machine& machine, const Mechanism& all, std::size_t i) {
  const auto& leg = machine.legs[i];
  const auto& m = all.legs[i];
  const std::string name = fmt::format("leg{}", i + 1);
  std::string out = fmt::format("<body name='{}.case' pos='{}' quat='{}'>\n", name,
                                vector_text(leg.base_joint), quaternion_text(m.R_BL));
  out += mjcf_joint(name + ".base1", "hinge", m.base_axis, {}, m.cross_inertia) +
         mjcf_joint(name + ".base2", "hinge", Vector3::UnitY(), {});
  const bool spins = machine.flexible_axes == model::FlexibleAxes::gimbal;
  const auto& tube = leg.cylinder_case;
  out += mjcf_inertial(tube.mass, tube.mass_center, tube.transverse_inertia,
                       spins ? tube.axial_inertia : 0.0);
  out += mjcf_cylinder(0.0, m.sleeve, m.case_radius, "case");
  out += fmt::format("<geom type='sphere' size='{:.6g}' material='joint'/>\n", 1.1 * m.case_radius);
  out += fmt::format("<body name='{}.rod' pos='{}' quat='{}'>\n", name, vector_text(m.p_LR),
                     quaternion_text(m.R_LR));
  const Matrix3 to_rod = m.R_LR.transpose();  // axes of the case in the rod
  out += mjcf_joint(name + ".s", "slide", to_rod.col(2), m.oil, m.axial_added);
  if (all.kind == dynamics::ModelKind::full)
    out += mjcf_joint(name + ".u1", "slide", to_rod.col(0), m.offset[0]) +
           mjcf_joint(name + ".u2", "slide", to_rod.col(1), m.offset[1]);
  if (all.kind != dynamics::ModelKind::rigid)
    out += mjcf_joint(name + ".tilt1", "hinge", m.piston_axis, m.tilt[0]) +
           mjcf_joint(name + ".tilt2", "hinge", Vector3::UnitY(), m.tilt[1]);
  const auto& rod = leg.rod;
  out += mjcf_inertial(rod.mass, rod.mass_center, rod.transverse_inertia,
                       spins ? rod.axial_inertia : 0.0);
  out += mjcf_cylinder(0.0, m.rod_end, m.rod_radius, "rod") +
         fmt::format("<geom type='sphere' pos='0 0 {:.6g}' size='{:.6g}' material='joint'/>\n",
                     m.rod_end, 1.5 * m.rod_radius);
  return out + "</body>\n</body>\n";
}

/// The plate between the joints, as points whose hull is drawn.
std::string mjcf_plate(const Machine& machine, double thickness) {
  std::string points;
  for (const auto& leg : machine.legs)
    for (const double z : {0.0, thickness})
      points += vector_text(leg.platform_joint + Vector3(0.0, 0.0, z)) + " ";
  return fmt::format("<mesh name='plate' vertex='{}'/>\n", points);
}

std::string mjcf_tendons(const Mechanism& all) {
  constexpr std::array joints{"s", "tilt1", "tilt2", "u1", "u2"};
  const std::size_t count = all.kind == dynamics::ModelKind::full ? 5 : 3;
  std::string out;
  for (std::size_t i = 0; i < model::leg_count; ++i)
    for (std::size_t k = 0; k < all.legs[i].coupled.size(); ++k) {
      auto [along, spring] = all.legs[i].coupled[k];
      double length = spring.stiffness != 0.0 ? -spring.rest_force / spring.stiffness : 0.0;
      if (length < 0.0) {  // MuJoCo wants lengths that are not negative
        length = -length;
        along = -along;
      }
      out += fmt::format(
          "<fixed name='leg{}.seal{}' stiffness='{:.17g}' damping='{:.17g}' "
          "springlength='{:.17g}'>",
          i + 1, k + 1, spring.stiffness, spring.damping, length);
      for (std::size_t j = 0; j < count; ++j)
        if (along[static_cast<Eigen::Index>(j)] != 0.0)
          out += fmt::format("<joint joint='leg{}.{}' coef='{:.17g}'/>", i + 1, joints[j],
                             along[static_cast<Eigen::Index>(j)]);
      out += "</fixed>\n";
    }
  return out.empty() ? out : "<tendon>\n" + out + "</tendon>\n";
}

std::string mjcf_actuators() {
  std::string motors, sensors;
  for (int i = 1; i <= model::leg_count; ++i) {
    motors += fmt::format("<motor name='leg{0}.force' joint='leg{0}.s'/>\n", i);
    sensors += fmt::format("<jointpos name='leg{0}.stroke' joint='leg{0}.s'/>\n", i);
  }
  return "<actuator>\n" + motors + "</actuator>\n<sensor>\n" +
         "<framepos name='platform.position' objtype='xbody' objname='platform'/>\n"
         "<framequat name='platform.orientation' objtype='xbody' objname='platform'/>\n" +
         sensors + "</sensor>\n";
}

/// Struts are tendons between two sites: springs and dampers without mass.
std::string mjcf_struts(const Machine& machine, const Mechanism& all) {
  std::string tendons, motors, sensors;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const auto& spring = all.legs[i].oil;
    const double length = (all.X_BP * leg.platform_joint - leg.base_joint).norm();
    tendons += fmt::format(
        "<spatial name='leg{0}' stiffness='{1:.17g}' damping='{2:.17g}' springlength='{3:.17g}'>"
        "<site site='leg{0}.base'/><site site='leg{0}.joint'/></spatial>\n",
        i + 1, spring.stiffness, spring.damping, length - spring.rest_force / spring.stiffness);
    motors += fmt::format("<motor name='leg{0}.force' tendon='leg{0}'/>\n", i + 1);
    sensors += fmt::format("<tendonpos name='leg{0}.length' tendon='leg{0}'/>\n", i + 1);
  }
  return "<tendon>\n" + tendons + "</tendon>\n<actuator>\n" + motors +
         "</actuator>\n<sensor>\n"
         "<framepos name='platform.position' objtype='xbody' objname='platform'/>\n"
         "<framequat name='platform.orientation' objtype='xbody' objname='platform'/>\n" +
         sensors + "</sensor>\n";
}

std::string mjcf_sites(const Machine& machine, const char* end, Vector3 model::Leg::*joint) {
  std::string sites;
  for (std::size_t i = 0; i < model::leg_count; ++i)
    sites += fmt::format("<site name='leg{}.{}' pos='{}'/>\n", i + 1, end,
                         vector_text(machine.legs[i].*joint));
  return sites;
}

/// 1/80 of the fastest mode's radian, and less where the loops would yield too much. A constraint
/// with the time constant 2 h and the impedance 1 − 1e-4 acts as a spring m / (1e-4 (2 h)²) in
/// series with the oil spring k, m being the mass of the rod that moves along the leg. It lowers ω
/// by the share ½ 1e-4 (2 h)² k/m, which over a second is a lag of ω times that, here at most 3e-5.
double mjcf_step(const Machine& machine, const Mechanism& all) {
  constexpr double lag = 3e-5, softness = 1e-4;
  double stiffest = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const double mass = machine.legs[i].rod.mass + all.legs[i].axial_added;
    if (mass > 0.0) stiffest = std::max(stiffest, all.legs[i].oil.stiffness / mass);
  }
  const double yielding = 2.0 * softness * all.highest_platform * stiffest;
  return std::min({2.5e-4, 0.0125 / all.highest, std::sqrt(lag / yielding)});
}

}  // namespace

std::string mjcf_text(const Machine& machine, const Mechanism& all) {
  const double step = mjcf_step(machine, all);
  const auto inertia = principal(machine.platform.inertia);
  const bool struts = model::leg_type(machine) == model::LegType::strut;
  std::string out = fmt::format(
      "<mujoco model='{}'>\n"
      "<!-- hydrapod export: SI units; every joint is 0 at rest; motors are forces of the {} on "
      "top of their springs -->\n"
      "<compiler angle='radian' balanceinertia='false' boundmass='0' boundinertia='0' "
      "fitaabb='false'/>\n"
      "<option gravity='{}' timestep='{:.6g}' integrator='RK4' solver='Newton' "
      "tolerance='1e-14' iterations='100'/>\n"
      "<default><geom contype='0' conaffinity='0' group='1'/>\n"
      "<equality solref='{:.6g} 1' solimp='0.9999 0.9999 0.001 0.5 2'/></default>\n"
      "<asset>\n<material name='platform' rgba='0.25 0.45 0.7 1'/>\n"
      "<material name='case' rgba='0.35 0.37 0.4 1'/>\n<material name='rod' rgba='0.8 0.82 0.85 "
      "1'/>\n"
      "<material name='joint' rgba='0.2 0.2 0.22 1'/>\n{}</asset>\n",
      xml_text(all.name),
      model::leg_type(machine) == model::LegType::cylinder
          ? "oil columns"
          : model::axial_part(model::leg_type(machine)),
      vector_text(machine.gravity), step, 2.0 * step, mjcf_plate(machine, all.plate));
  out += fmt::format(
      "<worldbody>\n<light pos='0 0 {:.3g}'/>\n"
      "<body name='platform' pos='{}' quat='{}'>\n<freejoint name='platform'/>\n"
      "<inertial pos='{}' quat='{}' mass='{:.17g}' diaginertia='{}'/>\n"
      "<geom type='mesh' mesh='plate' material='platform'/>\n{}</body>\n",
      3.0 * all.X_BP.p_BP.norm(), vector_text(all.X_BP.p_BP), quaternion_text(all.X_BP.R_BP),
      vector_text(machine.platform.mass_center), quaternion_text(inertia.axes),
      machine.platform.mass, vector_text(inertia.moments),
      struts ? mjcf_sites(machine, "joint", &model::Leg::platform_joint) : "");
  if (struts)
    return out + mjcf_sites(machine, "base", &model::Leg::base_joint) + "</worldbody>\n" +
           mjcf_struts(machine, all) + "</mujoco>\n";
  for (std::size_t i = 0; i < model::leg_count; ++i) out += mjcf_leg(machine, all, i);
  out += "</worldbody>\n<equality>\n";
  for (std::size_t i = 0; i < model::leg_count; ++i)
    out += fmt::format(
        "<connect name='leg{0}' body1='leg{0}.rod' body2='platform' anchor='0 0 {1:.17g}'/>\n",
        i + 1, all.legs[i].rod_end);
  return out + "</equality>\n" + mjcf_tendons(all) + mjcf_actuators() + "</mujoco>\n";
}

}  // namespace hydrapod::exchange
