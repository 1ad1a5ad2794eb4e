#include "machine_reader.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "control_reader.hpp"
#include "hydraulics_reader.hpp"
#include "section.hpp"

namespace hydrapod::model {

namespace {

constexpr std::size_t most_poses = 1000;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

JointPoints unread_points() {
  JointPoints points;
  points.fill(Vector3::Constant(nan));
  return points;
}

/// Gravity as a magnitude along −z, or as a vector.
Vector3 read_gravity(const Section& environment) {
  const auto value = environment.find("gravity");
  if (!value) return {0.0, 0.0, -standard_gravity};
  if (value.node->kind == Node::Kind::array) return environment.read_vector(value, "m/s^2");
  const double magnitude = environment.read_number(value, "m/s^2");
  if (magnitude < 0.0) {
    environment.report(value, fmt::format("is {} m/s^2, expected a magnitude of 0 or more (it "
                                          "points along -z), or an array [gx, gy, gz]",
                                          magnitude));
  }
  return {0.0, 0.0, 0.0 - magnitude};
}

std::optional<JointCircle> read_circle(const Section& joints) {
  const Section table = joints.required_table("circle");
  const JointCircle circle{table.number("radius", "m"), table.number("spacing", "m")};
  if (circle.radius <= 0.0) {
    table.report(table.find("radius"),
                 fmt::format("is {} m, expected a radius above 0", circle.radius));
    return std::nullopt;
  }
  if (circle.spacing <= 0.0 || circle.spacing >= 2.0 * circle.radius) {
    table.report(table.find("spacing"),
                 fmt::format("is {} m, expected more than 0 and less than the circle's diameter, "
                             "{} m",
                             circle.spacing, 2.0 * circle.radius));
    return std::nullopt;
  }
  return circle;
}

JointPoints read_points(const Section& joints) {
  JointPoints points = unread_points();
  const auto rows = joints.elements(joints.find("points"), leg_count,
                                    "an array of 6 points, each [x, y, z] in m");
  for (std::size_t i = 0; i < rows.size(); ++i) points[i] = joints.read_vector(rows[i], "m");
  return points;
}

/// Joints that every leg shares a table for; legs may still give their own.
JointPoints read_joints(const Section& owner, JointPoints (*on_circle)(const JointCircle&)) {
  const Section joints = owner.optional_table("joints");
  const auto how = joints.choice("circle", "points");
  if (how == "points") return read_points(joints);
  if (how == "circle") {
    const auto circle = read_circle(joints);
    if (circle) return on_circle(*circle);
  }
  return unread_points();
}

/// Reports the legs that have a joint neither from the shared table nor from their own.
void require_joints(const Section& root, std::string_view owner, std::string_view own_key,
                    const std::vector<int>& legs_without) {
  if (legs_without.empty()) return;
  const Section table = root.optional_table(owner);
  const Section joints = table.optional_table("joints");
  if (!joints.choice("circle", "points").empty()) return;  // there, but not readable
  std::string legs = "every leg";
  if (legs_without.size() < leg_count) {
    legs = fmt::format("leg {}", fmt::join(legs_without, ", "));
  }
  const std::string what = fmt::format(
      "`circle = {{ radius, spacing }}` or `points = [[x, y, z] of six legs]` (or `{}` of {})",
      own_key, legs);
  if (joints.exists()) return joints.report_missing("circle", what);
  if (table.exists()) return table.report_missing("joints", "required table with " + what);
  root.report_missing(owner, fmt::format("required table [{}]", owner));
}

Matrix3 read_inertia_matrix(const Section& platform, const Section::Value& value) {
  Matrix3 inertia = Matrix3::Constant(nan);
  const auto rows = platform.elements(
      value, 3, "three rows of three numbers in kg m^2, or { xx, yy, zz, xy, xz, yz }");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    inertia.row(static_cast<Eigen::Index>(i)) = platform.read_vector(rows[i], "kg m^2").transpose();
  }
  return inertia;
}

Matrix3 read_inertia(const Section& platform) {
  const auto value = platform.find("inertia");
  if (value && !value.node->is_table()) return read_inertia_matrix(platform, value);
  if (!value) {
    platform.report_missing("inertia",
                            "required value ({ xx, yy, zz, xy, xz, yz }, or three rows of three "
                            "numbers in kg m^2)");
    return Matrix3::Constant(nan);
  }
  const Section table = platform.required_table("inertia");
  const auto moment = [&](std::string_view key) { return table.number(key, "kg m^2"); };
  const auto product = [&](std::string_view key) { return table.number(key, "kg m^2", 0.0); };
  const double xy = product("xy");
  const double xz = product("xz");
  const double yz = product("yz");
  Matrix3 inertia;
  inertia << moment("xx"), xy, xz, xy, moment("yy"), yz, xz, yz, moment("zz");
  return inertia;
}

Platform read_platform(const Section& root) {
  const Section table = root.required_table("platform");
  return {table.number("mass", "kg"), table.vector("mass_center", "m"), read_inertia(table)};
}

CylinderCase read_case(const Section& leg) {
  const Section table = leg.required_table("case");
  return {table.number("mass", "kg"), table.number("mass_center", "m"),
          table.number("transverse_inertia", "kg m^2"),
          table.number("axial_inertia", "kg m^2", 0.0)};
}

Rod read_rod(const Section& leg) {
  const Section table = leg.required_table("rod");
  return {table.number("length", "m"), table.number("mass", "kg"), table.number("mass_center", "m"),
          table.number("transverse_inertia", "kg m^2"),
          table.number("axial_inertia", "kg m^2", 0.0)};
}

GuideSleeve read_guide_sleeve(const Section& leg) {
  const Section table = leg.required_table("guide_sleeve");
  return {table.number("position", "m"), table.number("stiffness", "N/m"),
          table.number("damping", "N s/m", 0.0)};
}

std::optional<PistonRing> read_piston_ring(const Section& leg) {
  const Section table = leg.optional_table("piston_ring");
  if (!table.exists()) return std::nullopt;
  return PistonRing{table.number("stiffness", "N/m"), table.number("damping", "N s/m", 0.0)};
}

std::optional<EntrainedAir> read_air(const Section& cylinder) {
  const Section table = cylinder.optional_table("air");
  if (!table.exists()) return std::nullopt;
  return EntrainedAir{table.number("fraction", "1"), table.number("pressure", "Pa"),
                      table.number("polytropic", "1", EntrainedAir{}.polytropic)};
}

Cylinder read_cylinder(const Section& oil_spring) {
  const Section table = oil_spring.required_table("cylinder");
  Cylinder cylinder;
  cylinder.bore = table.number("bore", "m");
  cylinder.rod_diameter = table.number("rod_diameter", "m");
  cylinder.cap_dead_volume = table.number("cap_dead_volume", "m^3", 0.0);
  cylinder.rod_dead_volume = table.number("rod_dead_volume", "m^3", 0.0);
  cylinder.cap_line_volume = table.number("cap_line_volume", "m^3", 0.0);
  cylinder.rod_line_volume = table.number("rod_line_volume", "m^3", 0.0);
  cylinder.bulk_modulus = table.number("bulk_modulus", "Pa");
  cylinder.air = read_air(table);
  constexpr std::string_view rules[]{"chambers", "equal"};
  cylinder.volumes = table.word("volumes", rules) == 0 ? VolumeRule::chambers : VolumeRule::equal;
  cylinder.control_volume = table.optional_number("control_volume", "m^3");
  return cylinder;
}

OilSpring read_oil_spring(const Section& leg) {
  const Section table = leg.required_table("oil_spring");
  OilSpring spring;
  spring.damping = table.number("damping", "N s/m", 0.0);
  const auto how = table.choice("stiffness", "cylinder");
  if (how == "cylinder") {
    spring.cylinder = read_cylinder(table);
  } else if (how == "stiffness") {
    spring.stiffness = table.number("stiffness", "N/m");
  } else {
    table.report_missing("stiffness", "either this value or the table `cylinder`");
    spring.stiffness = nan;
  }
  return spring;
}

std::optional<Stroke> read_stroke(const Section& leg) {
  const Section table = leg.optional_table("stroke");
  if (!table.exists()) return std::nullopt;
  return Stroke{table.number("retracted", "m"), table.number("length", "m")};
}

JointLimits read_joint_limits(const Section& leg) {
  const Section table = leg.optional_table("joint_limits");
  return {table.optional_number("base", "rad"), table.optional_number("platform", "rad")};
}

/// The axis with length one; a zero axis stays zero for validate() to find.
Vector3 read_gimbal_axis(const Section& leg) {
  Vector3 axis = leg.vector("gimbal_axis", "1", Vector3::UnitY());
  const double largest = axis.cwiseAbs().maxCoeff();
  if (largest == 0.0 || !axis.allFinite()) return axis;
  return (axis / largest).normalized();
}

Leg read_leg(const Section& section) {
  Leg leg;
  leg.cylinder_case = read_case(section);
  leg.rod = read_rod(section);
  leg.guide_sleeve = read_guide_sleeve(section);
  leg.piston_ring = read_piston_ring(section);
  leg.oil_spring = read_oil_spring(section);
  leg.stroke = read_stroke(section);
  leg.joint_limits = read_joint_limits(section);
  leg.added_axial_inertia = section.number("added_axial_inertia", "kg", 0.0);
  leg.gimbal_stiffness = section.optional_number("gimbal_stiffness", "N/m");
  leg.gimbal_axis = read_gimbal_axis(section);
  leg.hydraulics = read_leg_hydraulics(section);
  return leg;
}

void read_legs(const Section& root, Machine& machine) {
  const JointPoints base = read_joints(root.optional_table("base"), base_joint_points);
  const JointPoints platform = read_joints(root.optional_table("platform"), platform_joint_points);
  const Section all_legs = root.optional_table("legs");
  const Section single_legs = root.optional_table("leg");
  std::vector<int> without_base;
  std::vector<int> without_platform;
  for (std::size_t i = 0; i < leg_count; ++i) {
    const int number = static_cast<int>(i) + 1;
    const Section own = single_legs.optional_table(std::to_string(number));
    if (!own.exists() && !all_legs.exists()) {
      machine.legs[i] = read_leg(root.required_table("legs"));
    } else {
      machine.legs[i] = read_leg(Section::overlaid(own, all_legs));
    }
    if (!own.has("base_joint") && !base[i].allFinite()) without_base.push_back(number);
    if (!own.has("platform_joint") && !platform[i].allFinite()) without_platform.push_back(number);
    machine.legs[i].base_joint = own.vector("base_joint", "m", base[i]);
    machine.legs[i].platform_joint = own.vector("platform_joint", "m", platform[i]);
  }
  require_joints(root, "base", "base_joint", without_base);
  require_joints(root, "platform", "platform_joint", without_platform);
}

std::optional<BaseMount> read_base_mount(const Section& base) {
  const Section table = base.optional_table("mount");
  if (!table.exists()) return std::nullopt;
  BaseMount mount;
  const Section stiffness = table.required_table("stiffness");
  constexpr std::array directions{"x", "y", "z", "rx", "ry", "rz"};
  for (std::size_t k = 0; k < directions.size(); ++k)
    mount.stiffness[k] = stiffness.optional_number(directions[k], k < 3 ? "N/m" : "N m/rad");
  mount.mass = table.number("mass", "kg", 0.0);
  mount.inertia = table.vector("inertia", "kg m^2", Vector3::Zero());
  return mount;
}

Pose read_pose(const Section& pose) {
  const Vector3 rpy = pose.vector("rotation", "rad", Vector3::Zero());
  return {spatial::rotation_from_rpy(rpy), pose.vector("position", "m")};
}

std::vector<NamedPose> read_poses(const Section& root, const Node& tree) {
  const Section table = root.required_table("poses");
  std::vector<NamedPose> poses{{"neutral", read_pose(table.required_table("neutral"))}};
  const Node* node = tree.find("poses");
  if (node == nullptr || !node->is_table()) return poses;
  if (node->children.size() > most_poses) {
    root.report(root.find("poses"), fmt::format("holds {} poses, expected no more than {}",
                                                node->children.size(), most_poses));
    return poses;
  }
  for (const auto& child : node->children) {
    if (child.key == "neutral" || !child.is_table()) continue;
    poses.push_back({child.key, read_pose(table.optional_table(child.key))});
  }
  return poses;
}

Damping read_damping(const Section& root) {
  const Section table = root.optional_table("damping");
  return {table.optional_number("modal_ratio", "1"), table.number("rayleigh_mass", "1/s", 0.0),
          table.number("rayleigh_stiffness", "s", 0.0)};
}

}  // namespace

Machine read_machine(const Node& tree, Faults& faults) {
  const Section root(tree, faults);
  Machine machine;
  machine.name = root.text("name");
  machine.description = root.optional_text("description");
  machine.source = root.optional_text("source");
  machine.gravity = read_gravity(root.optional_table("environment"));
  machine.platform = read_platform(root);
  read_legs(root, machine);
  machine.base_mount = read_base_mount(root.optional_table("base"));
  constexpr std::string_view axes[]{"transverse", "gimbal"};
  machine.flexible_axes = root.optional_table("model").word("flexible_axes", axes) == 0
                              ? FlexibleAxes::transverse
                              : FlexibleAxes::gimbal;
  machine.damping = read_damping(root);
  machine.hydraulics = read_hydraulics(root);
  machine.controller = read_controller(root);
  machine.sensors = read_sensors(root);
  machine.poses = read_poses(root, tree);
  return machine;
}

}  // namespace hydrapod::model
