/// `hydrapod check`: what follows from a machine file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/json_fields.hpp"

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

const std::string published = test::source_file("models/zhang-jiang-2021.toml").string();
const std::string heavy = test::source_file("models/heavy-platform.toml").string();

TEST(Check, TableSaysWhatFollows) {
  const auto result = run_hydrapod({"check", published});
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
  const auto json = json_of({"check", heavy, "--format", "json"});
  EXPECT_THAT(fields(json), ElementsAre("kind", "machine", "assumptions", "sound",
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
  const auto table = run_hydrapod({"check", published});
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("Assumed values for simulations\n"),
                    HasSubstr("  legs.equivalent_cylinder: A_p = 6.99 cm^2 (a sixth of the supply "
                              "pressure carries the platform), e = 0.5, 0.158 l in both chambers"),
                    HasSubstr("  legs.valve.rated_flow: 21 l/min at full opening")));
  const auto json =
      json_of({"check", published, "--format", "json", "--set", "leg.2.valve.rated_flow=30 l/min",
               "--set", "legs.friction={ coulomb = 90, viscous = 0 }"});
  std::vector<std::string> keys;
  for (const Json& one : json["simulation_assumptions"]) keys.push_back(one["key"]);
  EXPECT_THAT(keys, AllOf(testing::Contains("leg.1.valve.rated_flow"),
                          Not(testing::Contains("leg.2.valve.rated_flow")),
                          Not(testing::Contains("legs.friction.coulomb")),
                          testing::Contains("legs.stroke")));
}

TEST(Check, LegsAddUp) {
  const auto json = json_of({"check", heavy, "--pose", "pitched", "--format", "json"});
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
  const auto json = json_of({"check", heavy, "--format", "json"});
  double up = 0.0;
  for (const Json& leg : json["poses"][0]["legs"]) up += leg["axial_force_N"].get<double>();
  const double weight = 14000.0 * 9.80665;
  EXPECT_GT(up, weight);  // legs stand aslant
  EXPECT_LT(up, 1.5 * weight);
}

TEST(Check, NamesThePayloadAtWhichTheLegsFold) {
  const auto light = json_of({"check", published, "--set", "environment.gravity=9.81", "--set",
                              "model.flexible_axes=transverse", "--format", "json"});
  const Json& buckling = light["poses"][0]["buckling"];
  ASSERT_EQ(buckling["status"], "found");
  const double payload = buckling["payload_kg"];
  EXPECT_GT(payload, 0.0);
  const auto table = run_hydrapod({"check", published, "--set", "environment.gravity=9.81", "--set",
                                   "model.flexible_axes=transverse"});
  EXPECT_THAT(table.out, HasSubstr("Buckling load: "));

  // with this payload the machine names the mass to remove
  const auto loaded = run_hydrapod({"check", published, "--set", "environment.gravity=9.81",
                                    "--set", "model.flexible_axes=transverse", "--set",
                                    "platform.mass=" + std::to_string(894.0 + 1.01 * payload)});
  EXPECT_EQ(loaded.exit_code, 1);
  EXPECT_EQ(loaded.err, "error: the machine is not sound\n");
  EXPECT_THAT(loaded.out,
              AllOf(testing::EndsWith("\nNot sound: the legs buckle at pose neutral.\n"),
                    HasSubstr("Buckling: the legs buckle under the present load; they carry "),
                    HasSubstr("warning: the legs buckle under the present load: remove ")));
}

/// So little payload left that the bracket of the search is large against it.
TEST(Check, OfAMachineAboutToBuckleStillAnswers) {
  const std::vector<std::string> arguments{"check",    published,
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
  const auto result = run_hydrapod({"check", heavy, "--model", "rigid", "--pose", "neutral"});
  EXPECT_THAT(result.out, HasSubstr("Buckling: rigid legs do not buckle.\n"));
  const auto json = json_of({"check", heavy, "--model", "rigid", "--format", "json"});
  EXPECT_EQ(json["poses"][0]["buckling"]["status"], "not_sought");
  EXPECT_EQ(json_of({"check", published, "--format", "json"})["poses"][0]["buckling"]["status"],
            "not_sought");
}

/// Against the areas of a 100/70 cylinder, 81 bar and 5 bar, with the atmosphere on the rod.
TEST(Check, IsNotSoundWhereTheSupplyCannotHoldTheLoad) {
  constexpr double pi = 3.14159265358979323846;
  constexpr double piston = pi / 4.0 * 0.1 * 0.1, rod = pi / 4.0 * 0.07 * 0.07;
  constexpr double push = 81e5 * piston - 5e5 * (piston - rod) - 101325.0 * rod;
  const std::vector<std::string> stiff{
      "check", heavy, "--set", "legs.guide_sleeve.stiffness=80 kN/mm", "--pose", "low", "--set"};
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
      {{"--set", "poses.low.position=[0, 0, 2.9]"},
       "poses.low: the piston of leg 1 is 2.143 m from its base joint, 0.923 m beyond its stroke "
       "from 0.36 m to 1.22 m; also all other legs"},
      {{"--pose", "z=50"}, "; also all other legs; did you mean \"z=50 mm\"?"},
      {{"--pose", "z=-120, rx=3"}, "; did you mean \"z=-120 mm, rx=3 deg\"?"},
      {{"--pose", "rx=5, z=20 mm"}, "; did you mean \"z=20 mm, rx=5 deg\"?"},
      {{"--pose", "rz=6.3"},
       "turns the platform by more than half a turn, 6.3 rad; did you mean \"rz=6.3 deg\"?"},
      {{"--pose", "ry=-40"}, "turns the platform by more than half a turn, -40 rad"}};
  for (const auto& slip : slips) {
    std::vector<std::string> arguments{"check", heavy};
    arguments.insert(arguments.end(), slip.arguments.begin(), slip.arguments.end());
    const auto result = run_hydrapod(arguments);
    EXPECT_EQ(result.exit_code, 2) << slip.says;
    EXPECT_THAT(result.err, testing::EndsWith(slip.says + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
}

TEST(Check, AnUnusualNumberIsAWarningWhereTheMachineCanHaveIt) {
  const auto result =
      run_hydrapod({"check", heavy, "--pose", "low", "--set", "platform.mass=10 kg"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err,
            "--set platform.mass=10 kg: warning: platform.mass: is 10 kg, less than a twentieth of "
            "the legs' 348 kg; did you mean 10 t?\n");
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
