/// `hydrapod calibrate` and `hydrapod sensitivity` as somebody uses them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/csv.hpp"
#include "support/json_fields.hpp"

namespace hydrapod {
namespace {

using test::json_of;
using test::run_hydrapod;
using testing::HasSubstr;

class Calibrate : public testing::Test {
 protected:
  const std::string machine_ = test::source_file("models/zhang-jiang-2021.toml").string();
  test::TemporaryFolder folder_;
  std::string write(const std::string& name, const std::string& text) {
    test::write_text(folder_ / name, text);
    return (folder_ / name).string();
  }
  const std::string measured_ = write("measured.csv",
                                      "frequency [Hz],direction,deviation [%]\n"
                                      "7.02,x,0.1\n7.02,y,0.1\n21.5,z,0.1\n28.4,rx,0.1\n"
                                      "28.4,ry,0.1\n16.83,rz,0.1\n");
};

TEST_F(Calibrate, WritesTheMachineWithItsCommentsAndSaysHowSureItIs) {
  const std::string output = (folder_ / "out.toml").string();
  const auto run = run_hydrapod({"calibrate", machine_, "--targets", measured_, "--free",
                                 "legs.oil_spring.stiffness=1 MN/m..9 MN/m", "-o", output});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("legs.oil_spring.stiffness"));
  EXPECT_THAT(run.out, HasSubstr("determined"));
  const auto text = test::read_text(output);
  EXPECT_THAT(text, HasSubstr("# k_h, N/m [identified]; calibrated: stiffness 3.4"));
  EXPECT_THAT(text, HasSubstr("(was 3.8535e+06)"));
  EXPECT_THAT(text, HasSubstr("# m_t, kg [identified]"));
  const auto modes = json_of({"modes", output, "--format", "json"});
  EXPECT_NEAR(modes["modes"][0]["frequency_hz"].get<double>(), 7.02, 0.03);
  EXPECT_THAT(run.out, HasSubstr("\nmachine: nominal\n"));
  EXPECT_EQ(modes["machine"]["state"], "calibrated");
  EXPECT_THAT(run_hydrapod({"modes", output}).out, HasSubstr("\nmachine: calibrated\n"));
}

/// The file writes "0.84 kN/mm" for all legs, and nothing for leg 3.
TEST_F(Calibrate, ShowsANumberOfOneLegInTheUnitOfAllLegs) {
  const std::string heavy = test::source_file("models/heavy-platform.toml").string();
  const std::string modes = (folder_ / "modes.json").string();
  ASSERT_EQ(run_hydrapod({"modes", heavy, "-o", modes}).exit_code, 0);
  const auto run = run_hydrapod(
      {"calibrate", heavy, "--targets", modes, "--free", "leg.3.guide_sleeve.stiffness"});
  EXPECT_THAT(run.out, HasSubstr("\nHz: |λ| of damped modes\n"));
  EXPECT_THAT(run.out,
              testing::ContainsRegex("leg.3.guide_sleeve.stiffness +0.84 +0.8[0-9]* +kN/mm"));
}

/// Wherever the search began: what has no effect is not replaced by a random number.
TEST_F(Calibrate, LeavesWhatTheTargetsDoNotDetermine) {
  const std::string output = (folder_ / "out.toml").string();
  const auto run =
      run_hydrapod({"calibrate", machine_, "--targets", measured_, "--free",
                    "legs.oil_spring.stiffness", "--free", "legs.rod.axial_inertia", "-o", output});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, testing::ContainsRegex(
                           "legs.rod.axial_inertia +0.0084 +0.0084 +kg m\\^2 +not determined"));
  EXPECT_THAT(run.out, HasSubstr("legs.rod.axial_inertia: not determined by the data, left at its "
                                 "start, 0.0084 kg m^2"));
  const auto text = test::read_text(output);
  EXPECT_THAT(text, HasSubstr("\naxial_inertia = 0.0084  "));
  EXPECT_THAT(text, HasSubstr("I_ra, kg m^2 [identified]; calibrated: axial_inertia not determined "
                              "by the data, left as it was\n"));
  EXPECT_THAT(text, HasSubstr("calibrated: stiffness 3.4"));
}

/// A frequency in revolutions per minute is met by no mode.
TEST_F(Calibrate, TargetsThatNothingMeetsGiveNoMachine) {
  const std::string output = (folder_ / "none.toml").string();
  const std::vector<std::string> words{
      "calibrate", machine_,
      "--targets", write("rpm.csv", "frequency [Hz],direction,deviation [%]\n65000,x,0.1\n"),
      "--free",    "platform.mass=500 kg..2 t",
      "-o",        output};
  const auto run = run_hydrapod(words);
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("is not calibrated"));
  EXPECT_THAT(run.out, HasSubstr("1 has an effect"));
  EXPECT_THAT(run.err, HasSubstr("check the unit of the target"));
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(Calibrate, GivesJsonWithProfileAndDrawsAPicture) {
  const std::string plot = (folder_ / "fit.svg").string();
  const auto run = run_hydrapod({"calibrate", machine_, "--targets", measured_, "--free",
                                 "legs.oil_spring.stiffness", "--free", "platform.mass",
                                 "--profile", "platform.mass", "--try", "environment.gravity=9.81",
                                 "--format", "json", "--plot", plot});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "wrote " + plot + "\n");
  const auto json = test::Json::parse(run.out);
  EXPECT_EQ(json["kind"], "calibration");
  EXPECT_EQ(json["candidates"].size(), 2U);
  EXPECT_EQ(json["candidates"][0]["parameters"].size(), 2U);
  EXPECT_EQ(json["profiles"][0]["paths"][0], "platform.mass");
  EXPECT_GE(json["profiles"][0]["values"].size(), 10U);
  EXPECT_THAT(test::read_text(plot), HasSubstr("<svg"));
}

TEST_F(Calibrate, SaysWhatIsWrong) {
  struct Wrong {
    std::vector<std::string> arguments;
    std::string message;
  };
  const std::vector<Wrong> all{
      {{"--targets", measured_}, "no parameter is free"},
      {{"--targets", measured_, "--free", "legs.oil_spring.stifness"},
       "did you mean `legs.oil_spring.stiffness`?"},
      {{"--targets", measured_, "--free", "legs.rod.mass=3 kg"},
       "expected PATH or PATH=LOWEST..HIGHEST"},
      {{"--targets", measured_, "--free", "legs.rod.mass=3 kg..1 kg"}, "is not below the highest"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "--prior", "legs.rod.mass=3"},
       "expected PATH=VALUE+-SPREAD"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "--prior", "platform.mass=3+-1"},
       "is not free"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "--profile", "platform.mass"},
       "is not one of the free parameters"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "--loss", "l2"}, "--loss"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "-o", (folder_ / "no/a.toml").string()},
       "there is no folder"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "-o", "-"}, "give a file"},
      {{"--targets", measured_, "--free", "legs.rod.mass", "--plot", "fit.doc"}, ".svg"},
      {{"--targets", (folder_ / "none.csv").string(), "--free", "legs.rod.mass"},
       "cannot be opened: No such file or directory"},
  };
  for (std::size_t k = 0; k < all.size(); ++k) {
    auto arguments = all[k].arguments;
    arguments.insert(arguments.begin(), {"calibrate", machine_});
    const auto run = run_hydrapod(arguments);
    EXPECT_EQ(run.exit_code, 2) << all[k].message;
    EXPECT_THAT(run.err, HasSubstr(all[k].message));
  }
}

/// The file must say what was fitted, whatever the choices replace.
TEST_F(Calibrate, WritesChoicesThatReplaceTables) {
  const std::string heavy = test::source_file("models/heavy-platform.toml").string();
  const std::string output = (folder_ / "out.toml").string();
  const std::string measured =
      write("soft.csv",
            "frequency [Hz],direction,deviation [%]\n2.68,x,0.3\n2.66,y,0.3"
            "\n3.75,z,0.3\n3.23,rx,0.3\n3.18,ry,0.3\n3.82,rz,0.3\n");
  const auto run = run_hydrapod(
      {"calibrate", heavy, "--targets", measured, "--starts", "1", "--set",
       "legs.oil_spring={stiffness=\"3 kN/mm\"}", "--free", "legs.guide_sleeve.stiffness", "--free",
       "leg.2.guide_sleeve.stiffness", "--free", "leg.3.rod.mass", "-o", output});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto text = test::read_text(output);
  EXPECT_THAT(text, HasSubstr("stiffness = \"3 kN/mm\"  # calibrated: stiffness chosen"));
  EXPECT_THAT(text, HasSubstr("# [legs.oil_spring.cylinder]\n# bore = \"100 mm\"\n"));
  // calibrated again: remarks are replaced, not heaped up
  const std::string second = (folder_ / "second.toml").string();
  const auto again = run_hydrapod({"calibrate", output, "--targets", measured, "--starts", "1",
                                   "--free", "leg.3.rod.mass", "-o", second});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto twice = test::read_text(second);
  const auto first = twice.find("calibrated: mass ");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(twice.find("calibrated: mass ", first + 1), std::string::npos);
  const auto state = twice.find("state = \"calibrated\"");
  ASSERT_NE(state, std::string::npos);
  EXPECT_EQ(twice.find("state = ", state + 1), std::string::npos);
}

/// "1.4 GPa" in the file is 1.4 GPa in the table, not 1.4e+09 Pa.
TEST_F(Calibrate, PrintsInTheUnitsOfTheMachineFile) {
  const auto targets = write("heavy.csv",
                             "frequency [Hz],direction,deviation [%]\n"
                             "4.10,x,0.1\n4.10,y,0.1\n7.9,z,0.1\n");
  const auto run = run_hydrapod(
      {"calibrate", test::source_file("models/heavy-platform.toml").string(), "--targets", targets,
       "--free", "legs.oil_spring.cylinder.bulk_modulus", "--free", "legs.guide_sleeve.stiffness"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(
      run.out,
      testing::AllOf(
          testing::ContainsRegex("legs.oil_spring.cylinder.bulk_modulus +1.4 +0\\.[0-9]+ +GPa"),
          testing::ContainsRegex("legs.guide_sleeve.stiffness +0.84 +0\\.[0-9]+ +kN/mm"),
          HasSubstr("model Hz  diff Hz")));
}

TEST_F(Calibrate, LeavesNoFileWhenItFails) {
  const std::string output = (folder_ / "out.toml").string();
  run_hydrapod(
      {"calibrate", machine_, "--targets", measured_, "--free", "legs.rod.mas", "-o", output});
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(Sensitivity, IsTheSameInAllFormats) {
  const std::string machine = test::source_file("models/heavy-platform.toml").string();
  const auto json = json_of({"sensitivity", machine, "--pose", "z=-20 mm", "--parameter",
                             "legs.guide_sleeve.stiffness", "--parameter",
                             "legs.oil_spring.cylinder.bulk_modulus", "--format", "json"});
  EXPECT_EQ(json["parameters"][0]["path"], "legs.guide_sleeve.stiffness");
  // under gravity a softer knee also carries less: more than half a per cent per per cent
  EXPECT_GT(json["percent_per_percent"][0][0].get<double>(), 0.5);
  const auto csv = run_hydrapod({"sensitivity", machine, "--pose", "z=-20 mm", "--parameter",
                                 "legs.guide_sleeve.stiffness", "--format", "csv"});
  EXPECT_THAT(csv.out, HasSubstr("mode,omega_rad_s,frequency_hz,legs.guide_sleeve.stiffness\n1,"));
  const auto table = run_hydrapod({"sensitivity", machine});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("legs.oil_spring.cylinder.bulk_modulus"));
  const auto wrong =
      run_hydrapod({"sensitivity", machine, "--parameter", "legs.guide_sleeve.stifness"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean `legs.guide_sleeve.stiffness`?"));
}

}  // namespace
}  // namespace hydrapod
