// Rows of the machine file: base and platform, gravity, damping, poses.
#include "parameter_rows.hpp"

namespace hydrapod::model::rows {

namespace {

/// Gravity as a magnitude along −z, or as a vector.
double gravity(const Machine& machine, int, int element) {
  return element == whole ? 0.0 - machine.gravity.z() : machine.gravity[element];
}
void set_gravity(Machine& machine, int, int element, double value) {
  if (element == whole) {
    machine.gravity = {0.0, 0.0, 0.0 - value};
  } else {
    machine.gravity[element] = value;
  }
}

constexpr ParameterRow of_gravity(ParameterRow made) {
  made.in_code = true;
  made.get = gravity;
  made.set = set_gravity;
  return made;
}

/// xx, yy, zz, xy, xz, yz, above the diagonal and below it.
constexpr int tensor_row[]{0, 1, 2, 0, 0, 1};
constexpr int tensor_column[]{0, 1, 2, 1, 2, 2};

double* inertia(Machine& machine, int, int element) {
  return &machine.platform.inertia(tensor_row[element], tensor_column[element]);
}
void set_inertia(Machine& machine, int, int element, double value) {
  *inertia(machine, 0, element) = value;
  machine.platform.inertia(tensor_column[element], tensor_row[element]) = value;
}

constexpr ParameterRow tensor(std::string_view path, std::string_view unit,
                              std::string_view meaning, Example example) {
  auto made = row(Kind::tensor, path, unit, required, {}, meaning, example);
  made.in_code = true;
  made.numbers = 6;
  made.find = made.make = inertia;
  made.set = set_inertia;
  return made;
}

/// The joints of those legs again on the circle.
template <std::optional<JointCircle> Machine::*circle, Vector3 Leg::*joint,
          JointPoints (*on_circle)(const JointCircle&)>
void lay_out(Machine& machine, unsigned legs) {
  if (!(machine.*circle)) return;
  const auto points = on_circle(*(machine.*circle));
  for (std::size_t i = 0; i < leg_count; ++i)
    if ((legs >> i & 1U) != 0) machine.legs[i].*joint = points[i];
}

constexpr auto on_base_circle = lay_out<&Machine::base_circle, &Leg::base_joint, base_joint_points>;
constexpr auto on_platform_circle =
    lay_out<&Machine::platform_circle, &Leg::platform_joint, platform_joint_points>;

/// Radius or spacing of a circle, on which `lay` puts the joints.
template <auto circle, auto length>
constexpr ParameterRow of_circle(void (*lay)(Machine&, unsigned), std::string_view path,
                                 Bound bound, std::string_view meaning, Example example) {
  auto made = in_code(
      number<circle, length>(path, "m", required, usual(1e-3, 50.0, bound), meaning, example));
  made.finish = lay;
  return made;
}

constexpr ParameterRow points(std::string_view path, std::string_view meaning) {
  auto made = row(Kind::points, path, "m", optional, {}, meaning, {});
  made.in_code = true;
  made.numbers = 0;
  return made;
}

/// Angles about x, y, z of a pose.
double rotation(const Machine& machine, int pose, int element) {
  return spatial::rpy_from_rotation(
      machine.poses.at(static_cast<std::size_t>(pose)).X_BP.R_BP)[element];
}
void set_rotation(Machine& machine, int pose, int element, double value) {
  auto& R_BP = machine.poses.at(static_cast<std::size_t>(pose)).X_BP.R_BP;
  Vector3 rpy = spatial::rpy_from_rotation(R_BP);
  rpy[element] = value;
  R_BP = spatial::rotation_from_rpy(rpy);
}

constexpr ParameterRow of_rotation(ParameterRow made) {
  made.find = made.make = nullptr;
  made.get = rotation;
  made.set = set_rotation;
  return in_code(made);
}

/// A spring of the mount, which is rigid where there is none.
template <int direction>
constexpr ParameterRow spring(std::string_view path, std::string_view meaning,
                              std::string_view example) {
  return number<&Machine::base_mount, &BaseMount::stiffness, direction>(
      path, direction < 3 ? "N/m" : "N m/rad", otherwise("rigid"), spring_rate, meaning,
      shown(example));
}

constexpr std::string_view axes_words[]{"transverse", "gimbal"};
constexpr std::string_view oil_damping_words[]{"viscous", "chambers", "automatic"};

constexpr auto mount = &Machine::base_mount;

constexpr ParameterRow body_rows[]{
    text("name", required, "what the machine is called in tables and plots",
         given("My motion platform")),
    text("description", otherwise("empty"), "what the machine is", shown("What the machine is")),
    text("source", otherwise("empty"), "where the numbers come from",
         shown("Drawings, data sheets, measurements")),
    text("state", otherwise("nominal"),
         "state of the machine that the numbers describe; `hydrapod calibrate` writes `calibrated`",
         shown("As delivered")),
    table("environment", optional, ""),
    of_gravity(number<&Machine::gravity>(
        "environment.gravity", "m/s^2", otherwise("9.80665"), usual(1e-3, 100.0, any),
        "magnitude along -z of the base; or a vector `[gx, gy, gz]` in the base "
        "frame; 0 switches gravity off",
        shown("9.80665 m/s^2"))),
    table(
        "base.joints", optional, "",
        R"(# ---- Base ------------------------------------------------------------------------------------
# On a circle, joints stand in three pairs: `spacing` is the distance between the two of a pair, 0 on
# the side of a 6-3 or 3-3 platform where two legs share a joint.
# Base pairs stand at 60, 180 and 300 degrees, platform pairs at 0, 120 and 240 degrees; leg 1 joins
# the platform pair at 0 to the base pair at 60 degrees, and so on counter-clockwise.
# Instead of a circle: points = [[x, y, z], ...], one point for each of the legs 1 to 6, in m.
)"),
    points("base.joints.points",
           "`[[x, y, z], …]`, the joints of legs 1 to 6 in the base frame; instead of "
           "`circle`"),
    table("base.joints.circle", optional, ""),
    of_circle<&Machine::base_circle, &JointCircle::radius>(
        on_base_circle, "base.joints.circle.radius", positive,
        "of the circle on which the joints stand", given("1.1 m")),
    of_circle<&Machine::base_circle, &JointCircle::spacing>(
        on_base_circle, "base.joints.circle.spacing", not_negative,
        "between the two joints of a pair, less than the diameter; 0: both in one place",
        given("250 mm")),
    table("base.mount", optional,
          "springs between base and ground; without the table the base is fixed"),
    number<mount, &BaseMount::mass>("base.mount.mass", "kg", standard, not_negative,
                                    "of the base, at the origin of its frame"),
    number<mount, &BaseMount::inertia>(
        "base.mount.inertia", "kg m^2", standard, not_negative,
        "moments of inertia of the base about the axes of its frame"),
    table("base.mount.stiffness", required, "at the origin of the base frame"),
    spring<0>("base.mount.stiffness.x", "along x", "800 kN/mm"),
    spring<1>("base.mount.stiffness.y", "along y", "800 kN/mm"),
    spring<2>("base.mount.stiffness.z", "along z", "1500 kN/mm"),
    spring<3>("base.mount.stiffness.rx", "about x", "1500 MN m/rad"),
    spring<4>("base.mount.stiffness.ry", "about y", "1500 MN m/rad"),
    spring<5>("base.mount.stiffness.rz", "about z", "1500 MN m/rad"),
    table(
        "platform", required, "with everything that is fixed to it, payload included",
        R"(# ---- Platform with its payload ---------------------------------------------------------------
# xy, xz, yz are the elements of the inertia tensor as they stand (default 0).
)"),
    alone(number<&Machine::platform, &Platform::mass>("platform.mass", "kg", required,
                                                      usual(0.5, 2e6, positive), "more than 0",
                                                      given("1500 kg"))),
    alone(number<&Machine::platform, &Platform::mass_center>(
        "platform.mass_center", "m", required, usual(1e-4, 20.0, any),
        "`[x, y, z]` in the platform frame", given("[0, 0, \"0.2 m\"]"))),
    tensor("platform.inertia", "kg m^2",
           "tensor about the mass centre in the axes of the platform frame: `{ xx, yy, zz, "
           "xy, xz, yz }`, or three rows of three numbers",
           given("{ xx = 500, yy = 550, zz = 800 }")),
    table("platform.joints", optional, ""),
    points("platform.joints.points",
           "`[[x, y, z], …]`, the joints of legs 1 to 6 in the platform frame; instead "
           "of `circle`"),
    table("platform.joints.circle", optional, ""),
    of_circle<&Machine::platform_circle, &JointCircle::radius>(
        on_platform_circle, "platform.joints.circle.radius", positive,
        "of the circle on which the joints stand", given("0.8 m")),
    of_circle<&Machine::platform_circle, &JointCircle::spacing>(
        on_platform_circle, "platform.joints.circle.spacing", not_negative,
        "between the two joints of a pair, less than the diameter; 0: both in one place",
        given("250 mm")),
};

constexpr ParameterRow damping_rows[]{
    table(
        "leg.*", optional, "any key of `[legs]` for one leg, and its joints",
        R"(# ---- One leg that differs: any key of [legs], and its own joints -----------------------------
# [leg.3.guide_sleeve]
# stiffness = "2 kN/mm"
#
# [leg.3]
# base_joint = [-1.1, 0.1, 0]           # m, in the base frame
# platform_joint = [-0.3, 0.7, 0]       # m, in the platform frame
)"),
    in_code(number<&Leg::base_joint>("leg.*.base_joint", "m", otherwise("of `[base.joints]`"), any,
                                     "`[x, y, z]` in the base frame")),
    in_code(number<&Leg::platform_joint>("leg.*.platform_joint", "m",
                                         otherwise("of `[platform.joints]`"), any,
                                         "`[x, y, z]` in the platform frame")),
    table(
        "model", optional, "",
        R"(# ---- Model and damping -----------------------------------------------------------------------
)"),
    word<&Machine::flexible_axes>(
        "model.flexible_axes", axes_words,
        "the axes about which a rod tilts in its cylinder: `\"transverse\"`, normal to "
        "the leg, or `\"gimbal\"`, parallel to the axes of the lower gimbal as in the "
        "paper"),
    table("damping", optional, "what is not a named damper of the legs"),
    word<&Machine::damping, &Damping::oil>(
        "damping.oil", oil_damping_words,
        "what damps the oil in modes and Bode diagrams: `\"viscous\"`, the damper "
        "`legs.oil_spring.damping` beside the spring, or `\"chambers\"`, leakage and valve at "
        "rest, in series with the oil of each chamber as in simulations; `modal_ratio` is then "
        "that of seals and base mount. `\"automatic\"`: chambers where a leg states leakage or a "
        "valve, else viscous"),
    number<&Machine::damping, &Damping::modal_ratio>(
        "damping.modal_ratio", "1", otherwise("0.02 where the file states no damping, else 0"),
        below_one,
        "damping ratio of every mode on top of the dampers, 0 or more and less than 1; simulations "
        "and poles of the system give it to seals and base mount, hydraulics damp the oil",
        shown("2 %")),
    number<&Machine::damping, &Damping::rayleigh_mass>("damping.rayleigh_mass", "1/s", standard,
                                                       not_negative, "α of C = α M + β K"),
    number<&Machine::damping, &Damping::rayleigh_stiffness>("damping.rayleigh_stiffness", "s",
                                                            standard, not_negative, "β"),
};

constexpr ParameterRow pose_rows[]{
    table(
        "poses.*", required, "`[poses.neutral]` must be there, other names are free",
        R"(# ---- Poses -----------------------------------------------------------------------------------
# Position of the platform frame's origin in the base frame; rotation [rx, ry, rz] is first about x,
# then about y, then about z, axes of the base (default [0, 0, 0]). "neutral" must be there; add
# your own under any name.

[poses.neutral]
position = [0, 0, "1.4 m"]

[poses.high]
position = [0, 0, "1.55 m"]

[poses.rolled]
position = [0, 0, "1.4 m"]
rotation = ["10 deg", 0, 0]
)"),
    in_code(number<&NamedPose::X_BP, &Pose::p_BP>(
        "poses.*.position", "m", required, any,
        "`[x, y, z]` of the platform frame's origin in the base frame")),
    of_rotation(number<&NamedPose::X_BP, &Pose::p_BP>(
        "poses.*.rotation", "rad", otherwise("`[0, 0, 0]`"), any,
        "`[rx, ry, rz]`: first about x, then y, then z, axes of the base (R = "
        "R_z R_y R_x)")),
};

}  // namespace

std::span<const ParameterRow> bodies() { return body_rows; }

std::span<const ParameterRow> single_legs_and_damping() { return damping_rows; }

std::span<const ParameterRow> poses() { return pose_rows; }

}  // namespace hydrapod::model::rows
