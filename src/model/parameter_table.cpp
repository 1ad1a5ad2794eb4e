// The table of all keys. One row is all that a new parameter needs besides its member.
#include <cmath>
#include <numbers>

#include "hydrapod/model/parameters.hpp"
#include "parameter_access.hpp"

namespace hydrapod::model {

namespace {

// ---- Bounds ---------------------------------------------------------------------------------

constexpr Bound any{};
constexpr Bound positive{.lowest = 0.0, .more_than_lowest = true};
constexpr Bound not_negative{.lowest = 0.0};

constexpr Bound below_one{.lowest = 0.0, .highest = 1.0, .less_than_highest = true};
constexpr Bound share{.lowest = 0.0, .highest = 1.0};
constexpr Bound up_to(double highest) { return {.lowest = 0.0, .highest = highest}; }
constexpr Bound up_to_one{.lowest = 0.0, .highest = 1.0, .more_than_lowest = true};
constexpr Bound polytropic{
    .lowest = 1.0, .highest = 2.0, .expected = "1 (slow) to about 1.4 (fast)"};
constexpr Bound tilt{.lowest = 0.0,
                     .highest = std::numbers::pi * (1.0 + 1e-9),
                     .more_than_lowest = true,
                     .expected = "no more than 180 deg",
                     .shown_in = "deg",
                     .shown_size = std::numbers::pi / 180.0};

// ---- Kinds of rows --------------------------------------------------------------------------

/// Must a key be there, and what holds where it is left out?
struct Presence {
  bool required{};
  std::string_view otherwise{};
};
constexpr Presence required{.required = true};
constexpr Presence optional{};
constexpr Presence standard{};  ///< the default of the struct
constexpr Presence otherwise(std::string_view what) { return {.otherwise = what}; }

/// What the starter file has: a value, or one in a comment; else the default in a comment.
struct Example {
  std::string_view value{};
  bool in_use{};
};
constexpr Example given(std::string_view value) { return {value, true}; }
constexpr Example shown(std::string_view value) { return {value, false}; }

constexpr ParameterRow row(Kind kind, std::string_view path, std::string_view unit,
                           Presence presence, Bound bound, std::string_view meaning,
                           Example example) {
  return {.path = path,
          .unit = unit,
          .kind = kind,
          .required = presence.required,
          .otherwise = presence.otherwise,
          .bound = bound,
          .meaning = meaning,
          .example = example.value,
          .in_use = example.in_use};
}

constexpr ParameterRow table(std::string_view path, Presence presence, std::string_view meaning,
                             std::string_view heading = {}) {
  auto made = row(Kind::table, path, {}, presence, {}, meaning, {});
  made.heading = heading;
  return made;
}

/// A table whose numbers only simulations and checks use.
constexpr ParameterRow simulation(std::string_view path, std::string_view meaning,
                                  std::string_view heading = {}) {
  auto made = table(path, optional, meaning, heading);
  made.mechanics = false;
  return made;
}

constexpr ParameterRow text(std::string_view path, Presence presence, std::string_view meaning,
                            Example example) {
  return row(Kind::text, path, {}, presence, {}, meaning, example);
}

/// Is the member at the end of the way an optional one?
template <auto first, auto... more>
constexpr bool ends_optional() {
  if constexpr (sizeof...(more) > 0) {
    return ends_optional<more...>();
  } else if constexpr (std::is_integral_v<decltype(first)>) {
    return true;  // springs of a mount, the only array of numbers with keys
  } else {
    return []<class Owner, class T>(T Owner::*) {
      return !std::is_same_v<T, std::remove_pointer_t<decltype(held<true>(std::declval<T&>()))>>;
    }(first);
  }
}

/// A number, or the numbers of an array, that the machine holds at `steps`.
template <auto... steps>
constexpr ParameterRow number(std::string_view path, std::string_view unit, Presence presence,
                              Bound bound, std::string_view meaning, Example example = {}) {
  constexpr int numbers = numbers_at<steps...>();
  auto made =
      row(numbers == 6 ? Kind::six : Kind::number, path, unit, presence, bound, meaning, example);
  made.numbers = numbers;
  made.optional = ends_optional<steps...>();
  made.find = number_at<false, steps...>;
  made.make = number_at<true, steps...>;
  return made;
}

template <auto... steps>
constexpr ParameterRow word(std::string_view path, std::span<const std::string_view> words,
                            std::string_view meaning) {
  auto made = row(Kind::word, path, {}, standard, {}, meaning, {});
  made.words = words;
  made.word = word_at<steps...>;
  made.set_word = set_word_at<steps...>;
  return made;
}

constexpr ParameterRow in_code(ParameterRow made) {
  made.in_code = true;
  return made;
}

constexpr ParameterRow instead_of(void (*other)(Machine&, int), ParameterRow made) {
  made.instead = other;
  return made;
}

// ---- Numbers that do more than being stored --------------------------------------------------

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
                                 std::string_view meaning, Example example) {
  auto made = in_code(number<circle, length>(path, "m", required, positive, meaning, example));
  made.finish = lay;
  return made;
}

constexpr ParameterRow points(std::string_view path, std::string_view meaning) {
  auto made = row(Kind::points, path, "m", optional, {}, meaning, {});
  made.in_code = true;
  made.numbers = 0;
  return made;
}

/// Axes get the length one; a zero axis stays zero for validate() to find.
void make_units(Machine& machine, unsigned legs) {
  for (std::size_t i = 0; i < leg_count; ++i) {
    Vector3& axis = machine.legs[i].gimbal_axis;
    const double largest = axis.cwiseAbs().maxCoeff();
    if ((legs >> i & 1U) == 0 || largest == 0.0 || !axis.allFinite()) continue;
    axis = (axis / largest).normalized();
  }
}

constexpr ParameterRow of_gimbal_axis(ParameterRow made) {
  made.finish = make_units;
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

/// Feedback of an acceleration has its gain in s.
constexpr ParameterRow of_feedback(ParameterRow made) {
  made.other_unit = [](const Machine& machine, std::string_view unit) {
    return machine.controller.feedback == DampingFeedback::acceleration ? std::string_view{"s"}
                                                                        : unit;
  };
  return made;
}

/// A spring of the mount, which is rigid where there is none.
template <int direction>
constexpr ParameterRow spring(std::string_view path, std::string_view meaning,
                              std::string_view example) {
  return number<&Machine::base_mount, &BaseMount::stiffness, direction>(
      path, direction < 3 ? "N/m" : "N m/rad", otherwise("rigid"), positive, meaning,
      shown(example));
}

/// The ends of what a sensor can show.
template <bool make, Sensor Sensors::*sensor>
double* range_end(Machine& machine, int, int element) {
  Sensor& of = machine.sensors.*sensor;
  return held<make>(element == 0 ? of.low : of.high);
}

template <Sensor Sensors::*sensor>
constexpr ParameterRow resolution(std::string_view path, std::string_view unit,
                                  Example example = {}) {
  return number<&Machine::sensors, sensor, &Sensor::resolution>(path, unit, standard, not_negative,
                                                                "step; 0: none", example);
}

template <Sensor Sensors::*sensor>
constexpr ParameterRow noise(std::string_view path, std::string_view unit, Example example = {}) {
  return number<&Machine::sensors, sensor, &Sensor::noise>(
      path, unit, standard, not_negative, "RMS of white noise from sample to sample", example);
}

template <Sensor Sensors::*sensor>
constexpr ParameterRow range(std::string_view path, std::string_view unit, Example example) {
  auto made = row(Kind::number, path, unit, otherwise("any"), {}, "`[lowest, highest]`", example);
  made.numbers = 2;
  made.optional = true;
  made.find = range_end<false, sensor>;
  made.make = range_end<true, sensor>;
  return made;
}

void drop_cylinder(Machine& machine, int leg) {
  machine.legs[static_cast<std::size_t>(leg)].oil_spring.cylinder.reset();
}
void drop_stiffness(Machine& machine, int leg) {
  machine.legs[static_cast<std::size_t>(leg)].oil_spring.stiffness.reset();
}
void drop_bandwidth(Machine& machine, int) { machine.controller.bandwidth.reset(); }
void drop_gain(Machine& machine, int) { machine.controller.gain.reset(); }

constexpr std::string_view axes_words[]{"transverse", "gimbal"};
constexpr std::string_view volume_words[]{"chambers", "equal"};
constexpr std::string_view space_words[]{"pose", "leg"};
constexpr std::string_view feedback_words[]{"pressure", "acceleration", "none"};
constexpr std::string_view compensation_words[]{"load", "asymmetry", "none"};

constexpr auto oil = &Leg::oil_spring;
constexpr auto cylinder = &OilSpring::cylinder;
constexpr auto hydraulics = &Leg::hydraulics;
constexpr auto valve = &LegHydraulics::valve;
constexpr auto friction = &LegHydraulics::friction;
constexpr auto joint_friction = &LegHydraulics::joint_friction;
constexpr auto supply = &Hydraulics::supply;
constexpr auto controller = &Machine::controller;
constexpr auto output = &ControlSettings::output;
constexpr auto mount = &Machine::base_mount;

// ---- The table ------------------------------------------------------------------------------

constexpr ParameterRow rows[]{
    text("name", required, "what the machine is called in tables and plots",
         given("My motion platform")),
    text("description", otherwise("empty"), "what the machine is", shown("What the machine is")),
    text("source", otherwise("empty"), "where the numbers come from",
         shown("Drawings, data sheets, measurements")),
    table("environment", optional, ""),
    of_gravity(number<&Machine::gravity>(
        "environment.gravity", "m/s^2", otherwise("9.80665"), any,
        "magnitude along -z of the base; or a vector `[gx, gy, gz]` in the base "
        "frame; 0 switches gravity off",
        shown("9.80665 m/s^2"))),
    table(
        "base.joints", optional, "",
        R"(# ---- Base ------------------------------------------------------------------------------------
# On a circle, joints stand in three pairs: `spacing` is the distance between the two of a pair.
# Base pairs stand at 60, 180 and 300 degrees, platform pairs at 0, 120 and 240 degrees; leg 1 joins
# the platform pair at 0 to the base pair at 60 degrees, and so on counter-clockwise.
# Instead of a circle: points = [[x, y, z], ...], one point for each of the legs 1 to 6, in m.
)"),
    points("base.joints.points",
           "`[[x, y, z], …]`, the joints of legs 1 to 6 in the base frame; instead of "
           "`circle`"),
    table("base.joints.circle", optional, ""),
    of_circle<&Machine::base_circle, &JointCircle::radius>(
        on_base_circle, "base.joints.circle.radius", "of the circle on which the joints stand",
        given("1.1 m")),
    of_circle<&Machine::base_circle, &JointCircle::spacing>(
        on_base_circle, "base.joints.circle.spacing",
        "between the two joints of a pair, less than the diameter", given("250 mm")),
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
    number<&Machine::platform, &Platform::mass>("platform.mass", "kg", required, positive,
                                                "more than 0", given("1500 kg")),
    number<&Machine::platform, &Platform::mass_center>("platform.mass_center", "m", required, any,
                                                       "`[x, y, z]` in the platform frame",
                                                       given("[0, 0, \"0.2 m\"]")),
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
        on_platform_circle, "platform.joints.circle.radius",
        "of the circle on which the joints stand", given("0.8 m")),
    of_circle<&Machine::platform_circle, &JointCircle::spacing>(
        on_platform_circle, "platform.joints.circle.spacing",
        "between the two joints of a pair, less than the diameter", given("250 mm")),
    table(
        "legs", required, "",
        R"(# ---- Legs: what all six have in common -------------------------------------------------------
# Lengths are counted along the leg's axis from the base joint, unless it says otherwise.
)"),
    of_gimbal_axis(number<&Leg::gimbal_axis>(
        "legs.gimbal_axis", "1", standard, any,
        "base-fixed axis of the lower gimbal in the base frame, of any length; "
        "used with `flexible_axes = \"gimbal\"`")),
    number<&Leg::gimbal_cross_inertia>(
        "legs.gimbal_cross_inertia", "kg m^2", standard, not_negative,
        "I_c, of the cross of the lower gimbal about its first axis; used with `flexible_axes = "
        "\"gimbal\"`"),
    number<&Leg::added_axial_inertia>(
        "legs.added_axial_inertia", "kg", standard, not_negative,
        "m_a, inertia that moves with the piston only: the oil in the lines, seen at "
        "the piston, ρ L A_p²/A for a line of length L and cross-section A"),
    number<&Leg::gimbal_stiffness>("legs.gimbal_stiffness", "N/m", otherwise("rigid"), positive,
                                   "k_j, of both gimbals and their fastening along the "
                                   "leg, in series with the oil spring",
                                   shown("300 kN/mm")),
    table("legs.case", required, "cylinder case"),
    number<&Leg::cylinder_case, &CylinderCase::mass>("legs.case.mass", "kg", required, not_negative,
                                                     "m_t, 0 or more", given("35 kg")),
    number<&Leg::cylinder_case, &CylinderCase::mass_center>(
        "legs.case.mass_center", "m", required, any, "r_b, from the base joint", given("0.5 m")),
    number<&Leg::cylinder_case, &CylinderCase::transverse_inertia>(
        "legs.case.transverse_inertia", "kg m^2", required, not_negative,
        "I_t, across the axis, about the mass centre", given("3 kg m^2")),
    number<&Leg::cylinder_case, &CylinderCase::axial_inertia>(
        "legs.case.axial_inertia", "kg m^2", standard, not_negative,
        "I_ta, about the axis, no more than twice I_t; used with `flexible_axes = "
        "\"gimbal\"`"),
    table("legs.rod", required, "rod with piston"),
    number<&Leg::rod, &Rod::length>("legs.rod.length", "m", required, positive,
                                    "l_mn, from the piston to the platform joint", given("1.05 m")),
    number<&Leg::rod, &Rod::mass>("legs.rod.mass", "kg", required, not_negative, "m_g, 0 or more",
                                  given("22 kg")),
    number<&Leg::rod, &Rod::mass_center>("legs.rod.mass_center", "m", required, any,
                                         "c_g, from the piston towards the platform",
                                         given("0.5 m")),
    number<&Leg::rod, &Rod::transverse_inertia>(
        "legs.rod.transverse_inertia", "kg m^2", required, not_negative,
        "I_r, across the axis, about the mass centre", given("2 kg m^2")),
    number<&Leg::rod, &Rod::axial_inertia>(
        "legs.rod.axial_inertia", "kg m^2", standard, not_negative,
        "I_ra, about the axis, no more than twice I_r; used with `flexible_axes = "
        "\"gimbal\"`"),
    table("legs.guide_sleeve", required, "the seals' O-rings where the rod leaves the cylinder"),
    number<&Leg::guide_sleeve, &GuideSleeve::position>("legs.guide_sleeve.position", "m", required,
                                                       positive, "L_g, from the base joint",
                                                       given("1 m")),
    number<&Leg::guide_sleeve, &GuideSleeve::stiffness>(
        "legs.guide_sleeve.stiffness", "N/m", required, positive,
        "k_s, lateral, between case and rod", given("5 kN/mm")),
    number<&Leg::guide_sleeve, &GuideSleeve::damping>("legs.guide_sleeve.damping", "N s/m",
                                                      standard, not_negative,
                                                      "c_s, lateral, viscous", given("2 kN s/m")),
    table("legs.piston_ring", optional,
          "the O-ring under the piston's ring; without the table it is rigid"),
    number<&Leg::piston_ring, &PistonRing::stiffness>(
        "legs.piston_ring.stiffness", "N/m", required, positive,
        "k_g, lateral, between case and piston", shown("20 kN/mm")),
    number<&Leg::piston_ring, &PistonRing::damping>("legs.piston_ring.damping", "N s/m", standard,
                                                    not_negative, "c_g, lateral, viscous"),
    table("legs.oil_spring", required,
          "the oil along the leg: either `stiffness`, or the table `cylinder`"),
    instead_of(drop_cylinder,
               number<oil, &OilSpring::stiffness>("legs.oil_spring.stiffness", "N/m", standard,
                                                  positive, "k_h", shown("20 kN/mm"))),
    number<oil, &OilSpring::damping>("legs.oil_spring.damping", "N s/m", standard, not_negative,
                                     "c_h, viscous, parallel to the spring", given("10 kN s/m")),
    instead_of(drop_stiffness,
               table("legs.oil_spring.cylinder", required, "what the stiffness follows from")),
    number<oil, cylinder, &Cylinder::bore>("legs.oil_spring.cylinder.bore", "m", required, positive,
                                           "more than 0", given("80 mm")),
    number<oil, cylinder, &Cylinder::rod_diameter>("legs.oil_spring.cylinder.rod_diameter", "m",
                                                   required, not_negative,
                                                   "0 or more, less than the bore", given("56 mm")),
    number<oil, cylinder, &Cylinder::cap_dead_volume>(
        "legs.oil_spring.cylinder.cap_dead_volume", "m^3", standard, not_negative,
        "of the chamber on the base side, with the piston retracted", given("100 cm^3")),
    number<oil, cylinder, &Cylinder::rod_dead_volume>(
        "legs.oil_spring.cylinder.rod_dead_volume", "m^3", standard, not_negative,
        "of the chamber around the rod, with the piston extended", given("100 cm^3")),
    number<oil, cylinder, &Cylinder::cap_line_volume>(
        "legs.oil_spring.cylinder.cap_line_volume", "m^3", standard, not_negative,
        "between the chamber on the base side and the valve", given("150 cm^3")),
    number<oil, cylinder, &Cylinder::rod_line_volume>(
        "legs.oil_spring.cylinder.rod_line_volume", "m^3", standard, not_negative,
        "between the chamber around the rod and the valve", given("150 cm^3")),
    number<oil, cylinder, &Cylinder::bulk_modulus>("legs.oil_spring.cylinder.bulk_modulus", "Pa",
                                                   required, positive, "β_e of the oil without air",
                                                   given("1.4 GPa")),
    word<oil, cylinder, &Cylinder::volumes>(
        "legs.oil_spring.cylinder.volumes", volume_words,
        "`\"chambers\"`: the true volumes at the pose, which needs `[legs.stroke]`; "
        "`\"equal\"`: both chambers hold `control_volume` at every pose (Eq. 16 of the "
        "paper)"),
    number<oil, cylinder, &Cylinder::control_volume>(
        "legs.oil_spring.cylinder.control_volume", "m^3",
        otherwise("mean of both chambers at mid stroke"), positive, "V_0 for `\"equal\"`",
        shown("2 l")),
    table("legs.oil_spring.cylinder.air", optional,
          "air carried in the oil as bubbles; without the table there is none"),
    number<oil, cylinder, &Cylinder::air, &EntrainedAir::fraction>(
        "legs.oil_spring.cylinder.air.fraction", "1", required, below_one,
        "share of the volume at atmospheric pressure, 0 or more and less than 1", shown("1 %")),
    number<oil, cylinder, &Cylinder::air, &EntrainedAir::pressure>(
        "legs.oil_spring.cylinder.air.pressure", "Pa", required, positive,
        "mean absolute pressure in the chambers", shown("70 bar")),
    number<oil, cylinder, &Cylinder::air, &EntrainedAir::polytropic>(
        "legs.oil_spring.cylinder.air.polytropic", "1", standard, polytropic,
        "exponent n of p Vⁿ: 1 for slow changes, 1.4 for fast ones"),
    table("legs.stroke", optional, "where the piston can be; optional with a given stiffness"),
    number<&Leg::stroke, &Stroke::retracted>("legs.stroke.retracted", "m", required, not_negative,
                                             "from the base joint to the piston when retracted",
                                             given("0.25 m")),
    number<&Leg::stroke, &Stroke::length>("legs.stroke.length", "m", required, positive,
                                          "more than 0", given("0.6 m")),
    simulation("legs.joint_limits", "largest tilt of the joints from the neutral pose"),
    number<&Leg::joint_limits, &JointLimits::base>(
        "legs.joint_limits.base", "rad", otherwise("any"), tilt, "more than 0, no more than 180°",
        shown("35 deg")),
    number<&Leg::joint_limits, &JointLimits::platform>(
        "legs.joint_limits.platform", "rad", otherwise("any"), tilt,
        "more than 0, no more than 180°", shown("40 deg")),
    simulation(
        "legs.valve", "four-edge servo valve",
        R"(# ---- Servo-hydraulics, for `hydrapod simulate` ------------------------------------------------
# All of it is optional; what is not given follows from the machine, and `hydrapod check` says how.
# Pressures are absolute.
)"),
    number<hydraulics, valve, &ServoValve::rated_flow>(
        "legs.valve.rated_flow", "m^3/s", otherwise("0.5 m/s times A_p"), positive,
        "at full opening and the rated pressure drop", shown("150 l/min")),
    number<hydraulics, valve, &ServoValve::rated_pressure_drop>(
        "legs.valve.rated_pressure_drop", "Pa", standard, positive, "over both edges together",
        shown("70 bar")),
    number<hydraulics, valve, &ServoValve::overlap>(
        "legs.valve.overlap", "1", standard,
        {.lowest = -0.5,
         .highest = 0.5,
         .expected = "-0.5 (underlap) to 0.5 (overlap)",
         .shown_in = "of the travel"},
        "share of the travel, -0.5 to 0.5; negative: underlap"),
    number<hydraulics, valve, &ServoValve::laminar_pressure>(
        "legs.valve.laminar_pressure", "Pa", standard, positive,
        "pressure drop below which the flow of an edge is laminar", shown("1 bar")),
    number<hydraulics, valve, &ServoValve::natural_frequency>("legs.valve.natural_frequency",
                                                              "rad/s", standard, positive,
                                                              "of the spool", shown("600 rad/s")),
    number<hydraulics, valve, &ServoValve::damping_ratio>("legs.valve.damping_ratio", "1", standard,
                                                          positive, "of the spool"),
    number<hydraulics, valve, &ServoValve::rate_limit>("legs.valve.rate_limit", "1/s", standard,
                                                       positive,
                                                       "largest rate of the spool, in travels"),
    number<hydraulics, valve, &ServoValve::leakage>(
        "legs.valve.leakage", "m^3/s", otherwise("1 % of the rated flow"), not_negative,
        "null leakage: from supply to return, both ports blocked", shown("1.5 l/min")),
    simulation("legs.leakage", "of the cylinder"),
    number<hydraulics, &LegHydraulics::leakage, &CylinderLeakage::internal>(
        "legs.leakage.internal", "m^3/(s Pa)",
        otherwise("1 % of the rated flow at the supply pressure"), not_negative, "past the piston",
        shown("1e-12")),
    number<hydraulics, &LegHydraulics::leakage, &CylinderLeakage::external>(
        "legs.leakage.external", "m^3/(s Pa)", standard, not_negative,
        "from each chamber to the outside"),
    simulation("legs.friction", "of the seals, along the leg"),
    number<hydraulics, friction, &SealFriction::coulomb>(
        "legs.friction.coulomb", "N", otherwise("0"), not_negative,
        "F_c; with O-rings about 1 % of A_p times the supply pressure", shown("700 N")),
    number<hydraulics, friction, &SealFriction::breakaway>(
        "legs.friction.breakaway", "N", otherwise("1.5 F_c"), not_negative, "F_s, no less than F_c",
        shown("1050 N")),
    number<hydraulics, friction, &SealFriction::viscous>("legs.friction.viscous", "N s/m",
                                                         otherwise("10 F_c per m/s"), not_negative,
                                                         "b", shown("7 kN s/m")),
    number<hydraulics, friction, &SealFriction::stribeck_velocity>(
        "legs.friction.stribeck_velocity", "m/s", standard, positive, "v_s", shown("20 mm/s")),
    number<hydraulics, friction, &SealFriction::smoothing_velocity>(
        "legs.friction.smoothing_velocity", "m/s", standard, positive,
        "v_0 of tanh(v/v_0); not used with bristles", shown("2 mm/s")),
    simulation("legs.friction.bristles", "friction after LuGre instead of tanh"),
    number<hydraulics, friction, &SealFriction::bristles, &LuGreBristles::stiffness>(
        "legs.friction.bristles.stiffness", "N/m", required, positive, "σ_0", shown("50 kN/mm")),
    number<hydraulics, friction, &SealFriction::bristles, &LuGreBristles::damping>(
        "legs.friction.bristles.damping", "N s/m", standard, not_negative, "σ_1"),
    simulation("legs.joint_friction", "in both joints of a leg, against turning of its axis"),
    number<hydraulics, joint_friction, &JointFriction::viscous>(
        "legs.joint_friction.viscous", "N m s/rad", standard, not_negative, "0 or more"),
    number<hydraulics, joint_friction, &JointFriction::coulomb>(
        "legs.joint_friction.coulomb", "N m", standard, not_negative, "0 or more"),
    number<hydraulics, joint_friction, &JointFriction::smoothing_rate>(
        "legs.joint_friction.smoothing_rate", "rad/s", standard, positive,
        "of the same law as at the seals"),
    simulation("legs.end_stops", "at the ends of the stroke"),
    number<hydraulics, &LegHydraulics::end_stops, &EndStops::stiffness>(
        "legs.end_stops.stiffness", "N/m", otherwise("20 times the oil spring"), positive,
        "k of the force k δ (1 + damping dδ/dt)", shown("400 kN/mm")),
    number<hydraulics, &LegHydraulics::end_stops, &EndStops::damping>(
        "legs.end_stops.damping", "s/m", standard, not_negative, "of the same force"),
    simulation("legs.equivalent_cylinder", "with `oil_spring.stiffness` only"),
    number<hydraulics, &LegHydraulics::equivalent_cylinder, &EquivalentCylinder::area_ratio>(
        "legs.equivalent_cylinder.area_ratio", "1", standard, up_to_one,
        "e, rod side to cap side, no more than 1"),
    number<hydraulics, &LegHydraulics::equivalent_cylinder, &EquivalentCylinder::area>(
        "legs.equivalent_cylinder.area", "m^2",
        otherwise("a sixth of the supply pressure bears the leg's share of the platform"), positive,
        "A_p; the default is larger where chambers would else be shorter than the "
        "stroke",
        shown("50 cm^2")),
    number<hydraulics, &LegHydraulics::equivalent_cylinder, &EquivalentCylinder::bulk_modulus>(
        "legs.equivalent_cylinder.bulk_modulus", "Pa", standard, positive, "β_e", shown("1 GPa")),
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
    number<&Machine::damping, &Damping::modal_ratio>(
        "damping.modal_ratio", "1", otherwise("0.02 where nothing else damps, else 0"), below_one,
        "damping ratio of every mode, 0 or more and less than 1", shown("2 %")),
    number<&Machine::damping, &Damping::rayleigh_mass>("damping.rayleigh_mass", "1/s", standard,
                                                       not_negative, "α of C = α M + β K"),
    number<&Machine::damping, &Damping::rayleigh_stiffness>("damping.rayleigh_stiffness", "s",
                                                            standard, not_negative, "β"),
    simulation(
        "supply", "pressure for all legs",
        R"(# ---- Supply, controller and sensors, for `hydrapod simulate` and `hydrapod modes --system` --------
# All of it is optional; what is not given follows from the machine.
)"),
    number<&Machine::hydraulics, supply, &Supply::pressure>(
        "supply.pressure", "Pa", standard, positive, "p_s, absolute", shown("140 bar")),
    number<&Machine::hydraulics, supply, &Supply::return_pressure>(
        "supply.return_pressure", "Pa", standard, positive, "p_r, absolute", shown("5 bar")),
    number<&Machine::hydraulics, supply, &Supply::pump_flow>(
        "supply.pump_flow", "m^3/s", otherwise("any"), positive,
        "largest flow of a pressure-controlled pump; without it the supply pressure is "
        "constant",
        shown("100 l/min")),
    number<&Machine::hydraulics, supply, &Supply::line_volume>(
        "supply.line_volume", "m^3", standard, positive,
        "oil between pump and valves; used with `pump_flow`", shown("1 l")),
    number<&Machine::hydraulics, &Hydraulics::cavitation_pressure>(
        "supply.cavitation_pressure", "Pa", standard, positive,
        "about which a chamber fills with vapour, less than the return pressure", shown("0.5 bar")),
    simulation("supply.accumulator", "gas-charged, with `pump_flow` only"),
    number<&Machine::hydraulics, supply, &Supply::accumulator, &Accumulator::gas_volume>(
        "supply.accumulator.gas_volume", "m^3", required, positive, "at the precharge",
        shown("10 l")),
    number<&Machine::hydraulics, supply, &Supply::accumulator, &Accumulator::precharge>(
        "supply.accumulator.precharge", "Pa", required, positive, "absolute", shown("90 bar")),
    number<&Machine::hydraulics, supply, &Supply::accumulator, &Accumulator::polytropic>(
        "supply.accumulator.polytropic", "1", standard, polytropic,
        "exponent n of p Vⁿ: 1 for slow changes, 1.4 for fast ones"),
    simulation("controller", "from pose errors to valve drives"),
    word<controller, &ControlSettings::space>(
        "controller.space", space_words,
        "`\"pose\"`: errors of the pose, from the leg lengths by forward kinematics; "
        "`\"leg\"`: errors of the leg lengths"),
    instead_of(drop_bandwidth, number<controller, &ControlSettings::gain>(
                                   "controller.gain", "1/s", standard, not_negative,
                                   "six proportional gains; instead of `bandwidth`")),
    instead_of(drop_gain,
               number<controller, &ControlSettings::bandwidth>(
                   "controller.bandwidth", "rad/s",
                   otherwise("0.3 of the lowest oil mode, without pressure feedback 0.05"),
                   positive, "one gain for all", shown("20 rad/s"))),
    number<controller, &ControlSettings::integral_time>(
        "controller.integral_time", "s", otherwise("8 / smallest gain"), not_negative,
        "T_i of the integral part; 0 switches it off", shown("0.4 s")),
    number<controller, &ControlSettings::velocity_feedforward>(
        "controller.velocity_feedforward", "1", standard, any,
        "share of the commanded velocity that is fed forward"),
    word<controller, &ControlSettings::feedback>(
        "controller.feedback", feedback_words,
        "what damps the oil modes: `\"pressure\"` (load force from the chamber "
        "pressures), `\"acceleration\"` (of the pistons), both high-passed; `\"none\"`"),
    number<controller, &ControlSettings::feedback_damping>(
        "controller.feedback_damping", "1", standard, up_to(2.0),
        "damping ratio that pressure feedback gives to the lowest oil mode, "
        "acceleration feedback to the highest; 2 or less"),
    of_feedback(number<controller, &ControlSettings::feedback_gain>(
        "controller.feedback_gain", "m/(N s)", otherwise("from `feedback_damping`"), any,
        "the gain itself; in s with acceleration feedback")),
    number<controller, &ControlSettings::feedback_corner>(
        "controller.feedback_corner", "rad/s", otherwise("0.1 of the lowest oil mode"),
        not_negative, "of the high pass", shown("6 rad/s")),
    number<controller, &ControlSettings::sample_time>("controller.sample_time", "s", standard,
                                                      {.lowest = 1e-5, .highest = 1.0},
                                                      "10 µs to 1 s", shown("1 ms")),
    number<controller, &ControlSettings::delay>(
        "controller.delay", "1", standard, {.lowest = 0.0, .highest = 100.0, .shown_in = "samples"},
        "samples from reading the sensors to the new drive, fractions allowed, 100 or "
        "less"),
    word<controller, &ControlSettings::compensation>(
        "controller.compensation", compensation_words,
        "speed of the cylinder per drive, by which drives are corrected: `\"load\"`, "
        "at the present load (from the pressure sensors); `\"asymmetry\"`, of extending "
        "and of retracting under the load of the neutral pose; `\"none\"`, their mean"),
    number<controller, &ControlSettings::overlap_compensation>(
        "controller.overlap_compensation", "1", standard,
        {.lowest = 0.0, .highest = 1.0, .expected = "1 or less"},
        "share of the valve's overlap that the drive jumps over, 0 to 1"),
    simulation("controller.output", "in shares of full drive"),
    number<controller, output, &DriveOutput::limit>("controller.output.limit", "1", standard,
                                                    up_to_one,
                                                    "largest drive, more than 0, no more than 1"),
    number<controller, output, &DriveOutput::resolution>(
        "controller.output.resolution", "1", standard, share,
        "step of the converter (16 bits over ±1); 0: none"),
    number<controller, output, &DriveOutput::scale>("controller.output.scale", "1", standard, any,
                                                    "six factors, one per leg"),
    number<controller, output, &DriveOutput::offset>(
        "controller.output.offset", "1", standard,
        {.lowest = -1.0,
         .highest = 1.0,
         .more_than_lowest = true,
         .less_than_highest = true,
         .expected = "a share of full drive: more than -1, less than 1"},
        "six offsets, one per leg, added last: the valves' nulls"),
    simulation("sensors.length", "leg lengths"),
    resolution<&Sensors::length>("sensors.length.resolution", "m", shown("5 um")),
    noise<&Sensors::length>("sensors.length.noise", "m", shown("2 um")),
    range<&Sensors::length>("sensors.length.range", "m", shown("[\"1.2 m\", \"2 m\"]")),
    simulation("sensors.pressure", "chamber pressures"),
    resolution<&Sensors::pressure>("sensors.pressure.resolution", "Pa", shown("2 kPa")),
    noise<&Sensors::pressure>("sensors.pressure.noise", "Pa", shown("5 kPa")),
    range<&Sensors::pressure>("sensors.pressure.range", "Pa", shown("[\"0 bar\", \"250 bar\"]")),
    simulation("sensors.acceleration", "of the pistons along the cylinders"),
    resolution<&Sensors::acceleration>("sensors.acceleration.resolution", "m/s^2"),
    noise<&Sensors::acceleration>("sensors.acceleration.noise", "m/s^2"),
    range<&Sensors::acceleration>("sensors.acceleration.range", "m/s^2",
                                  shown("[\"-50 m/s^2\", \"50 m/s^2\"]")),
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

constexpr Alternatives pairs[]{{"oil_spring", "stiffness", "cylinder"},
                               {"joints", "circle", "points"},
                               {"controller", "gain", "bandwidth"}};

}  // namespace

std::span<const ParameterRow> parameter_table() { return rows; }

std::span<const Alternatives> alternatives() { return pairs; }

}  // namespace hydrapod::model
