/// `hydrapod check`: what follows from a machine file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/json_fields.hpp"
#include "support/other_legs.hpp"

namespace hydrapod {
namespace {
using test::fields;
using test::Json;
using test::json_of;
using test::run_hydrapod;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::string published_model = test::source_file("models/zhang-jiang-2021.toml").string();
const std::string transverse_model =
    test::source_file("models/zhang-jiang-2021-transverse.toml").string();
const std::string heavy_model = test::source_file("models/heavy-platform.toml").string();

TEST(Check, TableSaysWhatFollows) {
  const auto result = run_hydrapod({"check", published_model});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out,
              AllOf(testing::StartsWith("Zhang & Jiang 2021\n"),
                    testing::EndsWith("\nSound at pose neutral.\n"),
                    HasSubstr("mass of the platform 894 kg, of all legs 52.96 kg; no gravity\n"),
                    HasSubstr("873.4"), HasSubstr("Jacobian: condition 2.91"),
                    HasSubstr("Buckling: not computed without gravity.\n"), Not(HasSubstr("-0 ")),
                    Not(HasSubstr("\033"))));
}

TEST(Check, JsonHasItsStableFields) {
  const auto json = json_of({"check", heavy_model, "--format", "json"});
  EXPECT_THAT(fields(json),
              ElementsAre("kind", "machine", "assumptions", "sound", "unusual_numbers",
                          "simulation_assumptions", "poses", "reproduction"));
  EXPECT_EQ(json["kind"], "check");
  EXPECT_EQ(json["poses"].size(), 4U);
  const Json& pose = json["poses"][0];
  EXPECT_THAT(fields(pose), ElementsAre("pose", "condition", "characteristic_length_m",
                                        "equilibrium", "legs", "buckling", "first_resonance_rad_s",
                                        "capability", "sound", "warnings", "findings"));
  EXPECT_EQ(pose["pose"]["name"], "neutral");
  EXPECT_EQ(pose["legs"].size(), 6U);
  EXPECT_THAT(
      fields(pose["legs"][0]),
      ElementsAre("length_m", "piston_m", "guided_length_m", "oil_stiffness_N_m", "axial_force_N",
                  "static_tilt_rad", "sleeve_offset_m", "base_joint_tilt_rad",
                  "platform_joint_tilt_rad", "retract_left_m", "extend_left_m", "cap_pressure_Pa",
                  "rod_pressure_Pa", "largest_push_N", "largest_pull_N", "column"));
  EXPECT_THAT(fields(pose["buckling"]),
              ElementsAre("status", "payload_kg", "limit_point", "lowest_omega_rad_s"));
  EXPECT_EQ(pose["buckling"]["status"], "found");
}

TEST(Check, SaysWhatSimulationAssumes) {
  const auto table = run_hydrapod({"check", published_model});
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("Assumed values for simulations\n"),
                    HasSubstr("  legs.equivalent_cylinder: A_p = 6.99 cm^2 (a sixth of the supply "
                              "pressure carries the platform), e = 0.5, 0.158 l in both chambers"),
                    HasSubstr("  legs.valve.rated_flow: 21 l/min at full opening")));
  // the area that carries the platform has chambers that are shorter than this stroke
  const auto roomy = run_hydrapod({"check", published_model, "--set",
                                   "legs.stroke={ retracted = 0.36, length = 0.185 }", "--set",
                                   "legs.equivalent_cylinder.bulk_modulus=0.3 GPa"});
  EXPECT_THAT(roomy.out, AllOf(HasSubstr("A_p = 10.5 cm^2 (chambers as long as the stroke; "),
                               Not(HasSubstr("supply pressure carries the platform"))));
  const auto json = json_of({"check", published_model, "--format", "json", "--set",
                             "leg.2.valve.rated_flow=30 l/min", "--set",
                             "legs.friction={ coulomb = 90, viscous = 0 }"});
  std::vector<std::string> keys;
  for (const Json& one : json["simulation_assumptions"]) keys.push_back(one["key"]);
  EXPECT_THAT(keys, AllOf(testing::Contains("leg.1.valve.rated_flow"),
                          Not(testing::Contains("leg.2.valve.rated_flow")),
                          Not(testing::Contains("legs.friction.coulomb")),
                          testing::Contains("legs.stroke")));
}

TEST(Check, LegsAddUp) {
  const auto json = json_of({"check", heavy_model, "--pose", "pitched", "--format", "json"});
  ASSERT_EQ(json["poses"].size(), 1U);
  for (const Json& leg : json["poses"][0]["legs"]) {
    const double piston = leg["piston_m"], length = leg["length_m"];
    EXPECT_NEAR(length - piston, 1.15, 1e-12) << "the rod";
    EXPECT_NEAR(leg["guided_length_m"].get<double>() + piston, 1.25, 1e-12) << "the sleeve";
    EXPECT_NEAR(leg["retract_left_m"].get<double>() + leg["extend_left_m"].get<double>(), 0.86,
                1e-12)
        << "the stroke";
    EXPECT_GT(leg["axial_force_N"].get<double>(), 0.0) << "compression";
  }
}

/// Six legs carry the platform and part of their own weight.
TEST(Check, ForcesCarryTheWeight) {
  const auto json = json_of({"check", heavy_model, "--format", "json"});
  double up = 0.0;
  for (const Json& leg : json["poses"][0]["legs"]) up += leg["axial_force_N"].get<double>();
  const double weight = 14000.0 * 9.80665;
  EXPECT_GT(up, weight);  // legs stand aslant
  EXPECT_LT(up, 1.5 * weight);
}

/// The published file states no stroke: it may be at such a pose.
TEST(Check, AnswersBeyondAssumedStops) {
  const auto result = run_hydrapod({"check", transverse_model, "--pose", "z=-240 mm"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("Lowest mode: "), Not(HasSubstr("position loop")),
                                testing::EndsWith("\nSound at pose z=-240 mm.\n")));
}

TEST(Check, NamesThePayloadAtWhichTheLegsFold) {
  const auto light = json_of({"check", published_model, "--set", "environment.gravity=9.81",
                              "--set", "model.flexible_axes=transverse", "--format", "json"});
  const Json& buckling = light["poses"][0]["buckling"];
  ASSERT_EQ(buckling["status"], "found");
  const double payload = buckling["payload_kg"];
  EXPECT_GT(payload, 0.0);
  const auto table = run_hydrapod({"check", published_model, "--set", "environment.gravity=9.81",
                                   "--set", "model.flexible_axes=transverse"});
  EXPECT_THAT(table.out, HasSubstr("Buckling load: "));

  // with this payload the machine names the mass to remove
  const auto loaded = run_hydrapod({"check", published_model, "--set", "environment.gravity=9.81",
                                    "--set", "model.flexible_axes=transverse", "--set",
                                    "platform.mass=" + std::to_string(894.0 + 1.01 * payload)});
  EXPECT_EQ(loaded.exit_code, 1);
  EXPECT_EQ(loaded.err, "error: the machine is not sound\n");
  EXPECT_THAT(loaded.out,
              AllOf(testing::EndsWith("\nNot sound: the legs buckle at pose neutral.\n"),
                    HasSubstr("Buckling: the legs buckle under the present load; they carry "),
                    HasSubstr("warning: the legs buckle under the present load: remove ")));
}

/// Elastomers carry a load for long with their static stiffness alone.
TEST(Check, GivesItsVerdictWhereTheStaticStiffnessOfTheSealsDoesNotCarry) {
  const auto result = run_hydrapod(
      {"check", transverse_model, "--set", "environment.gravity=9.81", "--set",
       "platform.mass=1500", "--set",
       "legs.guide_sleeve.elastomer={dynamic_ratio=2, loss_factor=0.2, frequency=10}"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "error: the machine is not sound\n");
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("warning: the legs buckle under the present load: remove "),
                    testing::EndsWith("\nNot sound: the legs buckle at pose neutral.\n")));
}

/// So little payload left that the bracket of the search is large against it.
TEST(Check, OfAMachineAboutToBuckleStillAnswers) {
  const std::vector<std::string> arguments{"check",    published_model,
                                           "--set",    "environment.gravity=9.81",
                                           "--set",    "model.flexible_axes=transverse",
                                           "--format", "json"};
  const double payload = json_of(arguments)["poses"][0]["buckling"]["payload_kg"];
  for (const double left : {1.0, 0.1, 0.01}) {
    auto nearly = arguments;
    nearly.insert(nearly.end(),
                  {"--set", "platform.mass=" + std::to_string(894.0 + payload - left)});
    const auto buckling = json_of(nearly)["poses"][0]["buckling"];
    EXPECT_EQ(buckling["status"], "found");
    EXPECT_NEAR(buckling["payload_kg"].get<double>(), left, 0.01) << "the tolerance is a millionth";
  }
}

TEST(Check, DoesNotSpeakOfBucklingWhereItWasNotSought) {
  const auto result = run_hydrapod({"check", heavy_model, "--model", "rigid", "--pose", "neutral"});
  EXPECT_THAT(result.out, HasSubstr("Buckling: rigid legs do not buckle.\n"));
  const auto json = json_of({"check", heavy_model, "--model", "rigid", "--format", "json"});
  EXPECT_EQ(json["poses"][0]["buckling"]["status"], "not_sought");
  EXPECT_EQ(
      json_of({"check", published_model, "--format", "json"})["poses"][0]["buckling"]["status"],
      "not_sought");
}

/// Against the areas of a 100/70 cylinder, 81 bar and 5 bar, with the atmosphere on the rod.
TEST(Check, IsNotSoundWhereTheSupplyCannotHoldTheLoad) {
  constexpr double pi = 3.14159265358979323846;
  constexpr double piston = pi / 4.0 * 0.1 * 0.1, rod = pi / 4.0 * 0.07 * 0.07;
  constexpr double push = 81e5 * piston - 5e5 * (piston - rod) - 101325.0 * rod;
  const std::vector<std::string> stiff{
      "check",  heavy_model, "--set", "legs.guide_sleeve.stiffness=80 kN/mm",
      "--pose", "low",       "--set"};
  const auto of_mass = [&](const char* mass, std::vector<std::string> more = {}) {
    auto arguments = stiff;
    arguments.push_back(std::string("platform.mass=") + mass);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_hydrapod(arguments);
  };
  const auto sound = of_mass("20 t", {"--format", "json"});
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  const auto light = Json::parse(sound.out);
  EXPECT_TRUE(light["sound"].get<bool>());
  for (const Json& leg : light["poses"][0]["legs"]) {
    EXPECT_NEAR(leg["largest_push_N"].get<double>(), push, 1e-9 * push);
    const double cap = leg["cap_pressure_Pa"], annulus = leg["rod_pressure_Pa"];
    EXPECT_NEAR(cap * piston - annulus * (piston - rod) - 101325.0 * rod,
                leg["axial_force_N"].get<double>(), 1e-6 * push);
    EXPECT_GT(annulus, 5e5);
    EXPECT_LT(cap, 81e5);
  }
  const auto heavier = of_mass("80 t");
  EXPECT_EQ(heavier.exit_code, 1);
  EXPECT_EQ(heavier.err, "error: the machine is not sound\n");
  EXPECT_THAT(
      heavier.out,
      AllOf(HasSubstr("warning: all legs: the oil can give "),
            HasSubstr(" at the supply pressure, and "),
            testing::EndsWith("\nNot sound: the supply cannot hold the load at pose low.\n")));
  const auto json = Json::parse(of_mass("80 t", {"--format", "json"}).out);
  EXPECT_FALSE(json["sound"].get<bool>());
  EXPECT_FALSE(json["poses"][0]["sound"].get<bool>());
  const Json& findings = json["poses"][0]["findings"];
  const auto weak = std::ranges::find_if(
      findings, [](const Json& finding) { return finding["kind"] == "weak_supply"; });
  ASSERT_NE(weak, findings.end());
  const Json& finding = *weak;
  EXPECT_NEAR(finding["ratio"].get<double>(), push, 1e-9 * push);
  EXPECT_FALSE(json["poses"][0]["legs"][0].contains("cap_pressure_Pa"));
}

struct Slip {
  std::vector<std::string> arguments;
  std::string says;
};

/// A slip of the unit is one line on the standard error, whatever follows from it at four poses of
/// six legs.
TEST(Check, OneSlipIsOneMessage) {
  const std::vector<Slip> slips{
      {{"--set", "base.joints.circle={radius='2100 m', spacing='0.36 m'}"},
       "base.joints.circle.radius: is 2100 m, usual are 0.001 m to 50 m; did you mean 2100 mm?"},
      {{"--set", "legs.rod.length=1150"},
       "legs.rod.length: is 1150 m, usual are 0.02 m to 20 m; did you mean 1150 mm?"},
      {{"--set", "legs.guide_sleeve.position=1250"},
       "legs.guide_sleeve.position: is 1250 m, usual are 0.02 m to 20 m; did you mean 1250 mm?"},
      {{"--set", "supply.pressure=81"},
       "supply.pressure: is 81 Pa, usual are 100000 Pa to 1e+08 Pa; did you mean 81 bar?"},
      {{"--set", "legs.stroke.length=860"},
       "legs.stroke.length: is 860 m, usual are 0.002 m to 20 m; did you mean 860 mm?"},
      {{"--set", "poses.low.position=[0, 0, 1300]"},
       "poses.low.position[2]: is 1300 m, usual are up to 50 m; did you mean 1300 mm?"},
      {{"--set", "legs.guide_sleeve.stiffness=1e22"},
       "legs.guide_sleeve.stiffness: is 1e+22 N/m, expected no more than 1e+15, or \"rigid\""},
      {{"--set", "legs.guide_sleeve.stiffness=Rigid"},
       "legs.guide_sleeve.stiffness: \"Rigid\" does not start with a number, expected a stiffness "
       "such as \"0.5 N/m\"; did you mean \"rigid\"?"},
      {{"--set", "platform.mass=1e308"},
       "platform.mass: is 1e+308 kg, expected no more than 1e+30"},
      {{"--set", "poses.low.position=[0, 0, 2.9]"},
       "poses.low: the piston of leg 1 is 2.143 m from its base joint, 0.923 m beyond its stroke "
       "from 0.36 m to 1.22 m; also all other legs"},
      {{"--pose", "z=50"}, "; also all other legs; did you mean \"z=50 mm\"?"},
      {{"--pose", "z=-120, rx=3"}, "; did you mean \"z=-120 mm, rx=3 deg\"?"},
      {{"--pose", "rx=5, z=20 mm"}, "; did you mean \"z=20 mm, rx=5 deg\"?"},
      {{"--pose", "rz=6.3"},
       "turns the platform by more than half a turn, 6.3 rad; did you mean \"rz=6.3 deg\"?"},
      {{"--pose", "ry=-40"},
       "turns the platform by more than half a turn, -40 rad; did you mean \"ry=-40 deg\"?"},
      {{"--pose", "rz=45"},
       "turns the platform by more than half a turn, 45 rad; did you mean \"rz=45 deg\"?"},
      {{"--pose", "rz=45 rad"},
       "turns the platform by more than half a turn, 45 rad; did you mean \"rz=45 deg\"?"},
      {{"--set", "poses.low.rotation=[10, 0, 0]"},
       "poses.low.rotation[0]: is 10 rad, more than half a turn; did you mean 10 deg?"},
      {{"--set", "poses.low.rotation=[0, '-400 deg', 0]"},
       "poses.low.rotation[1]: is -6.98132 rad, expected no more than a whole turn"},
      {{"--set", "poses.low.rotation=[0, 3, 0]"}, "; did you mean 3 deg?"}};
  for (const auto& slip : slips) {
    std::vector<std::string> arguments{"check", heavy_model};
    arguments.insert(arguments.end(), slip.arguments.begin(), slip.arguments.end());
    const auto result = run_hydrapod(arguments);
    EXPECT_EQ(result.exit_code, 2) << slip.says;
    EXPECT_THAT(result.err, testing::EndsWith(slip.says + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
}

TEST(Check, AnUnusualNumberIsAWarningWhereTheMachineCanHaveIt) {
  const auto result =
      run_hydrapod({"check", heavy_model, "--pose", "low", "--set", "platform.mass=10 kg"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err,
            "--set platform.mass=10 kg: warning: platform.mass: is 10 kg, less than a twentieth of "
            "the legs' 348 kg; did you mean 10 t?\n");
  EXPECT_THAT(result.out,
              testing::EndsWith("\nSound at pose low; unusual number: platform.mass is 10 kg.\n"));
}

/// A number beyond the range of its key is not called sound, whatever the calculation makes of it.
TEST(Check, AMachineWithAnImplausibleNumberIsNotSound) {
  const std::vector<Slip> slips{
      {{"check", heavy_model, "--set", "legs.oil_spring.cylinder.bore=100 m"},
       "implausible number: legs.oil_spring.cylinder.bore is 100 m"},
      {{"check", heavy_model, "--set", "legs.oil_spring.cylinder.air.fraction=0.9"},
       "implausible number: legs.oil_spring.cylinder.air.fraction is 0.9"},
      {{"check", published_model, "--set", "legs.valve.rated_flow=150"},
       "implausible number: legs.valve.rated_flow is 150 m^3/s"},
      {{"check", published_model, "--set", "legs.guide_sleeve.gap=0.2"},
       "implausible number: legs.guide_sleeve.gap is 0.2 m"},
      {{"check", published_model, "--set", "legs.case.mass_center=1050"},
       "implausible number: legs.case.mass_center is 1050 m"},
      {{"check", published_model, "--set", "legs.case.mass_center=1050", "--set",
        "legs.guide_sleeve.gap=0.2"},
       "implausible numbers: legs.case.mass_center is 1050 m, legs.guide_sleeve.gap is 0.2 m"}};
  for (const auto& slip : slips) {
    const auto result = run_hydrapod(slip.arguments);
    EXPECT_EQ(result.exit_code, 1) << slip.says;
    EXPECT_THAT(result.out, testing::EndsWith("\nNot sound: " + slip.says + ".\n"));
    EXPECT_THAT(result.err, testing::EndsWith("\nerror: the machine is not sound\n"));
    auto as_json = slip.arguments;
    as_json.insert(as_json.end(), {"--format", "json"});
    const auto json = Json::parse(run_hydrapod(as_json).out);
    EXPECT_FALSE(json["sound"].get<bool>()) << slip.says;
    EXPECT_TRUE(json["unusual_numbers"][0]["implausible"].get<bool>()) << slip.says;
    EXPECT_TRUE(json["poses"][0]["sound"].get<bool>()) << "the calculation finds nothing";
  }
}

/// `modes` shows oil 100 %: stiffer guide sleeves would not help.
TEST(Check, BlamesOilSpringsThatDoNotHoldThePlatform) {
  for (const char* model : {"rigid", "guide"}) {
    const auto result =
        run_hydrapod({"check", heavy_model, "--set", "legs.oil_spring={ stiffness = '5 N/mm' }",
                      "--pose", "neutral", "--model", model});
    EXPECT_EQ(result.exit_code, 1) << model;
    EXPECT_THAT(
        result.out,
        AllOf(HasSubstr("warning: the oil springs do not hold the platform: with rigid guide "
                        "sleeves it is unstable too; remove "),
              HasSubstr(" kg, or use stiffer oil springs (legs.oil_spring)\n"),
              Not(HasSubstr("stiffer guide sleeves")), Not(HasSubstr("the legs buckle")),
              testing::EndsWith(
                  "\nNot sound: the oil springs do not hold the platform at pose neutral.\n")));
  }
  // a soft mount is none of the oil's
  const auto mounted = run_hydrapod(
      {"check", heavy_model, "--set", "base.mount={stiffness={x=2e4,y=2e4,z=1e8,rx=1e5,ry=1e5}}"});
  EXPECT_THAT(mounted.out, Not(HasSubstr("the oil springs do not hold")));
  const auto folded = run_hydrapod({"check", heavy_model, "--set", "platform.mass=18 t"});
  EXPECT_THAT(folded.out, AllOf(HasSubstr("use stiffer guide sleeves"),
                                Not(HasSubstr("the oil springs do not hold"))));
}

/// Table and verdict, with the leakage of six valves: each leaks more than its sixth of the pump.
TEST(Check, IsNotSoundWhereThePumpDoesNotCoverTheLeakage) {
  const auto of_flow = [](const char* flow) {
    return run_hydrapod(
        {"check", heavy_model, "--pose", "low", "--set", std::string("supply.pump_flow=") + flow});
  };
  const auto weak = of_flow("1 l/min");
  EXPECT_EQ(weak.exit_code, 1);
  EXPECT_EQ(weak.err, "error: the machine is not sound\n");
  EXPECT_THAT(weak.out, AllOf(HasSubstr("oil spring N/µm"), HasSubstr("Lowest mode: "),
                              HasSubstr("warning: the pump gives 1 l/min, and the valves leak "),
                              HasSubstr("\nNot sound: the pump gives 1 l/min and the valves leak "),
                              testing::EndsWith(" l/min at pose low.\n")));
  const auto at = weak.out.rfind("the valves leak ");
  const double leakage = std::stod(weak.out.substr(at + std::string("the valves leak ").size()));
  EXPECT_EQ(of_flow((std::to_string(1.01 * leakage) + " l/min").c_str()).exit_code, 0);
  EXPECT_EQ(of_flow((std::to_string(0.99 * leakage) + " l/min").c_str()).exit_code, 1);
}

/// The picture that is not drawn has the reason of the table.
TEST(Check, PictureIsRefusedForTheReasonThatThereIs) {
  const auto drawn = [](const std::string& model, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"check", model, "--plot", "never.svg"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_hydrapod(arguments);
  };
  const std::string none = "error: pose low: no picture of what the machine can do: ";
  const auto pump = drawn(heavy_model, {"--pose", "low", "--set", "supply.pump_flow=1 l/min"});
  EXPECT_EQ(pump.exit_code, 1);
  EXPECT_THAT(pump.err, HasSubstr(none + "the pump gives 1 l/min, and the valves leak "));
  const auto supply = drawn(heavy_model, {"--pose", "low", "--set", "supply.pressure=20 bar"});
  EXPECT_EQ(supply.exit_code, 1);
  EXPECT_THAT(supply.err, AllOf(HasSubstr(none), HasSubstr("supply"), Not(HasSubstr("motors"))));
  const test::TemporaryFolder folder;
  const auto screws = (folder / "screws.toml").string();
  auto text = test::screw_file;
  text.erase(text.find("torque_limit"), text.find("speed_limit") - text.find("torque_limit"));
  test::write_text(screws, text);
  EXPECT_THAT(drawn(screws, {}).err, HasSubstr("the motors have no limits; expected legs.screw"));
}

TEST(Check, SaysWhenFrictionHoldsTheLegs) {
  const auto of_friction = [](const char* coulomb) {
    return run_hydrapod({"check", heavy_model, "--pose", "low", "--set",
                         std::string("legs.friction.coulomb=") + coulomb});
  };
  const auto little = of_friction("1 kN");
  EXPECT_EQ(little.exit_code, 0);
  EXPECT_THAT(little.out, Not(HasSubstr("of friction")));
  const auto much = of_friction("10 kN");
  EXPECT_EQ(much.exit_code, 0);
  EXPECT_THAT(much.out, HasSubstr("warning: all legs: 15 kN of friction are "));
  const auto stuck = of_friction("50 kN");
  EXPECT_EQ(stuck.exit_code, 1);
  EXPECT_THAT(stuck.out,
              AllOf(HasSubstr("warning: all legs: 75 kN of friction hold the piston, and the oil "
                              "has "),
                    testing::EndsWith("\nNot sound: the oil cannot move the legs against their "
                                      "friction at pose low.\n")));
}

/// A mass that nobody would write out.
TEST(Check, ShortensAMassOfThirtyDigits) {
  EXPECT_THAT(
      run_hydrapod({"check", heavy_model, "--pose", "low", "--set", "platform.mass=1e30"}).out,
      AllOf(HasSubstr("remove 1e+30 kg, or"), Not(HasSubstr("000000000000"))));
}

TEST(Check, ReportsEveryMistakeInOneGo) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "m.toml", "nam = \"x\"\n[platform]\nmass = \"3 m\"\n");
  const auto result = run_hydrapod({"check", "m.toml"}, {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("m.toml:1:1: error: nam: unknown key; did you mean `name`?"),
                    HasSubstr("m.toml:3:8: error: platform.mass: ")));
}

}  // namespace
}  // namespace hydrapod
