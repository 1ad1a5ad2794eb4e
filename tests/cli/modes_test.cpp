/// `hydrapod modes`: what it prints, as a table, as JSON and as CSV.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <regex>

#include "support/csv.hpp"
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

std::string model_file(const std::string& name) {
  return test::source_file("models/" + name).string();
}
const std::string published = model_file("zhang-jiang-2021.toml");
const std::string heavy = model_file("heavy-platform.toml");

/// The starter file in a folder of its own.
class Starter : public testing::Test {
 protected:
  void SetUp() override { run_hydrapod({"init", file_}); }
  test::TemporaryFolder folder_;
  std::string file_ = (folder_ / "machine.toml").string();
};

std::vector<double> frequencies(const Json& modes) {
  std::vector<double> omega;
  for (const Json& mode : modes) omega.push_back(mode["omega_rad_s"]);
  return omega;
}

/// Sleeves of 1e12 N/m leave the share of the platform's stiffness in theirs, some 1e-5; rounding
/// of a stiffness matrix that holds 1e15 N/m is less.
TEST(Modes, OfRigidSleevesAreThoseOfTheRigidLegModel) {
  for (const char* stiffness : {"rigid", "1e13"}) {
    const auto json = json_of({"modes", heavy, "--format", "json", "--set",
                               std::string("legs.guide_sleeve.stiffness=") + stiffness});
    const auto rigid = frequencies(json["rigid_modes"]);
    const auto flexible = frequencies(json["modes"]);
    ASSERT_GE(flexible.size(), rigid.size());
    for (size_t k = 0; k < rigid.size(); ++k)
      EXPECT_NEAR(flexible[k], rigid[k], 1e-5 * rigid[k]) << stiffness << ", mode " << k;
  }
}

/// The stiffness that stands for "rigid" gives frequencies, which are no results.
TEST(Modes, OfLegsThatAreRigidAreSaidToBeThoseOfAStandIn) {
  const auto usual = run_hydrapod({"modes", heavy});
  EXPECT_THAT(usual.out, Not(HasSubstr("stands for that")));
  const auto run = run_hydrapod({"modes", published, "--set", "legs.oil_spring.stiffness=rigid"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("The legs are rigid along their axes: 1e+12 N/m"));
}

/// Two joints of a pair in one place, at the platform or at both ends, are the limit of small
/// spacings.
TEST_F(Starter, SixThreeAndThreeThreePlatformsAreTheLimit) {
  const auto omega = [&](const std::vector<std::string>& sides, const char* spacing) {
    std::vector<std::string> arguments{"modes", file_, "--format", "json"};
    for (const auto& side : sides) {
      arguments.push_back("--set");
      arguments.push_back(side + ".joints.circle.spacing=" + spacing);
    }
    return frequencies(json_of(arguments)["modes"]);
  };
  for (const auto& sides : {std::vector<std::string>{"platform"}, {"base", "platform"}}) {
    const auto joined = omega(sides, "0"), near = omega(sides, "1 mm"),
               apart = omega(sides, "2 mm");
    ASSERT_EQ(joined.size(), near.size());
    for (size_t k = 0; k < joined.size(); ++k)  // what is left goes with the square of the spacing
      EXPECT_NEAR(joined[k], 2.0 * near[k] - apart[k], 1e-5 * joined[k]) << k;
  }
}

/// Rounded as printed, ascending.
TEST(Modes, OfThePublishedMachineHaveTheKnownFrequencies) {
  const auto result = run_hydrapod({"modes", published});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto json = json_of({"modes", published, "--format", "json"});
  constexpr double printed = 0.5e-3;  // half a unit of the last of three decimals
  EXPECT_THAT(frequencies(json["modes"]),
              testing::Pointwise(
                  testing::DoubleNear(printed),
                  {46.781, 46.781, 53.281, 53.298, 53.353, 53.364, 53.364, 53.382, 53.386, 53.387,
                   53.387, 53.387, 53.434, 53.473, 112.210, 143.380, 189.319, 189.320}));
  EXPECT_THAT(frequencies(json["rigid_modes"]),
              testing::Pointwise(testing::DoubleNear(printed),
                                 {46.839, 46.839, 112.065, 143.364, 189.241, 189.241}));
  size_t at = 0;  // and the table prints them in this order
  for (const Json& mode : json["modes"]) {
    const auto number = fmt::format("  {:.3f}  ", mode["omega_rad_s"].get<double>());
    at = result.out.find(number, at);
    ASSERT_NE(at, std::string::npos) << number;
    ++at;
  }
}

TEST(Modes, TableSaysWhatItStandsOn) {
  const auto result = run_hydrapod({"modes", published});
  EXPECT_THAT(
      result.out,
      AllOf(HasSubstr("Zhang & Jiang 2021, pose neutral: guide-sleeve model, 18 modes\n"),
            HasSubstr("no gravity; gimbal axes; damping: 0.2 % of critical in every mode\n"),
            HasSubstr("rigid Hz"), HasSubstr("; with rigid legs: "), Not(HasSubstr("by --set")),
            Not(HasSubstr("\033"))));
}

TEST(Modes, PolesOfTheSystemAreAtOnePose) {
  const auto of_all = run_hydrapod({"modes", heavy, "--poses", "all", "--system"});
  EXPECT_EQ(of_all.exit_code, 2);
  EXPECT_EQ(of_all.err,
            "--poses all: error: poles of the system are at one pose; give --pose once\n");
  EXPECT_THAT(run_hydrapod({"modes", heavy, "--pose", "low", "--pose", "neutral", "--system"}).err,
              testing::StartsWith("--pose: error: poles of the system"));
}

TEST(Modes, ComeInThreeModels) {
  const auto count = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"modes", published, "--format", "json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto json = json_of(arguments);
    EXPECT_EQ(json["coordinates"].size(), json["modes"].size());
    return std::pair(json["model"].get<std::string>(), json["modes"].size());
  };
  using Counted = std::pair<std::string, size_t>;
  EXPECT_EQ(count({}), Counted("guide", 18U));
  EXPECT_EQ(count({"--model", "rigid"}), Counted("rigid", 6U));
  EXPECT_EQ(count({"--model", "guide"}), Counted("guide", 18U));
  const std::string rings = "legs.piston_ring.stiffness=\"4e5 N/m\"";
  EXPECT_EQ(count({"--set", rings}), Counted("full", 30U));
  EXPECT_EQ(count({"--set", rings, "--model", "guide"}), Counted("guide", 18U));
}

TEST(Modes, JsonHasItsStableFields) {
  const auto json = json_of({"modes", published, "--format", "json", "--matrices"});
  EXPECT_THAT(fields(json),
              ElementsAre("kind", "machine", "assumptions", "pose", "model", "coordinates", "modes",
                          "rigid_modes", "matrices", "reproduction"));
  EXPECT_EQ(json["kind"], "modes");
  EXPECT_THAT(fields(json["machine"]),
              ElementsAre("name", "description", "source", "state", "file", "overrides"));
  EXPECT_EQ(json["machine"]["file"], published);
  EXPECT_THAT(fields(json["assumptions"]),
              ElementsAre("hydrapod", "gravity_m_s2", "gravity", "flexible_axes", "damping",
                          "damping_with_hydraulics", "modal_ratio", "modal_ratio_is_default"));
  EXPECT_THAT(fields(json["pose"]), ElementsAre("name", "position_m", "rotation_rad"));
  EXPECT_EQ(json["pose"]["name"], "neutral");
  EXPECT_EQ(json["coordinates"][17], "leg6.phi2");

  const Json& mode = json["modes"][0];
  EXPECT_THAT(fields(mode),
              ElementsAre("number", "omega_rad_s", "frequency_hz", "damping_ratio", "pole",
                          "stable", "label", "moves_platform", "group", "platform_energy",
                          "leg_energy", "strain_energy", "shape", "rigid"));
  EXPECT_THAT(fields(mode["strain_energy"]),
              ElementsAre("oil", "guide_sleeve", "piston_ring", "preload", "per_leg"));
  EXPECT_THAT(fields(mode["rigid"]), ElementsAre("mode", "omega_rad_s", "mac", "shift_percent"));
  EXPECT_EQ(mode["number"], 1);
  EXPECT_EQ(mode["platform_energy"].size(), 6U);
  EXPECT_EQ(mode["leg_energy"].size(), 6U);
  EXPECT_EQ(mode["shape"].size(), 18U);
  EXPECT_DOUBLE_EQ(mode["frequency_hz"].get<double>() * 2.0 * std::numbers::pi,
                   mode["omega_rad_s"].get<double>());
  EXPECT_FALSE(json["rigid_modes"][0].contains("rigid"));
  EXPECT_EQ(json["rigid_modes"][0]["shape"].size(), 6U);

  for (const char* name : {"M", "K", "C"}) {
    EXPECT_EQ(json["matrices"][name].size(), 18U);
    EXPECT_EQ(json["matrices"][name][0].size(), 18U);
    EXPECT_EQ(json["matrices"]["rigid"][name].size(), 6U);
  }
  EXPECT_FALSE(json_of({"modes", published, "--format", "json"}).contains("matrices"));
}

TEST(Modes, JsonSharesSumToOne) {
  for (const auto& file : {published, heavy}) {
    const auto json = json_of({"modes", file, "--format", "json"});
    for (const Json& mode : json["modes"]) {
      const auto sum = [](const Json& list) {
        return std::accumulate(list.begin(), list.end(), 0.0, [](double all, const Json& share) {
          return all + share.get<double>();
        });
      };
      EXPECT_NEAR(sum(mode["platform_energy"]) + sum(mode["leg_energy"]), 1.0, 1e-12);
      const Json& strain = mode["strain_energy"];
      EXPECT_NEAR(strain["oil"].get<double>() + strain["guide_sleeve"].get<double>() +
                      strain["piston_ring"].get<double>(),
                  1.0, 1e-12);
      EXPECT_NEAR(sum(strain["per_leg"]["oil"]), strain["oil"].get<double>(), 1e-15);
    }
  }
}

/// A base of twenty tonnes under the published platform: two masses along z, and both are seen.
TEST(Modes, HaveTheBaseThatTheMachineStandsOn) {
  const std::vector<std::string> arguments{
      "modes",
      model_file("zhang-jiang-2021-transverse.toml"),
      "--model",
      "rigid",
      "--set",
      "base.mount={stiffness={x=1e8,y=1e8,z=1e8,rx=1e8,ry=1e8,rz=1e8},mass=20000,"
      "inertia=[10000,10000,10000]}"};
  const auto result = run_hydrapod(arguments);
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("rigid-leg model, 12 modes (6 coordinates of the base)"),
                                HasSubstr("  10.927"), HasSubstr("  23.476"), HasSubstr("base z")));
  auto with_json = arguments;
  with_json.insert(with_json.end(), {"--format", "json"});
  const auto json = json_of(with_json);
  EXPECT_EQ(json["coordinates"].size(), 12U);
  for (const Json& mode : json["modes"]) {
    double sum = 0.0;
    for (const char* body : {"platform_energy", "leg_energy", "base_energy"})
      for (const Json& share : mode[body]) sum += share.get<double>();
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_EQ(mode["shape"].size(), 12U);
  }
  auto as_csv = arguments;
  as_csv.insert(as_csv.end(), {"--format", "csv"});
  EXPECT_THAT(run_hydrapod(as_csv).out, HasSubstr(",kinetic_base,elastic_base_mount\n"));
}

TEST(Modes, GiveABaseWithoutInertiaCoordinates) {
  EXPECT_THAT(run_hydrapod({"modes", model_file("zhang-jiang-2021-transverse.toml"), "--model",
                            "rigid", "--set", "base.mount={stiffness={x=1e8,ry=3.1e8}}"})
                  .out,
              HasSubstr("rigid-leg model, 8 modes (2 coordinates of the base)\n"));
}

TEST(Modes, SayWhichFrequenciesTheyHave) {
  EXPECT_THAT(run_hydrapod({"modes", published}).out,
              HasSubstr("\nHz and rad/s: natural frequencies |λ| of the damped modes, as they are "
                        "measured\n"));
  EXPECT_THAT(run_hydrapod({"modes", heavy, "--pose", "neutral", "--pose", "low"}).out,
              HasSubstr("\nHz: natural frequencies |λ| of the damped modes"));
  EXPECT_THAT(run_hydrapod({"modes", published, "--amplitude", "1 mm"}).out,
              HasSubstr("Hz: of the balance of springs and masses, without dampers."));
  EXPECT_THAT(run_hydrapod({"modes", published, "--open-loop"}).out,
              HasSubstr("\nHz and rad/s: |λ| of the poles.\n"));
  EXPECT_THAT(run_hydrapod({"check", published}).out, HasSubstr(" Hz (|λ| of the damped mode)."));
  EXPECT_THAT(run_hydrapod({"compare", published, "--pose", "neutral", "--pose", "z=5 mm"}).out,
              HasSubstr("\nHz: |λ| of damped modes."));
}

TEST(Modes, DoNotBlameTheSleevesWhereTheOilIsTooSoft) {
  EXPECT_THAT(run_hydrapod({"modes", model_file("zhang-jiang-2021-transverse.toml"), "--set",
                            "legs.oil_spring.stiffness=1e3", "--set", "environment.gravity=9.81"})
                  .out,
              AllOf(HasSubstr("unstable at this pose, also in the rigid-leg model: "),
                    Not(HasSubstr("the legs buckle"))));
}

/// K φ = ω² M φ with the matrices and shapes of the JSON alone: all a reader has.
TEST(Modes, JsonIsEnoughToVerifyIt) {
  const auto json = json_of(
      {"modes", published, "--format", "json", "--matrices", "--set", "damping.modal_ratio=0"});
  const Json& M = json["matrices"]["M"];
  const Json& K = json["matrices"]["K"];
  for (const Json& mode : json["modes"]) {
    const double omega2 = std::pow(mode["omega_rad_s"].get<double>(), 2);
    for (size_t i = 0; i < 18; ++i) {
      double left = 0.0, scale = 0.0;
      for (size_t j = 0; j < 18; ++j) {
        const double phi = mode["shape"][j];
        left += (K[i][j].get<double>() - omega2 * M[i][j].get<double>()) * phi;
        scale += std::abs(K[i][j].get<double>() * phi);
      }
      EXPECT_LE(std::abs(left), 1e-9 * (1.0 + scale));
    }
  }
}

TEST(Modes, CsvIsWellFormed) {
  const auto result = run_hydrapod({"modes", published, "--format", "csv"});
  ASSERT_EQ(result.exit_code, 0);
  const auto rows = test::parse_csv(result.out);
  ASSERT_EQ(rows.size(), 19U);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_THAT(rows[0], testing::Contains("label"));
  const auto label = std::find(rows[0].begin(), rows[0].end(), "label") - rows[0].begin();
  EXPECT_EQ(rows[1][label], "x, oil springs of all legs") << "commas of labels are quoted";
  EXPECT_EQ(rows[0][1], "omega_rad_s");
  EXPECT_NEAR(std::stod(rows[1][1]), 46.781, 0.5e-3);
}

TEST_F(Starter, AnotherPoseHasOtherFrequencies) {
  const auto neutral = json_of({"modes", file_, "--format", "json"});
  const auto high = json_of({"modes", file_, "--pose", "high", "--format", "json"});
  const auto tilted = json_of({"modes", file_, "--pose", "z = 50 mm,ry=5 deg", "--format", "json"});
  EXPECT_EQ(high["pose"]["name"], "high");
  EXPECT_NE(frequencies(high["modes"]), frequencies(neutral["modes"]));
  EXPECT_NEAR(tilted["pose"]["position_m"][2].get<double>() -
                  neutral["pose"]["position_m"][2].get<double>(),
              0.05, 1e-15);
  EXPECT_NEAR(tilted["pose"]["rotation_rad"][1].get<double>(), 5.0 * std::numbers::pi / 180.0,
              1e-15);
}

TEST_F(Starter, OutputGoesToAFileAndIsWhatWouldBePrinted) {
  const auto printed = run_hydrapod({"modes", file_, "--format", "csv"});
  const std::string out = (folder_ / "modes.csv").string();
  const auto written = run_hydrapod({"modes", file_, "--format", "csv", "-o", out});
  EXPECT_EQ(written.exit_code, 0);
  EXPECT_EQ(written.out, "");
  EXPECT_EQ(test::read_text(out), printed.out);
}

/// How often `pattern` stands in `text`.
std::ptrdiff_t count(const std::string& pattern, const std::string& text) {
  const std::regex regex(pattern);
  return std::distance(std::sregex_iterator(text.begin(), text.end(), regex),
                       std::sregex_iterator());
}

TEST(ModesWithSet, ShowTheChangeAgainstTheFile) {
  // four times the oil springs and nothing else: without seals that would be twice the frequency
  const auto result = run_hydrapod(
      {"modes", published, "--model", "rigid", "--set", "legs.oil_spring.stiffness=1.541412e7"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("by --set"));
  EXPECT_EQ(count(R"(\+100\.0 %)", result.out), 6) << result.out;
}

TEST(ModesWithSet, ThatChangeNothingShowNoChange) {
  const auto result = run_hydrapod({"modes", published, "--set", "platform.mass=894"});
  EXPECT_EQ(count(R"(  0\.00 %  )", result.out), 18) << result.out;
}

TEST(ModesWithSet, ShowPistonRingModesAsNew) {
  const auto result = run_hydrapod({"modes", published, "--set", "legs.piston_ring.stiffness=4e5"});
  EXPECT_EQ(count("  new  ", result.out), 12) << result.out;
}

TEST_F(Starter, OverridesGiveWhatEditingTheFileGives) {
  std::string text = test::read_text(file_);
  const auto edited = std::regex_replace(
      text, std::regex(R"((\[legs\.guide_sleeve\][^\[]*?stiffness = )[^#\n]*)"), "$1\"2 kN/mm\" ");
  ASSERT_NE(edited, text);
  const std::string edited_file = (folder_ / "edited.toml").string();
  test::write_text(edited_file, edited);
  auto by_file = json_of({"modes", edited_file, "--format", "json", "--matrices"});
  auto by_set = json_of({"modes", file_, "--set", "legs.guide_sleeve.stiffness=2 kN/mm", "--format",
                         "json", "--matrices"});
  for (const char* origin : {"machine", "reproduction"}) by_file.erase(origin);
  EXPECT_EQ(by_set["machine"]["overrides"], Json::array({"legs.guide_sleeve.stiffness=2 kN/mm"}));
  for (const char* origin : {"machine", "reproduction"}) by_set.erase(origin);
  EXPECT_EQ(by_file, by_set);
}

TEST_F(Starter, FileMayComeFromStandardInput) {
  const std::string text = test::read_text(file_);
  auto from_file = json_of({"modes", file_, "--format", "json"});
  auto from_stdin = json_of({"modes", "-", "--format", "json"}, {.input = text});
  EXPECT_EQ(from_stdin["machine"]["file"], "-");
  for (const char* origin : {"machine", "reproduction"}) {
    from_file.erase(origin);
    from_stdin.erase(origin);
  }
  EXPECT_EQ(from_file, from_stdin);

  const auto changed = run_hydrapod({"modes", "-", "--set", "platform.mass=2 t"}, {.input = text});
  EXPECT_THAT(changed.out, HasSubstr("by --set")) << "the change is shown for it too";
}

/// Weightless legs stand straight beyond their buckling load: modes exist, some are unstable.
std::string with_straight_legs(const std::string& mass) {
  std::string text = test::read_text(published);
  text = std::regex_replace(text, std::regex("gravity = 0 "), "gravity = 9.81 ");
  text = std::regex_replace(text, std::regex("\nmass = 7.207 "), "\nmass = 0 ");
  text = std::regex_replace(text, std::regex("\nmass = 1.620 "), "\nmass = 0 ");
  return std::regex_replace(text, std::regex("mass = 894.0"), "mass = " + mass);
}

TEST(Modes, OfABuckledMachineSayIt) {
  const auto result = run_hydrapod({"modes", "-"}, {.input = with_straight_legs("4000.0")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("unstable (buckling)"),
                                HasSubstr("The machine is unstable at this pose: the legs buckle. "
                                          "`hydrapod check` computes the buckling load.\n")));
  const auto json =
      json_of({"modes", "-", "--format", "json"}, {.input = with_straight_legs("4000.0")});
  EXPECT_EQ(json["modes"][0]["stable"], false);
  EXPECT_EQ(json["modes"][0]["omega_rad_s"], 0.0);
}

TEST(Modes, WithoutAnEquilibriumFailAndSayWhy) {
  const auto result = run_hydrapod({"modes", published, "--set", "environment.gravity=9.81",
                                    "--set", "legs.case.mass=72.07", "--set", "legs.rod.mass=16.2",
                                    "--set", "model.flexible_axes=transverse"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err,
              AllOf(testing::StartsWith("error: no static equilibrium of the guide model at this "
                                        "pose: "),
                    HasSubstr("the legs may be past buckling (see `hydrapod check`)")));
}

/// --set can mend a file that has no modes by itself; there is then nothing to compare with.
TEST(ModesWithSet, ThatMendAFileShowNoChangeAndSayWhy) {
  const std::string broken =
      std::regex_replace(test::read_text(published), std::regex("mass = 894.0"), "mass = -894.0");
  const auto result = run_hydrapod({"modes", "-", "--set", "platform.mass=894"}, {.input = broken});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(Not(HasSubstr("by --set  ")),
                    HasSubstr("the change by --set is not shown: without it the file has no "
                              "modes at this pose\n")));
}

TEST(Modes, MatricesNeedTheJson) {
  const auto result = run_hydrapod({"modes", published, "--matrices"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "--matrices: error: matrices are part of the JSON; add --format json\n");
}

TEST(Modes, TheDelayIsOfTheController) {
  const auto result = run_hydrapod({"modes", published, "--pade", "3"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "--pade 3: error: is of the controller's delay; add --system or --root-locus\n");
}

TEST(ModesAtPoses, AreThoseOfEachPoseFollowedByShape) {
  const auto all = json_of({"modes", heavy, "--poses", "all", "--format", "json"});
  EXPECT_EQ(all["kind"], "modes_at_poses");
  ASSERT_EQ(all["poses"].size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto name = all["poses"][k]["pose"]["name"].get<std::string>();
    const auto one = json_of({"modes", heavy, "--pose", name, "--format", "json"});
    EXPECT_EQ(all["poses"][k]["modes"].dump(), one["modes"].dump()) << name;
  }
  ASSERT_GE(all["followed"].size(), 6U);
  for (const auto& followed : all["followed"])
    for (std::size_t k = 0; k < 4; ++k) {
      if (followed["mode"][k].is_null()) {
        EXPECT_TRUE(followed["frequency_hz"][k].is_null());
        continue;
      }
      const auto number = followed["mode"][k].get<std::size_t>();
      EXPECT_EQ(followed["frequency_hz"][k], all["poses"][k]["modes"][number - 1]["frequency_hz"]);
    }
}

TEST(ModesAtPoses, OnePoseUnderTwoNamesHasTheSameModes) {
  const auto all =
      json_of({"modes", heavy, "--pose", "neutral", "--pose", "z=0 mm", "--format", "json"});
  for (const auto& followed : all["followed"]) {
    EXPECT_EQ(followed["mode"][0], followed["mode"][1]);
    EXPECT_NEAR(followed["mac"][1].get<double>(), 1.0, 1e-9);
  }
}

TEST(ModesAtPoses, WrongUseIsRefused) {
  const auto err = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"modes", heavy});
    const auto run = run_hydrapod(more);
    EXPECT_EQ(run.exit_code, 2);
    return run.err;
  };
  EXPECT_EQ(err({"--pose", "low", "--pose", "low"}), "--pose low: error: is given twice\n");
  EXPECT_THAT(err({"--pose", "low", "--pose", "lwo"}), HasSubstr("did you mean 'low'?"));
  EXPECT_THAT(err({"--poses", "some"}), HasSubstr("--poses some: error: unknown value"));
  EXPECT_THAT(err({"--poses", "all", "--system"}),
              HasSubstr("poles of the system are at one pose"));
  EXPECT_THAT(err({"--poses", "all", "--matrices", "--format", "json"}),
              HasSubstr("--matrices: error: are of one pose"));
}

TEST(ModesAtPoses, ATableHasARowPerModeAndAColumnPerPose) {
  const auto run = run_hydrapod({"modes", heavy, "--pose", "neutral", "--pose", "low"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("neutral Hz"), HasSubstr("low Hz"), HasSubstr("lowest MAC")));
  const auto csv =
      run_hydrapod({"modes", heavy, "--pose", "neutral", "--pose", "low", "--format", "csv"});
  const auto rows = test::parse_csv(csv.out);
  EXPECT_GE(rows.size(), 13U);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows.front().size());
}

}  // namespace
}  // namespace hydrapod
