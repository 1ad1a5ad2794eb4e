/// One mistake at a time in a sound machine file, and the exact message it gets.

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"

namespace hydrapod::model {
namespace {

struct WrongInput {
  std::string name{};
  std::vector<Edit> edits{};  ///< of the sound file
  std::vector<std::string> overrides{};
  std::string message{};  ///< all of it
};

void PrintTo(const WrongInput& wrong, std::ostream* out) { *out << wrong.name; }

/// What is wrong with the text, its keys and the types of its values, and what it describes.
const std::vector<WrongInput> wrong_files{
    {"UnknownKeyAtTheTop",
     {{R"(name = "Sound")", "name = \"Sound\"\nmas = 3"}},
     {},
     "m.toml:2:1: error: mas: unknown key; known here: name, description, source, state, "
     "environment, "
     "base, platform, payload_modes, legs, leg, model, damping, supply, lines, controller, "
     "sensors, "
     "poses"},
    {"UnknownTable",
     {{"[environment]", "[enviroment]"}},
     {},
     "m.toml:2:2: error: enviroment: unknown key; did you mean `environment`?"},
    {"UnknownKeyWithNearestKnown",
     {{"[legs.guide_sleeve]\nposition = 1.0\nstiffness",
       "[legs.guide_sleeve]\nposition = 1.0\nstifness"}},
     {},
     "m.toml:25:1: error: legs.guide_sleeve.stifness: unknown key; did you mean `stiffness`?"},
    {"UnknownKeyFarFromAllKnown",
     {{"mass = 1500", "mass = 1500\ncolour = \"red\""}},
     {},
     "m.toml:10:1: error: platform.colour: unknown key; known here: mass, mass_center, inertia, "
     "joints"},
    {"UnknownKeyOfOneLeg",
     {{"[leg.3.guide_sleeve]\nstiffness", "[leg.3.guide_sleeve]\nStiffness"}},
     {},
     "m.toml:36:1: error: leg.3.guide_sleeve.Stiffness: unknown key; did you mean `stiffness`?"},
    {"LegSeven",
     {{"[leg.3.guide_sleeve]", "[leg.7.guide_sleeve]"}},
     {},
     "m.toml:35:6: error: leg.7: unknown key; known here: 1, 2, 3, 4, 5, 6"},
    {"MountOfNegativeStiffness",
     {},
     {"base.mount.stiffness.rx=-3 N m/rad"},
     "--set base.mount.stiffness.rx=-3 N m/rad: error: base.mount.stiffness.rx: is -3 N m/rad, "
     "expected more than 0"},
    {"MountInTheWrongUnit",
     {},
     {"base.mount.stiffness.rx=3 N/m"},
     "--set base.mount.stiffness.rx=3 N/m: error: base.mount.stiffness.rx: \"3 N/m\" has the unit "
     "\"N/m\" (a stiffness), expected a quantity in kg m^2 rad^-1 s^-2 such as \"N m/rad\""},
    {"MountDirectionThatIsNone",
     {},
     {"base.mount.stiffness.roll=3"},
     "--set base.mount.stiffness.roll=3: error: base.mount.stiffness.roll: unknown key; known "
     "here: x, y, z, rx, ry, rz"},
    {"MountOfNegativeMass",
     {},
     {"base.mount.stiffness.x=1e6", "base.mount.mass=-3"},
     "--set base.mount.mass=-3: error: base.mount.mass: is -3 kg, expected 0 or more"},
    {"GimbalsOfNoStiffness",
     {},
     {"legs.gimbal_stiffness=0"},
     "--set legs.gimbal_stiffness=0: error: legs.gimbal_stiffness: is 0 N/m, expected more than "
     "0"},
    {"JointOfAllLegs",
     {{"gimbal_axis = [0, 1, 0]", "base_joint = [0, 1, 0]"}},
     {},
     "m.toml:13:1: error: legs.base_joint: unknown key; known here: gimbal_axis, "
     "gimbal_cross_inertia, added_axial_inertia, gimbal_stiffness, stick_stiffness, bending, case, "
     "rod, "
     "guide_sleeve, "
     "piston_ring, oil_spring, "
     "stroke, strut, screw, joint_limits, valve, leakage, friction, joint_friction, end_stops, "
     "equivalent_cylinder"},
    {"UnknownKeyOfPose",
     {{R"(rotation = ["10 deg", 0, 0])", R"(rotaton = ["10 deg", 0, 0])"}},
     {},
     "m.toml:43:1: error: poses.tilted.rotaton: unknown key; did you mean `rotation`?"},
    {"WrongDimension",
     {{"mass = 35", R"(mass = "35 m")"}},
     {},
     "m.toml:15:8: error: legs.case.mass: \"35 m\" has the unit \"m\" (a length), expected a mass "
     "such as \"kg\""},
    {"WrongDimensionInAnArray",
     {{"mass_center = [0, 0, 0.2]", R"(mass_center = [0, 0, "0.2 kg"])"}},
     {},
     "m.toml:10:22: error: platform.mass_center[2]: \"0.2 kg\" has the unit \"kg\" (a mass), "
     "expected a length such as \"m\""},
    {"UnknownUnit",
     {{R"(bore = "80 mm")", R"(bore = "80 milli")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: \"80 milli\" has the unknown unit "
     "\"milli\", expected a length such as \"m\""},
    {"UnitInWrongCase",
     {{R"("1.4 GPa")", R"("1.4 gpa")"}},
     {},
     "m.toml:32:16: error: legs.oil_spring.cylinder.bulk_modulus: \"1.4 gpa\" has the unknown unit "
     "\"gpa\", expected a pressure such as \"Pa\"; did you mean \"GPa\"?"},
    {"UnitsRunTogether",
     {{"inertia = { xx = 500", R"(inertia = { xx = "500 kgm^2")"}},
     {},
     "m.toml:11:18: error: platform.inertia.xx: \"500 kgm^2\" has the unknown unit \"kgm^2\", "
     "expected a moment of inertia such as \"kg m^2\"; did you mean \"kg m^2\"?"},
    {"QuantityWithoutUnit",
     {{R"(bore = "80 mm")", R"(bore = "0.08")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: \"0.08\" has no unit, expected a length "
     "such as \"0.5 m\""},
    {"QuantityWithoutNumber",
     {{R"(bore = "80 mm")", R"(bore = "mm")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: \"mm\" does not start with a number, "
     "expected a length such as \"0.5 m\""},
    {"DecimalComma",
     {{R"(bore = "80 mm")", R"(bore = "80,5 mm")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: \"80,5 mm\" has a decimal comma, expected "
     "a decimal point"},
    {"UnitWithAnOffset",
     {{R"("10 deg")", R"("10 degC")"}},
     {},
     "m.toml:43:13: error: poses.tilted.rotation[0]: \"10 degC\" has the unit \"degC\", which has "
     "a zero of its own, expected an angle such as \"rad\""},
    {"AngleInPercent",
     {{R"("10 deg")", R"("10 %")"}},
     {},
     "m.toml:43:13: error: poses.tilted.rotation[0]: \"10 %\" has the unit \"%\" (a pure number), "
     "expected an angle such as \"rad\""},
    {"TextAfterTheUnit",
     {{R"(bore = "80 mm")", R"(bore = "80 mm 3")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: \"80 mm 3\" has the unknown unit \"mm "
     "3\", expected a length such as \"m\""},
    {"EmptyQuantity",
     {{R"(bore = "80 mm")", R"(bore = "")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: is an empty string, expected a length "
     "such as \"0.5 m\""},
    {"QuantityOutOfRange",
     {{R"(bore = "80 mm")", R"(bore = "1e400 mm")"}},
     {},
     "m.toml:30:8: error: legs.oil_spring.cylinder.bore: \"1e400 mm\" is out of the range of "
     "numbers"},
    {"NotANumber",
     {{"mass = 35", "mass = nan"}},
     {},
     "m.toml:15:8: error: legs.case.mass: is nan, expected a finite number"},
    {"InfiniteNumber",
     {{"mass = 35", "mass = inf"}},
     {},
     "m.toml:15:8: error: legs.case.mass: is inf, expected a finite number"},
    {"BooleanForANumber",
     {{"mass = 35", "mass = true"}},
     {},
     "m.toml:15:8: error: legs.case.mass: is a boolean, expected a mass, as a number in kg or a "
     "string such as \"0.5 kg\""},
    {"DateForANumber",
     {{"mass = 35", "mass = 2021-04-14"}},
     {},
     "m.toml:15:8: error: legs.case.mass: is a date or time, expected a mass, as a number in kg or "
     "a string such as \"0.5 kg\""},
    {"TableForANumber",
     {{"mass = 35", "mass = { value = 35 }"}},
     {},
     "m.toml:15:8: error: legs.case.mass: is a table, expected a mass, as a number in kg or a "
     "string such as \"0.5 kg\""},
    {"ArrayTooShort",
     {{"mass_center = [0, 0, 0.2]", "mass_center = [0, 0.2]"}},
     {},
     "m.toml:10:15: error: platform.mass_center: is an array of 2, expected an array of 3 numbers "
     "in m"},
    {"NumberForAnArray",
     {{"mass_center = [0, 0, 0.2]", "mass_center = 0.2"}},
     {},
     "m.toml:10:15: error: platform.mass_center: is the number 0.2, expected an array of 3 numbers "
     "in m"},
    {"NumberForATable",
     {{"[leg.3.guide_sleeve]\nstiffness = \"4 kN/mm\"", "[leg.3]\nguide_sleeve = 3"}},
     {},
     "m.toml:36:16: error: leg.3.guide_sleeve: is the number 3, expected a table with the keys "
     "position, stiffness, damping, gap, guide_stiffness, elastomer"},
    {"ArrayOfTables",
     {{"[legs.rod]", "[[legs.rod]]"}},
     {},
     "m.toml:18:1: error: legs.rod: is an array of 1, expected a table with the keys length, mass, "
     "mass_center, transverse_inertia, axial_inertia, diameter, wall, youngs_modulus, "
     "yield_strength"},
    {"NumberForAString",
     {{R"(name = "Sound")", "name = 3"}},
     {},
     "m.toml:1:8: error: name: is the number 3, expected a string"},
    {"EmptyName",
     {{R"(name = "Sound")", R"(name = "")"}},
     {},
     "m.toml:1:8: error: name: is an empty string, expected some text"},
    {"MissingName",
     {{"name = \"Sound\"\n", ""}},
     {},
     "m.toml:1:1: error: name: required value (a string) is missing"},
    {"MissingKey",
     {{"length = 1.05\n", ""}},
     {},
     "m.toml:18:1: error: legs.rod.length: required value (a length, as a number in m or a string "
     "such as \"0.5 m\") is missing"},
    {"MissingKeyOfThePlatform",
     {{"mass = 1500\n", ""}},
     {},
     "m.toml:8:1: error: platform.mass: required value (a mass, as a number in kg or a string such "
     "as \"0.5 kg\") is missing"},
    {"MissingTable",
     {{"[legs.rod]\nlength = 1.05\nmass = 22\nmass_center = 0.5\ntransverse_inertia = 2\n", ""}},
     {},
     "m.toml:12:1: error: legs.rod: required table [legs.rod] is missing; a plain strut, "
     "[legs.strut], in place of all parts of a cylinder would do too"},
    {"MissingTableOfSprings",
     {{"[legs.oil_spring.cylinder]\nbore = \"80 mm\"\nrod_diameter = \"56 mm\"\nbulk_modulus = "
       "\"1.4 GPa\"\ncap_dead_volume = \"100 cm^3\"\nrod_dead_volume = \"100 cm^3\"\n",
       ""}},
     {},
     "m.toml:12:1: error: legs.oil_spring: required table [legs.oil_spring] is missing; "
     "[legs.screw] of an electric cylinder in its place, or a plain strut, [legs.strut], in place "
     "of all parts of a cylinder would do too"},
    {"MissingJoints",
     {{"circle = { radius = 1.1, spacing = 0.25 }", ""}},
     {},
     "m.toml:4:1: error: base.joints.circle: `circle = { radius, spacing }` or `points = [[x, y, "
     "z] of six legs]` (or `base_joint` of every leg) is missing"},
    {"MissingNeutralPose",
     {{"[poses.neutral]", "[poses.middle]"}},
     {},
     "m.toml:39:1: error: poses.neutral: required table [poses.neutral] is missing"},
    {"UnknownWord",
     {{"\"transverse\"\n[poses", "\"transversal\"\n[poses"}},
     {},
     "m.toml:38:17: error: model.flexible_axes: is the string \"transversal\", expected "
     "\"transverse\" or \"gimbal\""},
    {"UnknownVolumeRule",
     {{R"(bore = "80 mm")", "bore = \"80 mm\"\nvolumes = 2"}},
     {},
     "m.toml:31:11: error: legs.oil_spring.cylinder.volumes: is the number 2, expected "
     "\"chambers\" or \"equal\""},
    {"CircleAndPoints",
     {{"circle = { radius = 1.1, spacing = 0.25 }",
       "circle = { radius = 1.1, spacing = 0.25 }\npoints = []"}},
     {},
     "m.toml:4:1: error: base.joints: both `circle` and `points` are given, expected one of them"},
    {"FivePoints",
     {{"circle = { radius = 1.1, spacing = 0.25 }",
       "points = [[1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 0, 0], [-1, -1, 0]]"}},
     {},
     "m.toml:5:10: error: base.joints.points: is an array of 5, expected an array of 6 points, "
     "each [x, y, z] in m"},
    {"NegativeRadius",
     {{"radius = 1.1", "radius = -1.1"}},
     {},
     "m.toml:5:21: error: base.joints.circle.radius: is -1.1 m, expected a radius above 0"},
    {"SpacingBeyondTheDiameter",
     {{"radius = 1.1, spacing = 0.25", "radius = 1.1, spacing = 2.5"}},
     {},
     "m.toml:5:36: error: base.joints.circle.spacing: is 2.5 m, expected 0 or more and less than "
     "the circle's diameter, 2.2 m"},
    {"StiffnessAndCylinder",
     {{"[legs.oil_spring.cylinder]",
       "[legs.oil_spring]\nstiffness = 2e7\n[legs.oil_spring.cylinder]"}},
     {},
     "m.toml:29:1: error: legs.oil_spring: both `stiffness` and `cylinder` are given, expected one "
     "of them"},
    {"NegativeGravity",
     {{"gravity = 9.81", "gravity = -9.81"}},
     {},
     "m.toml:3:11: error: environment.gravity: is -9.81 m/s^2, expected a magnitude of 0 or more "
     "(it points along -z), or an array [gx, gy, gz]"},
    {"NegativeMass",
     {{"mass = 35", "mass = -35"}},
     {},
     "m.toml:15:8: error: legs.case.mass: is -35 kg, expected 0 or more"},
    {"MasslessPlatform",
     {{"mass = 1500", "mass = 0"}},
     {},
     "m.toml:9:8: error: platform.mass: is 0 kg, expected more than 0"},
    {"TensorNotSymmetric",
     {{"{ xx = 500, yy = 550, zz = 800 }", "[[500, 10, 0], [20, 550, 0], [0, 0, 800]]"}},
     {},
     "m.toml:11:11: error: platform.inertia: is not symmetric: element (1,2) is 10, (2,1) is 20 kg "
     "m^2"},
    {"TensorNotPositive",
     {{"xx = 500, yy = 550", "xx = 500, yy = 550, xy = 600"}},
     {},
     "m.toml:11:11: error: platform.inertia: principal moments -75.5206, 800, 1125.52 kg m^2, "
     "expected all three above 0"},
    {"TensorOfNoBody",
     {{"zz = 800", "zz = 1200"}},
     {},
     "m.toml:11:11: error: platform.inertia: principal moments 500, 550, 1200 kg m^2: no body has "
     "these, expected none above the sum of the other two"},
    {"ZeroRodLength",
     {{"length = 1.05", "length = 0"}},
     {},
     "m.toml:19:10: error: legs.rod.length: is 0 m, expected more than 0"},
    {"ZeroGuideStiffnessOfOneLeg",
     {{R"("4 kN/mm")", "0"}},
     {},
     "m.toml:36:13: error: leg.3.guide_sleeve.stiffness: is 0 N/m, expected more than 0"},
    {"GuideSleeveWithinTheStroke",
     {{"position = 1.0", "position = 0.8"}},
     {},
     "m.toml:24:12: error: legs.guide_sleeve.position: is 0.8 m, expected more than the piston's "
     "position at the end of its stroke, 0.85 m"},
    {"GuideSleeveBeyondTheRod",
     {{"position = 1.0", "position = 1.35"}},
     {},
     "m.toml:24:12: error: legs.guide_sleeve.position: is 1.35 m, expected less than the rod's end "
     "with the piston retracted, 1.3 m"},
    {"RodAsThickAsTheBore",
     {{R"("56 mm")", R"("80 mm")"}},
     {},
     "m.toml:31:16: error: legs.oil_spring.cylinder.rod_diameter: is 0.08 m, expected less than "
     "the bore, 0.08 m"},
    {"NegativeVolume",
     {{"\"100 cm^3\"\nrod", "\"-100 cm^3\"\nrod"}},
     {},
     "m.toml:33:19: error: legs.oil_spring.cylinder.cap_dead_volume: is -0.0001 m^3, expected 0 or "
     "more"},
    {"ChambersWithoutAStroke",
     {{"[legs.stroke]\nretracted = 0.25\nlength = 0.6\n", ""}},
     {},
     "m.toml:26:1: error: legs.oil_spring.cylinder.volumes: \"chambers\" follows the piston and "
     "needs a stroke, expected a table `stroke`, or volumes = \"equal\" with a `control_volume`"},
    {"AirWithoutOil",
     {{"[leg.3.guide",
       "[legs.oil_spring.cylinder.air]\nfraction = 1\npressure = \"70 bar\"\n[leg.3.guide"}},
     {},
     "m.toml:36:12: error: legs.oil_spring.cylinder.air.fraction: is 1, expected less than 1"},
    {"AxialInertiaOfNoBody",
     {{"transverse_inertia = 2", "transverse_inertia = 2\naxial_inertia = 4.5"}},
     {},
     "m.toml:23:17: error: legs.rod.axial_inertia: is 4.5 kg m^2: no body has this, expected no "
     "more than twice the transverse inertia, 4 kg m^2"},
    {"LegWithoutInertia",
     {{"mass = 35", "mass = 0"},
      {"transverse_inertia = 3", "transverse_inertia = 0"},
      {"mass = 22", "mass = 0"},
      {"transverse_inertia = 2", "transverse_inertia = 0"}},
     {},
     "m.toml:22:22: error: legs.rod.transverse_inertia: case and rod have no inertia about their "
     "joints, expected a mass or a transverse inertia for one of them"},
    {"ZeroGimbalAxis",
     {{"[0, 1, 0]", "[0, 0, 0]"}},
     {},
     "m.toml:13:15: error: legs.gimbal_axis: is zero, expected a direction such as [0, 1, 0]"},
    {"JointLimitBeyondHalfATurn",
     {{"[leg.3.guide", "[legs.joint_limits]\nbase = \"190 deg\"\n[leg.3.guide"}},
     {},
     "m.toml:36:8: error: legs.joint_limits.base: is 190 deg, expected no more than 180 deg"},
    {"DampingRatioOfOne",
     {{"[model]", "[damping]\nmodal_ratio = \"100 %\"\n[model]"}},
     {},
     "m.toml:38:15: error: damping.modal_ratio: is 1, expected less than 1"},
    {"FourJointsInOnePlace",
     {{"[leg.3.guide",
       "[leg.1]\nplatform_joint = [-0.7, 0, 0]\n[leg.2]\nplatform_joint = [-0.7, 0, 0]\n"
       "[leg.3]\nplatform_joint = [-0.7, 0, 0]\n[leg.4]\nplatform_joint = [-0.7, 0, "
       "0]\n[leg.3.guide"}},
     {},
     "m.toml:42:18: error: leg.4.platform_joint: legs 1, 2, 3, 4 have their platform joints in one "
     "place, (-0.7, 0, 0) m, expected no more than three legs in a point"},
    {"LegsOnEachOther",
     {{"[leg.3.guide",
       "[leg.3]\nplatform_joint = [-0.7, 0, 0]\nbase_joint = [-1, 0, 0]\n[leg.4]\n"
       "platform_joint = [-0.7, 0, 0]\nbase_joint = [-1, 0, 0]\n[leg.3.guide"}},
     {},
     "m.toml:39:18: error: leg.4.platform_joint: legs 3, 4 have their base joints in one place and "
     "their platform joints too, expected legs along different lines"},
    {"SyntaxError",
     {{"mass = 35", "mass 35"}},
     {},
     "m.toml:15:6: error: not valid TOML in key-value pair: expected '=', saw '3'"},
    {"UnquotedUnit",
     {{"mass = 35", "mass = 35 kg"}},
     {},
     "m.toml:15:11: error: not valid TOML in key-value pair: expected a comment or whitespace, saw "
     "'k'; a number with a unit needs quotes, for instance \"0.5 m\""},
    {"KeyTwice",
     {{"mass = 35", "mass = 35\nmass = 36"}},
     {},
     "m.toml:16:8: error: not valid TOML in key-value pair: cannot redefine existing integer "
     "'mass'"},
    {"OpenString",
     {{R"(name = "Sound")", R"(name = "Sound)"}},
     {},
     "m.toml:1:14: error: not valid TOML in string: unescaped control characters other than TAB "
     "(U+0009) are explicitly prohibited; is its closing quote missing?"},
    {"DottedKeyTooDeep",
     {{"mass = 35",
       "mass.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = "
       "35"}},
     {},
     "m.toml:15:69: error: a dotted key of more than 32 parts"},
    {"BracketsTooDeep",
     {{"mass = 35", "mass = [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["}},
     {},
     "m.toml:15:40: error: brackets nested more than 32 deep"},
    {"UnitWithoutQuotesOrSpace",
     {{"mass = 35", "mass = 35kg"}},
     {},
     "m.toml:15:10: error: not valid TOML in decimal integer: expected digit, saw 'k'; a number "
     "with a unit needs quotes, for instance \"0.5 m\""},
    {"UnitWithoutQuotesInAnArray",
     {{"[0, 0, 0.2]", "[0, 0, 0.2 m]"}},
     {},
     "m.toml:10:26: error: not valid TOML in array: expected comma or closing ']', saw 'm'; a "
     "number with a unit needs quotes, for instance \"0.5 m\""},
};
/// What is wrong with an override of the sound file.
const std::vector<WrongInput> wrong_overrides{
    {"OverrideWithoutEquals",
     {},
     {"platform.mass"},
     "--set platform.mass: error: no \"=\", expected PATH=VALUE such as "
     "legs.guide_sleeve.stiffness=2e6 N/m"},
    {"OverrideWithoutPath",
     {},
     {"=3"},
     "--set =3: error: the part before \"=\" is not a path, expected PATH=VALUE such as "
     "legs.guide_sleeve.stiffness=2e6 N/m"},
    {"OverrideWithoutValue",
     {},
     {"platform.mass="},
     "--set platform.mass=: error: platform.mass: no value after \"=\", write '\"\"' for an empty "
     "string"},
    {"OverrideOfAnUnknownKey",
     {},
     {"legs.guide_sleeve.stifness=2e6 N/m"},
     "--set legs.guide_sleeve.stifness=2e6 N/m: error: legs.guide_sleeve.stifness: unknown key; "
     "did you mean `stiffness`?"},
    {"OverrideWithAWrongUnit",
     {},
     {"platform.mass=3 m"},
     "--set platform.mass=3 m: error: platform.mass: \"3 m\" has the unit \"m\" (a length), "
     "expected a mass such as \"kg\""},
    {"OverrideOutOfRange",
     {},
     {"platform.mass=-3"},
     "--set platform.mass=-3: error: platform.mass: is -3 kg, expected more than 0"},
    {"OverrideOfAnAbsentElement",
     {},
     {"platform.mass_center[3]=1"},
     "--set platform.mass_center[3]=1: error: platform.mass_center[3]: `platform.mass_center` is "
     "an array of 3, counted from 0"},
    {"OverrideOfAnElementOfANumber",
     {},
     {"platform.mass[0]=1"},
     "--set platform.mass[0]=1: error: platform.mass[0]: `platform.mass` is the number 1500, not "
     "an array"},
    {"OverrideBelowANumber",
     {},
     {"platform.mass.x=1"},
     "--set platform.mass.x=1: error: platform.mass.x: `platform.mass` is the number 1500 and has "
     "no keys"},
    {"OverrideOfAnElementOfAnAbsentArray",
     {},
     {"base.mount.inertia[0]=1"},
     "--set base.mount.inertia[0]=1: error: base.mount.inertia[0]: `base.mount.inertia` is not in "
     "the file, which may give these numbers under another path; give the whole array, "
     "\"base.mount.inertia=[…]\""},
    {"OverrideWithABrokenArray",
     {},
     {"platform.mass_center=[0, 0, 0.1 m]"},
     "--set platform.mass_center=[0, 0, 0.1 m]: error: platform.mass_center: not valid TOML in "
     "array: expected comma or closing ']', saw 'm'; a number with a unit needs quotes, for "
     "instance \"0.5 m\""},
    {"OverrideOfTheTensor",
     {},
     {"platform.inertia.zz=2000"},
     "--set platform.inertia.zz=2000: error: platform.inertia: principal moments 500, 550, 2000 kg "
     "m^2: no body has these, expected none above the sum of the other two"},
};
class WrongFile : public testing::TestWithParam<WrongInput> {};

TEST_P(WrongFile, GetsItsMessage) {
  const auto& wrong = GetParam();
  EXPECT_EQ(complaint_about(edited(wrong.edits), wrong.overrides), wrong.message);
}

std::string test_name(const testing::TestParamInfo<WrongInput>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Files, WrongFile, testing::ValuesIn(wrong_files), test_name);
INSTANTIATE_TEST_SUITE_P(Overrides, WrongFile, testing::ValuesIn(wrong_overrides), test_name);

TEST(WrongInputs, AreEditsOfASoundFile) { EXPECT_EQ(complaint_about(sound_machine_file, {}), ""); }

}  // namespace
}  // namespace hydrapod::model
