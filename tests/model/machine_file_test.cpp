/// What the machine file says is what the machine is.

#include "hydrapod/model/machine_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>

#include "sound_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

Machine machine_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_machine(text, "m.toml", overrides).machine;
}

Machine published(const std::string& name) {
  return read_machine_file(test::source_file("models/" + name).string()).machine;
}

TEST(MachineFile, EveryValueOfTheSoundFileIsRead) {
  const Machine machine = machine_of(sound_machine_file);
  EXPECT_EQ(machine.name, "Sound");
  EXPECT_EQ(machine.gravity, Vector3(0, 0, -9.81));
  EXPECT_EQ(machine.platform.mass, 1500.0);
  EXPECT_EQ(machine.platform.mass_center, Vector3(0, 0, 0.2));
  EXPECT_EQ(machine.platform.inertia, Matrix3(Vector3(500, 550, 800).asDiagonal()));
  EXPECT_EQ(machine.flexible_axes, FlexibleAxes::transverse);
  const Leg& leg = machine.legs[4];
  EXPECT_EQ(leg.cylinder_case.mass, 35.0);
  EXPECT_EQ(leg.cylinder_case.mass_center, 0.5);
  EXPECT_EQ(leg.cylinder_case.transverse_inertia, 3.0);
  EXPECT_EQ(leg.rod.length, 1.05);
  EXPECT_EQ(leg.rod.mass, 22.0);
  EXPECT_EQ(leg.rod.mass_center, 0.5);
  EXPECT_EQ(leg.rod.transverse_inertia, 2.0);
  EXPECT_EQ(leg.guide_sleeve.position, 1.0);
  EXPECT_DOUBLE_EQ(leg.guide_sleeve.stiffness, 5e6);
  ASSERT_TRUE(leg.stroke);
  EXPECT_EQ(leg.stroke->retracted, 0.25);
  EXPECT_EQ(leg.stroke->length, 0.6);
  ASSERT_TRUE(leg.oil_spring.cylinder);
  EXPECT_DOUBLE_EQ(leg.oil_spring.cylinder->bore, 0.08);
  EXPECT_DOUBLE_EQ(leg.oil_spring.cylinder->rod_diameter, 0.056);
  EXPECT_DOUBLE_EQ(leg.oil_spring.cylinder->bulk_modulus, 1.4e9);
  EXPECT_DOUBLE_EQ(leg.oil_spring.cylinder->cap_dead_volume, 1e-4);
}

TEST(MachineFile, DefaultsAreThoseDocumented) {
  const Machine machine = machine_of(edited({{"gravity = 9.81", ""}, {"gimbal_axis", "#"}}));
  EXPECT_EQ(machine.gravity, Vector3(0, 0, -9.80665));
  EXPECT_EQ(machine.description, "");
  EXPECT_FALSE(machine.damping.modal_ratio);
  EXPECT_EQ(machine.damping.rayleigh_mass, 0.0);
  EXPECT_EQ(machine.damping.rayleigh_stiffness, 0.0);
  const Leg& leg = machine.legs[0];
  EXPECT_EQ(leg.gimbal_axis, Vector3::UnitY());
  EXPECT_EQ(leg.added_axial_inertia, 0.0);
  EXPECT_EQ(leg.cylinder_case.axial_inertia, 0.0);
  EXPECT_EQ(leg.rod.axial_inertia, 0.0);
  EXPECT_EQ(leg.guide_sleeve.damping, 0.0);
  EXPECT_EQ(leg.oil_spring.damping, 0.0);
  EXPECT_EQ(leg.oil_spring.cylinder->volumes, VolumeRule::chambers);
  EXPECT_EQ(leg.oil_spring.cylinder->cap_line_volume, 0.0);
  EXPECT_FALSE(leg.oil_spring.cylinder->control_volume);
  EXPECT_FALSE(leg.oil_spring.cylinder->air);
  EXPECT_FALSE(leg.piston_ring);
  EXPECT_FALSE(leg.joint_limits.base);
}

TEST(MachineFile, OptionalTablesAreRead) {
  const Machine machine = machine_of(sound_machine_file + R"([damping]
modal_ratio = "2 %"
rayleigh_mass = "0.1 1/s"
rayleigh_stiffness = "3 ms"
[legs.piston_ring]
stiffness = "6 MN/m"
damping = 70
[legs.joint_limits]
base = "30 deg"
platform = 0.6
[legs.oil_spring]
damping = "2 kN s/m"
[legs.oil_spring.cylinder.air]
fraction = 0.01
pressure = "70 bar"
)");
  EXPECT_EQ(machine.damping.modal_ratio, 0.02);
  EXPECT_EQ(machine.damping.rayleigh_mass, 0.1);
  EXPECT_EQ(machine.damping.rayleigh_stiffness, 0.003);
  const Leg& leg = machine.legs[5];
  ASSERT_TRUE(leg.piston_ring);
  EXPECT_EQ(leg.piston_ring->stiffness, 6e6);
  EXPECT_EQ(leg.piston_ring->damping, 70.0);
  EXPECT_DOUBLE_EQ(leg.joint_limits.base.value(), 30 * degree);
  EXPECT_EQ(leg.joint_limits.platform, 0.6);
  EXPECT_EQ(leg.oil_spring.damping, 2000.0);
  ASSERT_TRUE(leg.oil_spring.cylinder->air);
  EXPECT_EQ(leg.oil_spring.cylinder->air->fraction, 0.01);
  EXPECT_DOUBLE_EQ(leg.oil_spring.cylinder->air->pressure, 7e6);
  EXPECT_EQ(leg.oil_spring.cylinder->air->polytropic, 1.4);
}

TEST(MachineFile, OneLegsTableIsLaidOverThatOfAllLegs) {
  const Machine machine = machine_of(sound_machine_file);
  EXPECT_DOUBLE_EQ(machine.legs[2].guide_sleeve.stiffness, 4e6);
  EXPECT_EQ(machine.legs[2].guide_sleeve.position, 1.0);
  for (const int other : {0, 1, 3, 4, 5}) {
    EXPECT_DOUBLE_EQ(machine.legs[other].guide_sleeve.stiffness, 5e6);
  }
}

TEST(MachineFile, OneLegMayHaveTheOtherKindOfOilSpring) {
  const Machine machine =
      machine_of(sound_machine_file + "[leg.2.oil_spring]\nstiffness = \"20 kN/mm\"\n");
  EXPECT_DOUBLE_EQ(machine.legs[1].oil_spring.stiffness.value(), 2e7);
  EXPECT_FALSE(machine.legs[1].oil_spring.cylinder);
  EXPECT_TRUE(machine.legs[0].oil_spring.cylinder);
}

TEST(MachineFile, LegsMayBeGivenOneByOne) {
  std::string text =
      "name = \"x\"\n[platform]\nmass = 9\nmass_center = [0, 0, 0]\n"
      "inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
      "[poses.neutral]\nposition = [0, 0, 1]\n";
  for (int leg = 1; leg <= leg_count; ++leg) {
    const std::string number = std::to_string(leg);
    text += "[leg." + number + "]\nbase_joint = [" + number + ", 0, 0]\nplatform_joint = [0, " +
            number + ", 0]\ncase = { mass = 1, mass_center = 0.1, transverse_inertia = 1 }\n" +
            "rod = { mass = 1, mass_center = 0.1, transverse_inertia = 1, length = 0." + number +
            " }\nguide_sleeve = { position = 0.6, stiffness = 1e6 }\n" +
            "oil_spring.stiffness = " + number + "e7\n";
  }
  const Machine machine = machine_of(text);
  for (int leg = 1; leg <= leg_count; ++leg) {
    EXPECT_EQ(machine.legs[leg - 1].base_joint, Vector3(leg, 0, 0));
    EXPECT_EQ(machine.legs[leg - 1].platform_joint, Vector3(0, leg, 0));
    EXPECT_DOUBLE_EQ(machine.legs[leg - 1].rod.length, 0.1 * leg);
    EXPECT_DOUBLE_EQ(machine.legs[leg - 1].oil_spring.stiffness.value(), 1e7 * leg);
  }
}

TEST(MachineFile, JointsStandOnTheirCircle) {
  const Machine machine = machine_of(sound_machine_file);
  EXPECT_DOUBLE_EQ(machine.legs[0].base_joint.norm(), 1.1);
  EXPECT_DOUBLE_EQ(machine.legs[5].platform_joint.norm(), 0.8);
  // legs 1 and 2 share a base pair, legs 6 and 1 a platform pair
  EXPECT_NEAR((machine.legs[0].base_joint - machine.legs[1].base_joint).norm(), 0.25, 1e-15);
  EXPECT_NEAR((machine.legs[5].platform_joint - machine.legs[0].platform_joint).norm(), 0.25,
              1e-15);
}

TEST(MachineFile, JointsMayBePoints) {
  const Machine machine = machine_of(
      edited({{"circle = { radius = 1.1, spacing = 0.25 }",
               "points = [[1, 0, 0], [\"900 mm\", 0.5, 0], [0, 1, 0], [-1, 0.1, 0], [-1, -0.2, 0],"
               " [0, -1, 0.05]]"}}) +
      "[leg.6]\nbase_joint = [0.3, -1, 0]\n");
  EXPECT_EQ(machine.legs[0].base_joint, Vector3(1, 0, 0));
  EXPECT_EQ(machine.legs[1].base_joint, Vector3(0.9, 0.5, 0));
  EXPECT_EQ(machine.legs[5].base_joint, Vector3(0.3, -1, 0));
}

TEST(MachineFile, TheTensorMayBeGivenEitherWay) {
  const Machine by_name = machine_of(
      edited({{"{ xx = 500, yy = 550, zz = 800 }",
               "{ xx = 500, yy = 550, zz = 800, xy = 10, xz = \"20 kg m^2\", yz = -30 }"}}));
  const Machine by_rows =
      machine_of(edited({{"{ xx = 500, yy = 550, zz = 800 }",
                          "[[500, 10, 20], [10, 550, -30], [20, -30, \"800 kg m^2\"]]"}}));
  EXPECT_EQ(by_name.platform.inertia, by_rows.platform.inertia);
  EXPECT_EQ(by_name.platform.inertia(1, 2), -30.0);
}

/// Each of the nine numbers is known as the moment or product that it is.
TEST(MachineFile, NumbersOfATensorInRowsHaveTheirNames) {
  const auto file = parse_machine(edited({{"{ xx = 500, yy = 550, zz = 800 }",
                                           "[[500, 10, 20], [10, 550, -30], [20, -30, 800]]"}}),
                                  "m.toml");
  std::vector<std::pair<std::string, double>> given;
  for (const auto& number : file.given)
    if (const auto name = path(file.machine, number.id); name.starts_with("platform.inertia"))
      given.emplace_back(name.substr(name.size() - 2), number.value);
  const std::vector<std::pair<std::string, double>> expected{
      {"xx", 500.0}, {"xy", 10.0}, {"xz", 20.0},  {"xy", 10.0}, {"yy", 550.0},
      {"yz", -30.0}, {"xz", 20.0}, {"yz", -30.0}, {"zz", 800.0}};
  EXPECT_EQ(given, expected);
}

TEST(MachineFile, GravityMayBeAVector) {
  const Machine machine = machine_of(edited({{"9.81", "[1, \"20 cm/s^2\", -9]"}}));
  EXPECT_EQ(machine.gravity, Vector3(1, 0.2, -9));
}

TEST(MachineFile, TheGimbalAxisIsMadeAUnitVector) {
  const Machine machine = machine_of(edited({{"[0, 1, 0]", "[3e200, 0, 4e200]"}}));
  EXPECT_LT((machine.legs[0].gimbal_axis - Vector3(0.6, 0, 0.8)).norm(), 1e-15);
}

TEST(MachineFile, NeutralIsTheFirstPoseAndTheOthersKeepTheirOrder) {
  const Machine machine = machine_of(edited({{"[poses.neutral]", "[poses.z_first]"}}) +
                                     "[poses.a_later]\nposition = [0, 0, 1.5]\n"
                                     "[poses.neutral]\nposition = [0, 0, 1.3]\n"
                                     "[poses.\"far left\"]\nposition = [0, 0.1, 1.4]\n");
  std::vector<std::string> names;
  for (const auto& pose : machine.poses) names.push_back(pose.name);
  EXPECT_THAT(names, testing::ElementsAre("neutral", "z_first", "tilted", "a_later", "far left"));
  EXPECT_EQ(machine.neutral().p_BP, Vector3(0, 0, 1.3));
}

TEST(MachineFile, RotationsAreRollPitchYaw) {
  const Machine machine = machine_of(edited({{"[\"10 deg\", 0, 0]", "[\"10 deg\", 0.2, 0.3]"}}));
  const Matrix3 expected = spatial::rotation_from_rpy({10 * degree, 0.2, 0.3});
  EXPECT_LT((machine.poses[1].X_BP.R_BP - expected).norm(), 1e-15);
}

TEST(MachineFile, TenMistakesAreReportedTogether) {
  const std::string text = edited({{"name = \"Sound\"", "name = 7"},
                                   {"gravity = 9.81", "gravity = \"9.81 m\""},
                                   {"mass = 1500", "mass = -1500"},
                                   {"zz = 800", "zz = 1200"},
                                   {"[legs.case]\nmass = 35\n", "[legs.case]\n"},
                                   {"length = 1.05", "lenght = 1.05"},
                                   {"\"56 mm\"", "\"96 mm\""},
                                   {"\"4 kN/mm\"", "0"},
                                   {"\"transverse\"", "\"sideways\""},
                                   {"position = [0, 0, 1.4]", "position = [0, 1.4]"}});
  EXPECT_EQ(
      complaint_about(text),
      "m.toml:1:8: error: name: is the number 7, expected a string\n"
      "m.toml:3:11: error: environment.gravity: \"9.81 m\" has the unit \"m\" (a length), expected "
      "an acceleration such as \"m/s^2\"\n"
      "m.toml:9:8: error: platform.mass: is -1500 kg, expected more than 0\n"
      "m.toml:11:11: error: platform.inertia: principal moments 500, 550, 1200 kg m^2: no body has "
      "these, expected none above the sum of the other two\n"
      "m.toml:14:1: error: legs.case.mass: required value (a mass, as a number in kg or a string "
      "such as \"0.5 kg\") is missing\n"
      "m.toml:18:1: error: legs.rod.lenght: unknown key; did you mean `length`?\n"
      "m.toml:30:16: error: legs.oil_spring.cylinder.rod_diameter: is 0.096 m, expected less than "
      "the bore, 0.08 m\n"
      "m.toml:35:13: error: leg.3.guide_sleeve.stiffness: is 0 N/m, expected more than 0\n"
      "m.toml:37:17: error: model.flexible_axes: is the string \"sideways\", expected "
      "\"transverse\" or \"gimbal\"\n"
      "m.toml:39:12: error: poses.neutral.position: is an array of 2, expected an array of 3 "
      "numbers in m");
}

TEST(MachineFile, MistakesOfTheFileAndOfOverridesComeTogether) {
  EXPECT_EQ(complaint_about(edited({{"mass = 35", "mass = -35"}}),
                            {"platform.mass=-3", "legs.rod.lenght=2"}),
            "m.toml:15:8: error: legs.case.mass: is -35 kg, expected 0 or more\n"
            "--set platform.mass=-3: error: platform.mass: is -3 kg, expected more than 0\n"
            "--set legs.rod.lenght=2: error: legs.rod.lenght: unknown key; did you mean `length`?");
}

TEST(MachineFile, AMistakeOfAllLegsIsReportedOnceEvenIfOneLegDiffers) {
  EXPECT_EQ(complaint_about(edited({{"stiffness = \"5 kN/mm\"", "stiffness = 0"}})),
            "m.toml:25:13: error: legs.guide_sleeve.stiffness: is 0 N/m, expected more than 0");
}

TEST(MachineFile, ThousandsOfMistakesAreCutShort) {
  std::string text = sound_machine_file;
  for (int i = 0; i < 1000; ++i) text += "key" + std::to_string(i) + " = 1\n";
  try {
    parse_machine(text, "m.toml");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.diagnostics().size(), 101u);
    EXPECT_EQ(error.diagnostics().back().text(), "m.toml: error: and 900 more errors");
  }
}

TEST(MachineFile, FindingsOfACheckGetTheirPlaces) {
  const auto place = [](const std::string& key) {
    const Check check = [&](const Machine&) {
      return std::vector<Finding>{{base::Severity::warning, key, "hm"}};
    };
    const auto file =
        parse_machine(sound_machine_file, "m.toml", {"poses.high.position=[0,0,1.5]"}, check);
    return file.warnings.at(0).text();
  };
  EXPECT_EQ(place("poses.tilted"), "m.toml:41:1: warning: poses.tilted: hm");
  EXPECT_EQ(place("poses.tilted.position"), "m.toml:42:12: warning: poses.tilted.position: hm");
  EXPECT_EQ(place("poses.high"), "--set poses.high.position=[0,0,1.5]: warning: poses.high: hm");
  EXPECT_EQ(place("legs.rod.length"), "m.toml:19:10: warning: legs.rod.length: hm");
  EXPECT_EQ(place("leg.2.rod.length"), "m.toml:19:10: warning: leg.2.rod.length: hm");
  EXPECT_EQ(place("leg.3.guide_sleeve.stiffness"),
            "m.toml:36:13: warning: leg.3.guide_sleeve.stiffness: hm");
  EXPECT_EQ(place("leg.3.guide_sleeve.position"),
            "m.toml:24:12: warning: leg.3.guide_sleeve.position: hm");
  EXPECT_EQ(place("leg.3.piston_ring.stiffness"),
            "m.toml:35:1: warning: leg.3.piston_ring.stiffness: hm");
  EXPECT_EQ(place("leg.4.base_joint"), "m.toml:5:10: warning: leg.4.base_joint: hm");
  EXPECT_EQ(place("platform.mass_center[2]"), "m.toml:10:22: warning: platform.mass_center[2]: hm");
  EXPECT_EQ(place("damping.modal_ratio"), "m.toml:1:1: warning: damping.modal_ratio: hm");
}

TEST(MachineFile, NumbersThatHaveNoEffectWithoutAnotherAreNamed) {
  const auto warnings = [](const std::vector<std::string>& overrides) {
    std::vector<std::string> texts;
    for (const auto& warning : parse_machine(sound_machine_file, "m.toml", overrides).warnings)
      texts.push_back(warning.key + ": " + warning.message);
    return texts;
  };
  const std::string elastomer =
      "legs.guide_sleeve.elastomer={ dynamic_ratio = 1.7, loss_factor = 0.13, frequency = 11";
  using testing::ElementsAre, testing::IsEmpty;
  EXPECT_THAT(warnings({"legs.guide_sleeve.guide_stiffness=3e7"}),
              ElementsAre("legs.guide_sleeve.guide_stiffness: has no effect without "
                          "`legs.guide_sleeve.gap`"));
  EXPECT_THAT(warnings({"legs.guide_sleeve.guide_stiffness=3e7", "legs.guide_sleeve.gap=2e-4"}),
              IsEmpty());
  EXPECT_THAT(warnings({"leg.2.guide_sleeve.guide_stiffness=3e7", "leg.1.guide_sleeve.gap=2e-4"}),
              ElementsAre("leg.2.guide_sleeve.guide_stiffness: has no effect without "
                          "`leg.2.guide_sleeve.gap`"));
  // shared by all, used by one
  EXPECT_THAT(warnings({"legs.guide_sleeve.guide_stiffness=3e7", "leg.4.guide_sleeve.gap=2e-4"}),
              IsEmpty());
  EXPECT_THAT(warnings({elastomer + ", softening_amplitude = 2e-4 }"}),
              ElementsAre("legs.guide_sleeve.elastomer.softening_amplitude: has no effect without "
                          "`legs.guide_sleeve.elastomer.softening`"));
  EXPECT_THAT(warnings({elastomer + ", softening_amplitude = 2e-4, softening = 0.3 }"}), IsEmpty());
  EXPECT_THAT(warnings({elastomer + ", softening_time = 0.7 }"}),
              ElementsAre("legs.guide_sleeve.elastomer.softening_time: has no effect without "
                          "`legs.guide_sleeve.elastomer.softening`"));
  EXPECT_THAT(warnings({elastomer + ", softening_time = 0.7, softening = 0.3 }"}), IsEmpty());
  EXPECT_THAT(warnings({"legs.friction.stribeck_velocity=0.03"}),
              ElementsAre("legs.friction.stribeck_velocity: has no effect without "
                          "`legs.friction.coulomb`"));
  EXPECT_THAT(warnings({"legs.joint_friction.smoothing_rate=0.02"}),
              ElementsAre("legs.joint_friction.smoothing_rate: has no effect without "
                          "`legs.joint_friction.coulomb`"));
  EXPECT_THAT(warnings({"legs.joint_friction.coulomb=40", "legs.joint_friction.bristle_damping=9"}),
              ElementsAre("legs.joint_friction.bristle_damping: has no effect without "
                          "`legs.joint_friction.bristle_stiffness`"));
  EXPECT_THAT(
      warnings({"lines.viscosity=0.03"}),
      ElementsAre("lines.viscosity: has no effect without `lines.segments` or `lines.modes`"));
  EXPECT_THAT(warnings({"supply.line_volume=0.003"}),
              ElementsAre("supply.line_volume: has no effect without `supply.pump_flow`"));
  EXPECT_THAT(warnings({"supply.line_volume=0.003", "supply.pump_flow=0.002"}), IsEmpty());
}

TEST(MachineFile, PosesWithAnyNameAreFound) {
  const Check check = [](const Machine& machine) {
    return std::vector<Finding>{
        {base::Severity::error, "poses." + machine.poses[2].name, "singular"}};
  };
  try {
    parse_machine(sound_machine_file + "[poses.\"far left\"]\nposition = [0, 0, 1]\n", "m.toml", {},
                  check);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(), "m.toml:44:1: error: poses.far left: singular");
  }
}

TEST(MachineFile, ACheckIsNotAskedAboutAMachineThatCouldNotBeRead) {
  const Check check = [](const Machine&) -> std::vector<Finding> {
    throw std::logic_error("asked");
  };
  EXPECT_THROW(parse_machine(edited({{"mass = 35", "mass = true"}}), "m.toml", {}, check),
               base::InputError);
  EXPECT_THROW(parse_machine(sound_machine_file, "m.toml", {}, check), std::logic_error);
}

TEST(MachineFile, KeepsTextAndOverrides) {
  const auto file = parse_machine(sound_machine_file, "m.toml", {"platform.mass=3 t"});
  EXPECT_EQ(file.text, sound_machine_file);
  EXPECT_THAT(file.overrides, testing::ElementsAre("platform.mass=3 t"));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(StarterFile, IsSound) {
  const auto file = parse_machine(starter_machine_file(), "starter.toml");
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(file.machine.platform.mass, 1500.0);
  EXPECT_EQ(file.machine.gravity, Vector3(0, 0, -9.80665));
  EXPECT_DOUBLE_EQ(file.machine.legs[0].oil_spring.cylinder->cap_line_volume, 1.5e-4);
  ASSERT_EQ(file.machine.poses.size(), 3u);
  EXPECT_EQ(file.machine.poses[1].name, "high");
}

/// The commented-out lines are TOML that works, not prose that has grown old.
TEST(StarterFile, IsSoundWithItsOptionalKeysToo) {
  const std::regex option(R"re(# (\[[a-z0-9_.]+\]|[a-z_]+ = ).*)re");
  const std::string other_spring =
      "# stiffness = \"20 kN/mm\"                # k_h";  // beside the table `cylinder`
  std::string text;
  std::istringstream lines(starter_machine_file());
  for (std::string line; std::getline(lines, line);) {
    const bool taken = std::regex_match(line, option) && line != other_spring;
    text += (taken ? line.substr(2) : line) + '\n';
  }
  const Machine machine = machine_of(text);
  EXPECT_TRUE(machine.legs[0].piston_ring);
  EXPECT_TRUE(machine.legs[0].oil_spring.cylinder->air);
  EXPECT_TRUE(machine.damping.modal_ratio);
  EXPECT_EQ(machine.legs[2].base_joint, Vector3(-1.1, 0.1, 0));
  EXPECT_DOUBLE_EQ(machine.legs[2].guide_sleeve.stiffness, 2e6);
}

/// The text of docs/howto/machine-file.md.
std::string manual() { return test::read_text(test::source_file("docs/howto/machine-file.md")); }

TEST(Manual, ItsExamplesAreSound) {
  const std::string text = manual();
  const std::string fence = "```toml\n";
  std::string together;
  for (auto at = text.find(fence); at != std::string::npos; at = text.find(fence, at + 1)) {
    const auto begin = at + fence.size();
    together += text.substr(begin, text.find("```", begin) - begin);
    EXPECT_EQ(complaint_about(together), "");
  }
  EXPECT_DOUBLE_EQ(machine_of(together).legs[2].guide_sleeve.stiffness, 2e6);
}

TEST(Manual, ExplainsEveryKeyOfTheStarterFile) {
  const std::string text = manual();
  const std::string starter = starter_machine_file();
  const std::regex key(R"re((?:^|\n)(?:# )?([a-z_]+) = )re");
  for (auto match = std::sregex_iterator(starter.begin(), starter.end(), key);
       match != std::sregex_iterator(); ++match) {
    const std::string name = (*match)[1];
    EXPECT_TRUE(std::regex_search(text, std::regex("`" + name + "( = |`)"))) << name;
  }
}

/// Printed values exactly; identified ones to the digits that are known of them.
TEST(PublishedMachine, HasThePrintedAndTheIdentifiedValues) {
  const Machine machine = published("zhang-jiang-2021.toml");
  EXPECT_EQ(machine.gravity, Vector3::Zero());
  EXPECT_EQ(machine.flexible_axes, FlexibleAxes::gimbal);
  EXPECT_EQ(machine.platform.mass, 894.0);
  EXPECT_EQ(machine.platform.mass_center, Vector3(0, 0, -0.163));
  const Matrix3 inertia = Vector3(45.10, 45.10, 54.53).asDiagonal();
  EXPECT_LT((machine.platform.inertia - inertia).cwiseAbs().maxCoeff(), 0.005);
  for (const Leg& leg : machine.legs) {
    EXPECT_EQ(leg.guide_sleeve.stiffness, 157320.0);
    EXPECT_NEAR(leg.oil_spring.stiffness.value(), 3.8535e6, 0.00005e6);
    EXPECT_NEAR(leg.cylinder_case.mass, 7.207, 0.0005);
    EXPECT_NEAR(leg.cylinder_case.mass_center, 0.1602, 0.00005);
    EXPECT_NEAR(leg.cylinder_case.transverse_inertia, 0.2627, 0.00005);
    EXPECT_NEAR(leg.cylinder_case.axial_inertia, 0.0035, 0.00005);
    EXPECT_NEAR(leg.rod.mass, 1.620, 0.0005);
    EXPECT_NEAR(leg.rod.mass_center, 0.183, 0.0005);
    EXPECT_NEAR(leg.rod.transverse_inertia, 0.3051, 0.00005);
    EXPECT_NEAR(leg.rod.axial_inertia, 0.0084, 0.00005);
    EXPECT_EQ(leg.gimbal_axis, Vector3::UnitY());
    EXPECT_FALSE(leg.piston_ring);
  }
}

/// The law of cosines between the joints' angles gives the length without any joint coordinates.
TEST(PublishedMachine, PistonAndGuideSleeveStandWhereTheyWereIdentified) {
  const double r = 0.4, r_b = 0.5995, spacing = 0.17, height = 0.783;
  const double angle =
      std::numbers::pi / 3 - std::asin(spacing / (2 * r)) - std::asin(spacing / (2 * r_b));
  const double l = std::sqrt(r * r + r_b * r_b - 2 * r * r_b * std::cos(angle) + height * height);
  const Machine machine = published("zhang-jiang-2021.toml");
  for (const Leg& leg : machine.legs) {
    EXPECT_NEAR((machine.neutral() * leg.platform_joint - leg.base_joint).norm(), l, 1e-15);
    EXPECT_NEAR(l - leg.rod.length, 0.488, 1e-15);                                   // l_m
    EXPECT_NEAR(leg.guide_sleeve.position - (l - leg.rod.length), 0.060665, 1e-15);  // l_mh
  }
}

TEST(PublishedMachine, WithTransverseAxesIsTheSameOtherwise) {
  const Machine gimbal = published("zhang-jiang-2021.toml");
  const Machine transverse = published("zhang-jiang-2021-transverse.toml");
  EXPECT_EQ(transverse.flexible_axes, FlexibleAxes::transverse);
  EXPECT_EQ(transverse.platform.inertia, gimbal.platform.inertia);
  EXPECT_EQ(transverse.legs[3].rod.length, gimbal.legs[3].rod.length);
  EXPECT_EQ(transverse.legs[3].base_joint, gimbal.legs[3].base_joint);
  EXPECT_EQ(transverse.legs[3].guide_sleeve.stiffness, gimbal.legs[3].guide_sleeve.stiffness);
  EXPECT_EQ(transverse.neutral().p_BP, gimbal.neutral().p_BP);
}

}  // namespace
}  // namespace hydrapod::model
