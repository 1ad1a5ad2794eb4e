/// Legs that are no hydraulic cylinders: what a file says of them, and what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/parameters.hpp"
#include "sound_machine.hpp"
#include "support/other_legs.hpp"

namespace hydrapod::model {
namespace {

using test::around_the_legs;
using test::screw_file;
using test::strut_file;
using testing::HasSubstr;

TEST(LegTypes, AStrutIsStiffnessAndDampingAlone) {
  const Machine machine = test::machine_of(strut_file);
  EXPECT_EQ(leg_type(machine), LegType::strut);
  for (const Leg& leg : machine.legs) {
    EXPECT_DOUBLE_EQ(leg.strut.value().stiffness, 17.3e6);
    EXPECT_DOUBLE_EQ(leg.strut->damping, 2.7e3);
    EXPECT_EQ(leg.rod.mass + leg.cylinder_case.mass + leg.guide_sleeve.stiffness, 0.0);
    EXPECT_FALSE(leg.oil_spring.stiffness || leg.oil_spring.cylinder);
  }
  EXPECT_TRUE(has_leg_dampers(machine));
}

TEST(LegTypes, AScrewStandsInPlaceOfTheOil) {
  const Machine machine = test::machine_of(screw_file);
  EXPECT_EQ(leg_type(machine), LegType::screw);
  const Screw& screw = machine.legs[4].screw.value();
  EXPECT_DOUBLE_EQ(screw.lead, 0.0117);
  EXPECT_NEAR(screw.speed_limit.value(), 303.68728984701335, 1e-9);  // 2900 rpm
  EXPECT_NEAR(screw.reflected_mass(), 0.0043 * 288395.19033061166, 1e-6);
  EXPECT_EQ(machine.legs[4].rod.mass, 21.3);
}

TEST(LegTypes, TheSpeedLoopOfADriveHasKeys) {
  const auto screws = [](const std::vector<std::string>& overrides) {
    return parse_machine(screw_file, "m.toml", overrides).machine.legs;
  };
  EXPECT_EQ(screws({})[1].screw->speed_bandwidth, 50.0);
  EXPECT_FALSE(screws({})[1].screw->speed_integral_time);
  const auto set =
      screws({"legs.screw.speed_bandwidth=80 Hz", "leg.2.screw.speed_integral_time=7 ms"});
  EXPECT_DOUBLE_EQ(set[5].screw->speed_bandwidth, 80.0);
  EXPECT_DOUBLE_EQ(set[1].screw->speed_integral_time.value(), 0.007);
  EXPECT_FALSE(set[0].screw->speed_integral_time);
  EXPECT_THAT(complaint_about(screw_file, {"legs.screw.speed_bandwidth=0"}),
              HasSubstr("legs.screw.speed_bandwidth: is 0 Hz, expected more than 0"));
}

/// Parameters are those of the legs that the machine has.
TEST(LegTypes, HaveTheirOwnParameters) {
  const auto names = [](const std::string& text) {
    const Machine machine = test::machine_of(text);
    std::vector<std::string> all;
    for (const auto& id : parameters(machine)) all.push_back(path(machine, id));
    return all;
  };
  const auto strut = names(strut_file), screw = names(screw_file),
             cylinder = names(sound_machine_file);
  EXPECT_THAT(strut, testing::Contains("legs.strut.stiffness"));
  EXPECT_THAT(strut, testing::Contains("leg.3.strut.damping"));
  for (const char* of_others :
       {"legs.rod.mass", "legs.guide_sleeve.stiffness", "legs.valve.overlap", "legs.screw.lead"})
    EXPECT_THAT(strut, testing::Not(testing::Contains(of_others)));
  EXPECT_THAT(screw, testing::Contains("legs.screw.lead"));
  EXPECT_THAT(screw, testing::Contains("legs.rod.mass"));
  EXPECT_THAT(screw, testing::Not(testing::Contains("legs.oil_spring.damping")));
  EXPECT_THAT(cylinder, testing::Not(testing::Contains("legs.strut.stiffness")));
  EXPECT_THAT(cylinder, testing::Not(testing::Contains("legs.screw.lead")));
}

TEST(LegTypes, SetChangesAStrut) {
  const auto file = parse_machine(strut_file, "m.toml", {"leg.2.strut.stiffness=9 kN/mm"});
  EXPECT_DOUBLE_EQ(file.machine.legs[1].strut->stiffness, 9e6);
  EXPECT_DOUBLE_EQ(file.machine.legs[0].strut->stiffness, 17.3e6);
  const auto id = find_parameter(file, "legs.strut.stiffness");
  ASSERT_TRUE(id);
  EXPECT_EQ(with(file.machine, std::array{Assignment{*id, 5.0}}).legs[5].strut->stiffness, 5.0);
}

TEST(LegTypes, TakeNoNumbersOfOtherLegs) {
  const auto cylinder = parse_machine(sound_machine_file, "m.toml").machine;
  const auto strut = test::machine_of(strut_file), screw = test::machine_of(screw_file);
  const auto assigned = [](Machine machine, const std::string& path) {
    const auto id = find_parameter(machine, path).value();
    assign(machine, std::array{Assignment{id, 1e6}});
  };
  for (const char* path : {"legs.rod.mass", "leg.2.oil_spring.stiffness", "legs.screw.lead"})
    EXPECT_THROW(assigned(strut, path), std::invalid_argument) << path;
  for (const char* path :
       {"legs.oil_spring.stiffness", "leg.3.strut.damping", "legs.valve.overlap"})
    EXPECT_THROW(assigned(screw, path), std::invalid_argument) << path;
  for (const char* path : {"legs.strut.stiffness", "leg.4.screw.inertia"})
    EXPECT_THROW(assigned(cylinder, path), std::invalid_argument) << path;
  EXPECT_NO_THROW(assigned(screw, "legs.rod.mass"));
}

/// Nothing on struts has inertia but the base: it needs it in every direction in which it moves.
TEST(LegTypes, ABaseUnderStrutsHasInertiaWhereItMovesOrNone) {
  const auto complaint = [](const std::string& mount) {
    return complaint_about(strut_file, {"base.mount={" + mount + "}"});
  };
  const std::string springs = "stiffness={x=1e8,rz=3e8}";
  EXPECT_EQ(complaint(springs), "");
  EXPECT_EQ(complaint(springs + ",mass=213,inertia=[0,0,71]"), "");
  EXPECT_THAT(complaint(springs + ",mass=213"), HasSubstr("base.mount.inertia: is 0 where the base "
                                                          "has a spring"));
  EXPECT_THAT(complaint(springs + ",inertia=[1,1,7]"), HasSubstr("base.mount.mass: is 0 where"));
}

struct Wrong {
  std::string name, text;
  std::vector<std::string> overrides;
  std::string message;
};

class WrongLegs : public testing::TestWithParam<Wrong> {};

TEST_P(WrongLegs, AreRefusedInOneMessage) {
  EXPECT_EQ(complaint_about(GetParam().text, GetParam().overrides), GetParam().message);
}

const std::string strut_beside =
    "expected either the one or the other: a plain strut has no other "
    "parts; all six legs are alike";
const std::string screw_beside =
    "expected either the one or the other: an electric cylinder has no "
    "oil and no valve; all six legs are alike";

INSTANTIATE_TEST_SUITE_P(
    Files, WrongLegs,
    testing::Values(
        Wrong{"StrutBesideACylinder",
              edited({{"[legs.oil_spring", "[legs.strut]\nstiffness = 1e7\n[legs.oil_spring"}}),
              {},
              "m.toml:29:1: error: legs.strut: is given beside `case`, `rod`, `guide_sleeve`, "
              "`oil_spring` and `stroke`, " +
                  strut_beside},
        Wrong{"SetMakesNoStrutOfACylinder",
              sound_machine_file,
              {"legs.strut.stiffness=1e7"},
              "--set legs.strut.stiffness=1e7: error: legs.strut: is given beside `case`, `rod`, "
              "`guide_sleeve`, `oil_spring` and `stroke`, " +
                  strut_beside},
        Wrong{"OneStrutAmongCylinders",
              edited({{"[leg.3.guide_sleeve]\nstiffness = \"4 kN/mm\"",
                       "[leg.3.strut]\nstiffness = 1e7"}}),
              {},
              "m.toml:35:1: error: leg.3.strut: is given beside `case`, `rod`, `guide_sleeve`, "
              "`oil_spring` and `stroke`, " +
                  strut_beside},
        Wrong{"ACaseAmongStruts",
              strut_file + "[leg.4.case]\nmass = 3\n",
              {},
              "m.toml:17:1: error: legs.strut: is given beside `case`, " + strut_beside},
        Wrong{"AValveOfAStrut",
              strut_file + "[legs.valve]\noverlap = 0.01\n",
              {},
              "m.toml:17:1: error: legs.strut: is given beside `valve`, " + strut_beside},
        Wrong{"AStrutWithoutStiffness",
              around_the_legs + "[legs.strut]\ndamping = 3\n",
              {},
              "m.toml:17:1: error: legs.strut.stiffness: required value (a stiffness, as a number "
              "in N/m or a string such as \"0.5 N/m\", or \"rigid\") is missing"},
        Wrong{"AStrutThatPushesAway",
              strut_file,
              {"legs.strut.stiffness=-2"},
              "--set legs.strut.stiffness=-2: error: legs.strut.stiffness: is -2 N/m, expected "
              "more than 0"},
        Wrong{"ChambersOfStruts",
              strut_file,
              {"damping.oil=chambers"},
              "--set damping.oil=chambers: error: damping.oil: is \"chambers\", and a plain strut "
              "has none, expected \"viscous\""},
        Wrong{"AScrewBesideOil",
              screw_file + "[legs.oil_spring]\nstiffness = 1e7\n[legs.valve]\noverlap = 0\n",
              {},
              "m.toml:33:1: error: legs.screw: is given beside `oil_spring` and `valve`, " +
                  screw_beside},
        Wrong{"AScrewWithoutLead",
              screw_file,
              {"legs.screw.lead=0"},
              "--set legs.screw.lead=0: error: legs.screw.lead: is 0 m, expected more than 0"},
        Wrong{"MoreFrictionThanTorque",
              screw_file,
              {"legs.screw.friction_torque=40"},
              "--set legs.screw.friction_torque=40: error: legs.screw.friction_torque: is 40 N m, "
              "expected less than the torque limit, 37 N m"}),
    [](const auto& test) { return test.param.name; });

/// In a Machine that was made in a program.
TEST(LegTypes, AMixIsUnsound) {
  Machine machine = test::machine_of(strut_file);
  machine.legs[3].strut.reset();
  machine.legs[3].screw = Screw{.stiffness = 1e7, .lead = 0.01, .inertia = 0.004};
  const auto findings = validate(machine);
  EXPECT_TRUE(std::ranges::any_of(findings, [](const Finding& finding) {
    return finding.key == "leg.4.screw" &&
           finding.message ==
               "makes this leg of the type electric cylinder, and leg 1 is a plain "
               "strut; expected six legs of one type";
  }));
}

/// The lead is a way per revolution, not per radian.
TEST(LegTypes, ALeadIsALength) {
  EXPECT_THAT(complaint_about(screw_file, {"legs.screw.lead=2 mm/rad"}),
              testing::AllOf(testing::StartsWith("--set legs.screw.lead=2 mm/rad: error: "
                                                 "legs.screw.lead: "),
                             HasSubstr("expected a length")));
}

TEST(LegTypes, AMissingTableSaysWhatWouldDoToo) {
  EXPECT_THAT(complaint_about(around_the_legs + "[legs]\ngimbal_axis = [0, 1, 0]\n"),
              HasSubstr("legs.case: required table [legs.case] is missing; a plain strut, "
                        "[legs.strut], in place of all parts of a cylinder would do too"));
}

/// The model has them in all legs or in none.
TEST(LegTypes, PistonRingsOfSomeLegsOnlyAreNamed) {
  const auto warnings = [](const std::vector<std::string>& overrides) {
    std::vector<std::string> texts;
    for (const auto& warning : parse_machine(sound_machine_file, "m.toml", overrides).warnings)
      texts.push_back(warning.text());
    return texts;
  };
  const std::string ring = ".piston_ring={ stiffness = 3e7 }";
  EXPECT_THAT(
      warnings({"leg.2" + ring}),
      testing::ElementsAre(
          "--set leg.2.piston_ring={ stiffness = 3e7 }: warning: leg.2.piston_ring: has no effect, "
          "since legs 1, 3, 4, 5, 6 have no piston ring: the model is that of the guide sleeves "
          "alone; give all legs a ring (legs.piston_ring), a stiff one where there is none, or "
          "take this one out"));
  EXPECT_THAT(
      warnings({"leg.1" + ring, "leg.2" + ring, "leg.3" + ring, "leg.4" + ring, "leg.6" + ring}),
      testing::ElementsAre(HasSubstr("since leg 5 has no piston ring")));
  EXPECT_THAT(warnings({"legs" + ring}), testing::IsEmpty());
}

}  // namespace
}  // namespace hydrapod::model
