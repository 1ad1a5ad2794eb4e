#include <fmt/format.h>

#include <algorithm>

#include "mechanism.hpp"

namespace hydrapod::exchange {

namespace {

std::string urdf_inertial(double mass, const Vector3& center, const Matrix3& inertia) {
  return fmt::format(
      "<inertial><origin xyz=\"{}\"/><mass value=\"{:.17g}\"/><inertia ixx=\"{:.17g}\" "
      "ixy=\"{:.17g}\" ixz=\"{:.17g}\" iyy=\"{:.17g}\" iyz=\"{:.17g}\" "
      "izz=\"{:.17g}\"/></inertial>\n",
      vector_text(center), mass, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
      inertia(1, 2), inertia(2, 2));
}

std::string urdf_cylinder(double from, double to, double radius) {
  return fmt::format(
      "<visual><origin xyz=\"0 0 {:.6g}\"/><geometry><cylinder radius=\"{:.6g}\" "
      "length=\"{:.6g}\"/></geometry></visual>\n",
      0.5 * (from + to), radius, to - from);
}

std::string urdf_link(const std::string& name, const std::string& content) {
  return fmt::format("<link name=\"{}\">\n{}</link>\n", name, content);
}

std::string urdf_joint(const std::string& name, const char* type, const std::string& parent,
                       const std::string& child, const Vector3& p, const Matrix3& R,
                       const std::string& more) {
  return fmt::format(
      "<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>"
      "<origin xyz=\"{}\" rpy=\"{}\"/>{}</joint>\n",
      name, type, parent, child, vector_text(p), rpy_text(R), more);
}

std::string urdf_axis(const Vector3& axis, double damping) {
  return fmt::format("<axis xyz=\"{}\"/><dynamics damping=\"{:.17g}\"/>", vector_text(axis),
                     damping);
}

/// Of the slide from rest [m]; as far as the leg is long where the file gives no stroke.
std::pair<double, double> urdf_travel(const model::Leg& leg, double l_m) {
  if (!leg.stroke) return {-l_m, leg.rod.length};
  return {leg.stroke->retracted - l_m, leg.stroke->retracted + leg.stroke->length - l_m};
}

std::string urdf_leg(const Machine& machine, const Mechanism& all, std::size_t i) {
  const auto& leg = machine.legs[i];
  const auto& m = all.legs[i];
  const std::string name = fmt::format("leg{}", i + 1);
  const Matrix3 one = Matrix3::Identity();
  const auto& tube = leg.cylinder_case;
  const auto moments = [](double across, double along) -> Matrix3 {
    return Vector3(across, across, along).asDiagonal();
  };
  std::string out =
      urdf_link(name + "_cross", "") +
      urdf_link(name + "_case",
                urdf_inertial(tube.mass, {0.0, 0.0, tube.mass_center},
                              moments(tube.transverse_inertia, tube.axial_inertia)) +
                    urdf_cylinder(0.0, m.sleeve, m.case_radius)) +
      urdf_link(name + "_rod",
                urdf_inertial(leg.rod.mass, {0.0, 0.0, leg.rod.mass_center},
                              moments(leg.rod.transverse_inertia, leg.rod.axial_inertia)) +
                    urdf_cylinder(0.0, m.rod_end, m.rod_radius));
  out += urdf_joint(name + "_base1", "continuous", "base", name + "_cross", leg.base_joint, m.R_BL,
                    urdf_axis(m.base_axis, 0.0)) +
         urdf_joint(name + "_base2", "continuous", name + "_cross", name + "_case", Vector3::Zero(),
                    one, urdf_axis(Vector3::UnitY(), 0.0));
  const auto [lower, upper] = urdf_travel(leg, m.p_LR.z());
  const auto springs = single_springs(m);
  const std::string slide =
      urdf_axis(Vector3::UnitZ(), springs.slide.damping) +
      fmt::format("<limit lower=\"{:.17g}\" upper=\"{:.17g}\" effort=\"1e9\" velocity=\"1e3\"/>",
                  lower, upper);
  if (all.kind == dynamics::ModelKind::rigid)
    return out + urdf_joint(name + "_s", "prismatic", name + "_case", name + "_rod", m.p_LR, m.R_LR,
                            slide);
  out += urdf_link(name + "_piston", "") + urdf_link(name + "_tilt", "");
  out += urdf_joint(name + "_s", "prismatic", name + "_case", name + "_piston", m.p_LR, one, slide);
  return out +
         urdf_joint(name + "_tilt1", "continuous", name + "_piston", name + "_tilt",
                    Vector3::Zero(), m.R_LR, urdf_axis(m.piston_axis, springs.tilt[0].damping)) +
         urdf_joint(name + "_tilt2", "continuous", name + "_tilt", name + "_rod", Vector3::Zero(),
                    one, urdf_axis(Vector3::UnitY(), springs.tilt[1].damping));
}

}  // namespace

std::string urdf_text(const Machine& machine, const Mechanism& all) {
  double radius = 0.0;
  for (const auto& leg : machine.legs) radius = std::max(radius, leg.platform_joint.norm());
  std::string out = "<?xml version=\"1.0\"?>\n<!-- hydrapod export -->\n<robot name=\"hexapod\">\n";
  out += urdf_link("base", "");
  out += urdf_link("platform", urdf_inertial(machine.platform.mass, machine.platform.mass_center,
                                             machine.platform.inertia) +
                                   urdf_cylinder(0.0, all.plate, radius));
  out += urdf_joint("platform_motion", "floating", "base", "platform", all.X_BP.p_BP, all.X_BP.R_BP,
                    "");
  for (std::size_t i = 0; i < model::leg_count; ++i) out += urdf_leg(machine, all, i);
  return out + "</robot>\n";
}

std::string closures_json(const Machine& machine, const Mechanism& all) {
  using Json = nlohmann::ordered_json;
  const auto vector = [](const Vector3& v) { return Json{v.x(), v.y(), v.z()}; };
  Json closures = Json::array(), springs = Json::array();
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& m = all.legs[i];
    const std::string name = fmt::format("leg{}", i + 1);
    closures.push_back({{"kind", "ball"},
                        {"link_1", name + "_rod"},
                        {"point_1", vector({0.0, 0.0, m.rod_end})},
                        {"link_2", "platform"},
                        {"point_2", vector(machine.legs[i].platform_joint)}});
    const auto add = [&](const std::string& joint, const Spring& spring) {
      springs.push_back(
          {{"joint", joint}, {"stiffness", spring.stiffness}, {"rest_force", -spring.rest_force}});
    };
    const auto [slide, tilt] = single_springs(m);
    add(name + "_s", slide);
    if (all.kind == dynamics::ModelKind::rigid) continue;
    add(name + "_tilt1", tilt[0]);
    add(name + "_tilt2", tilt[1]);
  }
  return Json{{"kind", "closures"},
              {"gravity_m_s2", vector(machine.gravity)},
              {"closures", closures},
              {"springs", springs}}
             .dump(1) +
         "\n";
}

}  // namespace hydrapod::exchange
