/// `hydrapod diagnose` as somebody uses it, rightly and wrongly.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <map>
#include <set>

#include "support/json_fields.hpp"
#include "support/other_legs.hpp"

namespace hydrapod {
namespace {

using test::json_of;
using test::run_hydrapod;
using testing::HasSubstr;

class DiagnoseCommand : public testing::Test {
 protected:
  const std::string machine_ = test::source_file("models/heavy-platform.toml").string();
  const std::vector<std::string> stiff_{"--set", "legs.guide_sleeve.stiffness=20 kN/mm"};
  test::TemporaryFolder folder_;

  std::string write(const std::string& name, const std::string& text) {
    test::write_text(folder_ / name, text);
    return (folder_ / name).string();
  }

  /// The modes of the machine with its soft sleeves, as a list; frequencies times `factor`.
  std::string modes(double factor = 1.0) {
    std::string text = "frequency [Hz],deviation [%],x,y,z,rx,ry,rz\n";
    const auto soft = json_of({"modes", machine_, "--format", "json"});
    for (const auto& mode : soft["modes"]) {
      double platform = 0.0;
      for (const auto& share : mode["platform_energy"]) platform += share.get<double>();
      if (platform < 0.004) continue;
      text += fmt::format("{},0.1", factor * mode["frequency_hz"].get<double>());
      const auto& shape = mode["shape"].contains("re") ? mode["shape"]["re"] : mode["shape"];
      for (std::size_t d = 0; d < 6; ++d) text += fmt::format(",{}", shape[d].get<double>());
      text += "\n";
    }
    return write("modes.csv", text);
  }

  std::vector<std::string> command(std::vector<std::string> more) {
    std::vector<std::string> all{"diagnose", machine_};
    all.insert(all.end(), stiff_.begin(), stiff_.end());
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

TEST_F(DiagnoseCommand, NamesTheSleevesInWordsAndNumbers) {
  const auto picture = (folder_ / "why.svg").string();
  const auto run =
      run_hydrapod(command({"--measured", modes(), "--format", "json", "--plot", picture}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["kind"], "diagnosis");
  EXPECT_EQ(json["finding"], "cause identified");
  const auto& best = json["hypotheses"][0];
  EXPECT_EQ(best["name"], "guide sleeves of all legs");
  EXPECT_NEAR(best["parameters"][0]["value"].get<double>(), 0.84e6, 2e3);
  EXPECT_LE(best["parameters"][0]["interval_95"][0].get<double>(), 0.8401e6);
  EXPECT_THAT(json["summary"][0].get<std::string>(), HasSubstr("guide sleeves of all legs"));
  // the required stiffness is that of the diagnosed machine, not of the nominal one
  EXPECT_NEAR(json["remedy"]["present"]["stiffness_N_m"].get<double>(), 0.84e6, 2e3);
  EXPECT_EQ(json["computed_machine"], "fitted");
  EXPECT_NEAR(json["nominal_sleeve_N_m"].get<double>(), 20e6, 1.0);
  EXPECT_THAT(json["summary"].back().get<std::string>(),
              testing::AllOf(HasSubstr("times that of the fitted machine, 8"),
                             HasSubstr("(nominal 20 MN/m)")));
  EXPECT_GT(json["remedy"]["required"]["factor"].get<double>(), 1.2);
  EXPECT_THAT(test::read_text(picture), HasSubstr("guide sleeves of all legs"));
}

/// Each word says which machine it is of.
TEST_F(DiagnoseCommand, CallsNominalWhatTheFileStates) {
  const auto found = run_hydrapod(command({"--measured", modes()}));
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("First resonances of the fitted machine"));
  EXPECT_THAT(found.out, HasSubstr("rigid Hz  fitted Hz  share  required Hz   drop  share  peak"));
  EXPECT_THAT(found.out, HasSubstr("for the fitted machine (undamped modes): the "));
  EXPECT_THAT(found.out, testing::Not(HasSubstr("The nominal stiffness")));
  const auto brief = run_hydrapod(command({"--measured", modes(), "--brief"})).out;
  EXPECT_THAT(brief,
              testing::AllOf(HasSubstr("Identified cause: "), HasSubstr("Required stiffness"),
                             testing::Not(HasSubstr("Calculated at pose"))));
  // rigid legs explain the modes of sleeves like steel: nothing is fitted, and the file's stay
  const auto rigid = json_of({"modes", machine_, "--model", "rigid", "--format", "json"});
  std::string list = "frequency [Hz],deviation [%],x,y,z,rx,ry,rz\n";
  for (const auto& mode : rigid["modes"]) {
    list += fmt::format("{},0.1", mode["frequency_hz"].get<double>());
    const auto& shape = mode["shape"].contains("re") ? mode["shape"]["re"] : mode["shape"];
    for (std::size_t d = 0; d < 6; ++d) list += fmt::format(",{}", shape[d].get<double>());
    list += "\n";
  }
  const auto nothing =
      json_of(command({"--measured", write("rigid.csv", list), "--format", "json"}));
  EXPECT_EQ(nothing["finding"], "no cause");
  EXPECT_EQ(nothing["computed_machine"], "nominal");
  EXPECT_NEAR(nothing["remedy"]["present"]["stiffness_N_m"].get<double>(), 20e6, 1.0);
}

/// Modes whose directions x and z are exchanged, and only these.
TEST_F(DiagnoseCommand, WarnsOfDirectionsThatContradictTheirModes) {
  const std::string machine = (folder_ / "machine.toml").string();  // x at 18 Hz, z at 46 Hz
  ASSERT_EQ(run_hydrapod({"init", machine}).exit_code, 0);
  const auto own = json_of({"modes", machine, "--model", "rigid", "--format", "json"});
  std::string list = "frequency [Hz],direction,deviation [%]\n";
  std::map<std::string, double> at;
  constexpr std::array names{"x", "y", "z", "rx", "ry", "rz"};
  for (const auto& mode : own["modes"]) {
    std::size_t main = 0;
    const auto& energy = mode["platform_energy"];
    for (std::size_t d = 0; d < 6; ++d)
      if (energy[d] > energy[main]) main = d;
    const std::string name = names.at(main);
    const std::string stated = name == "x" ? "z" : name == "z" ? "x" : name;
    at[stated] = mode["frequency_hz"].get<double>();
    list += fmt::format("{},{},0.1\n", at[stated], stated);
  }
  const auto file = write("exchanged.csv", list);
  const auto json = json_of({"diagnose", machine, "--measured", file, "--format", "json"});
  for (const auto& mode : json["measured_modes"]) {
    const auto name = mode["direction"].get<std::string>();
    const auto other = name == "x" ? "z" : name == "z" ? "x" : "";
    EXPECT_EQ(mode.value("mode_direction", ""), other);
    if (*other == '\0') continue;
    // of the mode itself, not of the direction that was stated
    EXPECT_NEAR(mode["rigid_hz"].get<double>(), at[name], 1e-3 * at[name]);
    EXPECT_THAT(json["notes"].dump(),
                HasSubstr(fmt::format("the direction {} stated for {:.2f} Hz", name, at[name])));
  }
  EXPECT_EQ(json["notes"].size(), 2U);
  const auto shown = run_hydrapod({"diagnose", machine, "--measured", file});
  EXPECT_THAT(shown.out, HasSubstr("contradicts the mode paired with it"));
  EXPECT_THAT(shown.out, HasSubstr("z (mode: x)"));
  const auto fitted = run_hydrapod({"calibrate", machine, "--targets", file, "--free",
                                    "legs.oil_spring.cylinder.bulk_modulus", "--format", "json"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const auto calibrated = nlohmann::json::parse(fitted.out);
  EXPECT_THAT(calibrated["remarks"].dump(), HasSubstr("its direction z contradicts the mode"));
  for (const auto& target : calibrated["candidates"][0]["targets"]) {
    if (target["direction"] == "z") EXPECT_EQ(target.value("mode_direction", ""), "x");
    if (target["direction"] == "y") EXPECT_FALSE(target.contains("mode_direction"));
  }
}

/// The promised stiffness, put into the file, gives the promised frequency in `hydrapod modes`.
/// (Heavy dampers would move it by some tenths of a per cent.)
TEST_F(DiagnoseCommand, RemedyHoldsWhenItIsTried) {
  const std::vector<std::string> undamped{"--set",    "legs.guide_sleeve.damping=0",
                                          "--set",    "legs.oil_spring.damping=0",
                                          "--format", "json"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), undamped.begin(), undamped.end());
    return json_of(words);
  };
  const auto wanted = with({"diagnose", machine_, "--want", "x=5 Hz", "--poses", "neutral"});
  ASSERT_EQ(wanted["remedy"]["status"], "found");
  const double stiffness = wanted["remedy"]["required"]["stiffness_N_m"].get<double>();
  const auto mended = with(
      {"modes", machine_, "--set", fmt::format("legs.guide_sleeve.stiffness={:.12g}", stiffness)});
  EXPECT_NEAR(mended["modes"][0]["frequency_hz"].get<double>(), 5.0, 1e-4);
}

/// What studies require is written the same way here.
TEST_F(DiagnoseCommand, AGoalMayBeWrittenAsARequirement) {
  const auto remedy = [&](const std::string& want) {
    return json_of({"diagnose", machine_, "--want", want, "--format", "json"})["remedy"].dump();
  };
  EXPECT_EQ(remedy("x >= 5 Hz"), remedy("x=5 Hz"));
  EXPECT_EQ(remedy("drop <= 3 %"), remedy("3 %"));
  EXPECT_EQ(remedy("lowest >= 5 Hz"), remedy("5 Hz"));
}

TEST_F(DiagnoseCommand, WithoutAMeasurementSaysWhatTheDropBelongsTo) {
  const auto run = run_hydrapod({"diagnose", machine_});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("guide sleeves of all legs 100 %"));
  EXPECT_THAT(run.out, HasSubstr("Required stiffness of the guide sleeves for "));
  EXPECT_THAT(run.out, HasSubstr("guide sleeve of leg 6"));
}

TEST_F(DiagnoseCommand, SaysWhyRigidLegsHaveNothingToAttribute) {
  const auto run = run_hydrapod({"diagnose", machine_, "--model", "rigid"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("There is no frequency drop to attribute and no stiffness of "
                                 "guide sleeves to require: the legs of the rigid model do not "
                                 "bend."));
  for (const auto& [option, value] : {std::pair{"--want", "x=5 Hz"}, std::pair{"--poses", "low"}}) {
    const auto refused = run_hydrapod({"diagnose", machine_, "--model", "rigid", option, value});
    EXPECT_EQ(refused.exit_code, 2) << refused.out;
    EXPECT_THAT(refused.err,
                HasSubstr(fmt::format("{} {}: error: is about guide sleeves", option, value)));
  }
  const auto struts = run_hydrapod({"diagnose", write("struts.toml", test::strut_file)});
  EXPECT_EQ(struts.exit_code, 0) << struts.err;
  EXPECT_THAT(struts.out, HasSubstr("plain struts have no seals"));
}

TEST_F(DiagnoseCommand, WrongUnitsBlameNobody) {
  const auto run = run_hydrapod(command({"--measured", modes(1000.0)}));
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("do not match; no cause is identified"));
  EXPECT_THAT(run.out, HasSubstr("a unit wrong by 1000"));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("Identified cause")));
}

/// Records at two poses, the second said with its file; responses to drives count unless they are
/// not wanted. (The oil of the file is ten times too stiff: said at once, before anything is
/// fitted.)
TEST_F(DiagnoseCommand, RecordsAtSeveralPosesAreOneMeasurement) {
  const auto record = [&](const std::string& pose) {
    const auto path = (folder_ / (pose + ".h5")).string();
    const std::string level =
        "white x=0.2 mm, y=0.2 mm, z=0.2 mm, rx=0.1 mrad, ry=0.1 mrad, rz=0.1 mrad";
    std::vector<std::string> rig{"rig", machine_,   "--pose", pose, "--duration",
                                 "30",  "--excite", level,    "-o", path};
    rig.insert(rig.end(), stiff_.begin(), stiff_.end());
    for (const char* value : {"bulk_modulus=0.8 GPa", "air.fraction=0.001"})
      rig.insert(rig.end(), {"--set", std::string("legs.oil_spring.cylinder.") + value});
    const auto run = run_hydrapod(rig);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return path;
  };
  auto words =
      command({"--set", "legs.oil_spring.cylinder.bulk_modulus=8 GPa", "--set",
               "legs.oil_spring.cylinder.air.fraction=0.001", "--measured", record("neutral"),
               "--measured", record("low") + "@low", "--poses", "neutral", "--format", "json"});
  const auto diagnosed = [&] {
    const auto run = run_hydrapod(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  };
  const auto json = diagnosed();
  EXPECT_EQ(json["observed"], "plant");
  EXPECT_EQ(json["finding"], "mismatch");
  ASSERT_EQ(json["response_lines"].size(), 2U);
  EXPECT_EQ(json["response_lines"][0]["pose"], "neutral");
  EXPECT_EQ(json["response_lines"][1]["pose"], "low");
  EXPECT_GT(json["response_lines"][1]["frequency_hz"].size(), 3U);
  std::set<std::string> poses;
  for (const auto& mode : json["measured_modes"]) poses.insert(mode["pose"]);
  EXPECT_THAT(poses, testing::ElementsAre("low", "neutral"));
  EXPECT_GT(json["hypotheses"][0]["response_misfit"].get<double>(), 0.0);
  words.push_back("--modes-only");
  const auto modes_only = diagnosed();
  EXPECT_EQ(modes_only["response_lines"].size(), 0U);
  EXPECT_TRUE(modes_only["hypotheses"][0]["response_misfit"].is_null());
  EXPECT_EQ(modes_only["measured_modes"].size(), json["measured_modes"].size());
}

TEST_F(DiagnoseCommand, MistakesAreNamed) {
  struct Wrong {
    std::vector<std::string> arguments;
    std::string message;
  };
  const std::vector<Wrong> wrongs{
      {{"--want", "soft"}, "--want soft"},
      {{"--want", "120 %"}, "a drop above 0 % and below 100 %"},
      {{"--want", "-3 Hz"}, "a frequency above 0"},
      {{"--want", "q=3 Hz"}, "accepted are x, y, z"},
      {{"--want", "3 kg"}, "--want 3 kg"},
      {{"--want", "x <= 5 Hz"}, "a frequency is at least what is wanted"},
      {{"--want", "q >= 5 Hz"}, "accepted are x, y, z"},
      {{"--poses", "nowhere"}, "unknown pose"},
      {{"--pose", "lo"}, "did you mean 'low'"},
      {{"--measured", "nothing.csv"}, "nothing.csv"},
      {{"--measured", write("empty.csv", "")}, "empty.csv"},
      {{"--measured", write("bad.json", "{\"modes\": 3}")}, "modes"},
      {{"--measured", write("list.json", R"({"modes": [{"f": 5.67, "dir": "x"}]})")},
       "a list of modes by hand is CSV with the columns `frequency [Hz]` and `direction`, or TOML"},
      {{"--measured", write("list.csv", "f;direction\n5.67;x\n")},
       "a list of modes has a title row with `frequency [Hz]` or `omega [rad/s]`"},
      {{"--measured", write("broken.json", "{\"modes\": ")}, "not JSON"},
      {{"--measured", modes() + "@low"}, "states the pose of each mode"},
      {{"--measured", "run.h5@lwo"}, "did you mean 'low'"},
      {{"--measured", "run.h5@aloft"}, "it has neutral, low, surge"},
      {{"--measured", "run.h5@"}, "the name of a pose of the machine file"},
      {{"--measured", "run.h5@z=5 mm"}, "expected the name of a pose"},
      {{"--measured", "@low"}, "names no file"},
      {{"--measured", "none.h5@low"}, "none.h5: error: cannot read"},
      {{"--measured", modes(), "--measured", modes()}, "given twice"},
      {{"--response-error", "0"}, "--response-error"},
      {{"--plot", "why.gif"}, "why.gif"},
      {{"--format", "xml"}, "xml"},
      {{"--model-error", "0"}, "--model-error"}};
  for (const auto& wrong : wrongs) {
    const auto run = run_hydrapod(command(wrong.arguments));
    EXPECT_EQ(run.exit_code, 2) << wrong.arguments[1] << '\n' << run.out << run.err;
    EXPECT_THAT(run.err, HasSubstr(wrong.message)) << wrong.arguments[1];
  }
}

/// The rig writes the pose into the record; nobody has to repeat it.
TEST_F(DiagnoseCommand, CalculatedModesAreOfMechanicsThatStand) {
  const auto json_file = [&](const char* name, const std::string& mass) {
    const auto modes =
        run_hydrapod({"modes", machine_, "--set", "platform.mass=" + mass, "--format", "json"});
    return write(name, modes.out);
  };
  const auto sound = json_file("sound.json", "14 t");
  for (const char* other : {"plant", "system"}) {
    const auto run = run_hydrapod(command({"--measured", sound, "--against", other}));
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_THAT(run.err, HasSubstr(fmt::format("--against {}: error: {} holds modes that "
                                               "`hydrapod modes` calculated for the mechanics",
                                               other, sound)));
  }
  const auto buckled = run_hydrapod(command({"--measured", json_file("buckled.json", "18 t")}));
  EXPECT_EQ(buckled.exit_code, 2) << buckled.out;
  EXPECT_THAT(buckled.err, HasSubstr("buckled.json: error: holds the modes of a machine that does "
                                     "not stand"));
  EXPECT_EQ(run_hydrapod(command({"--measured", sound, "--against", "mechanics"})).exit_code, 0);
}

TEST_F(DiagnoseCommand, ARecordCountsAtThePoseThatItStates) {
  for (const std::string pose : {"low", "z=-50 mm, ry=1.3 deg"}) {
    const auto record = (folder_ / "run.h5").string();
    const auto rig = run_hydrapod({"rig", machine_, "--pose", pose, "--duration", "40", "--seed",
                                   "7", "--force", "-o", record});
    ASSERT_EQ(rig.exit_code, 0) << rig.err;
    const auto found = json_of(command({"--measured", record, "--modes-only", "--format", "json"}));
    const std::string name = pose == "low" ? "low" : "as_recorded";
    ASSERT_EQ(found["measured_at"].size(), 1U);
    EXPECT_THAT(found["measured_at"][0].get<std::string>(),
                HasSubstr("pose " + name + ", as the record states"));
    ASSERT_FALSE(found["measured_modes"].empty());
    for (const auto& mode : found["measured_modes"]) EXPECT_EQ(mode["pose"], name);
    const auto other = run_hydrapod(
        command({"--measured", record, "--modes-only", "--pose", "neutral", "--format", "json"}));
    EXPECT_THAT(other.err, HasSubstr("run.h5: warning: states pose " + name +
                                     "; it is taken at pose neutral (--pose, or FILE@POSE)"));
  }
}

}  // namespace
}  // namespace hydrapod
