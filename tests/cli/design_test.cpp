/// `hydrapod design` and `evaluate` as they are called.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/other_legs.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string machine = test::source_file("models/heavy-platform.toml").string();

test::RunResult design(const std::vector<std::string>& more) {
  std::vector<std::string> all{"design", machine, "--samples", "256", "--starts", "2"};
  all.insert(all.end(), more.begin(), more.end());
  return test::run_hydrapod(all);
}

/// The file that is written is the design: `modes` finds what `design` promised.
TEST(DesignCommand, WritesAMachineThatMeetsTheRequirement) {
  const test::TemporaryFolder folder;
  const auto file = (folder / "design.toml").string();
  const auto run =
      design({"--change", "legs.guide_sleeve.stiffness=0.9:20 kN/mm", "--want", "x >= 5.9 Hz",
              "--minimise", "legs.guide_sleeve.stiffness", "-o", file, "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_TRUE(json["feasible"]);
  EXPECT_FALSE(json["requirements"][0]["present"] >= 5.9);
  EXPECT_EQ(json["limits"][0]["kind"], "requirement");
  EXPECT_GT(json["limits"][0]["price"], 0.0);
  const auto modes = test::run_hydrapod({"modes", file, "--format", "json"});
  ASSERT_EQ(modes.exit_code, 0) << modes.err;
  double x = 0.0;
  const auto table = nlohmann::json::parse(modes.out);
  for (const auto& mode : table["modes"])
    if (x == 0.0 && mode["frequency_hz"] >= 5.89) x = mode["frequency_hz"];
  constexpr double damped = 5e-3;  // `modes` lists damped modes
  EXPECT_NEAR(x, 5.9, damped);
  // comments of the file are kept
  const auto text = test::read_text(file), before = test::read_text(machine);
  const auto comments = [](const std::string& of) { return std::ranges::count(of, '#'); };
  EXPECT_GE(comments(text), comments(before));
}

TEST(DesignCommand, SaysWhatCannotBeReached) {
  const test::TemporaryFolder folder;
  const auto file = (folder / "design.toml").string();
  const auto run = design({"--change", "legs.guide_sleeve.stiffness=1:20 kN/mm", "--want",
                           "x >= 9 Hz", "--minimise", "legs.guide_sleeve.stiffness", "-o", file});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("No design was found that meets all requirements"),
                             HasSubstr("x comes to at most 6.11"), HasSubstr("missed")));
  EXPECT_THAT(run.err, HasSubstr("is not written"));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(DesignCommand, TradesOneAimForAnother) {
  const test::TemporaryFolder folder;
  const auto run =
      design({"--change", "legs.guide_sleeve.stiffness=1:20 kN/mm", "--change",
              "platform.mass=12000:15000 kg", "--maximise", "lowest", "--maximise", "platform.mass",
              "--trade-off", "5", "--plot", (folder / "front.svg").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Trade-off"));
  EXPECT_THAT(test::read_text(folder / "front.svg"), HasSubstr("platform.mass [t]"));
}

/// Axes over more than a decade are logarithmic, others are not; both are in the units of the file.
TEST(DesignCommand, DrawsTheRequirementsOverEachChange) {
  const test::TemporaryFolder folder;
  const auto run = design({"--change", "legs.guide_sleeve.stiffness=1:20 kN/mm", "--change",
                           "platform.mass=12000:15000 kg", "--want", "drop <= 60 %", "--maximise",
                           "lowest", "--plot", (folder / "slices.svg").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(test::read_text(folder / "slices.svg"),
              AllOf(HasSubstr("legs.guide_sleeve.stiffness [kN/mm]"), HasSubstr("> 20<"),
                    HasSubstr("platform.mass [t]"), HasSubstr("> 12.5<")));
  // a file without units has numbers in SI, which are large
  const auto file = (folder / "si.toml").string(), picture = (folder / "si.svg").string();
  auto text = test::read_text(machine);
  const std::string soft = "\"0.84 kN/mm\"";
  text.replace(text.find(soft), soft.size(), "8.4e5");
  test::write_text(file, text);
  const auto si = test::run_hydrapod(
      {"design", file, "--change", "legs.guide_sleeve.stiffness=1e6:2e7", "--want", "x >= 5 Hz",
       "--maximise", "lowest", "--samples", "64", "--starts", "1", "--plot", picture});
  ASSERT_EQ(si.exit_code, 0) << si.err;
  EXPECT_THAT(test::read_text(picture),
              AllOf(HasSubstr("legs.guide_sleeve.stiffness [MN/m]"), HasSubstr("> 20<")));
}

TEST(DesignCommand, RefusesWhatItCannotUnderstand) {
  const std::string change = "legs.guide_sleeve.stiffness=1:20 kN/mm";
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"--want", "x >= 6 Hz", "--minimise", "sag"}, "--change: error: is missing"},
      {{"--change", change, "--want", "x >= 6 Hz"}, "--minimise"},
      {{"--change", "legs.guide_sleve.stiffness=1:20 kN/mm", "--minimise", "sag"},
       "did you mean `legs.guide_sleeve.stiffness`"},
      {{"--change", "legs.guide_sleeve.stiffness=1:20 kg", "--minimise", "sag"}, "kg"},
      {{"--change", "legs.guide_sleeve.stiffness=5", "--minimise", "sag"}, "expected PATH=from:to"},
      {{"--change", "platform.mass=-5:20 t", "--minimise", "sag"}, "cannot have"},
      {{"--change", "platform.mass=9:9 t", "--minimise", "sag"}, "both ends are equal"},
      {{"--change", change, "--change", change, "--minimise", "sag"}, "changed twice"},
      {{"--change", change, "--minimise", "sags"}, "did you mean 'sag'"},
      {{"--change", change, "--minimise", "platform.mass"}, "neither an output nor a number"},
      {{"--change", change, "--minimise", "direction"}, "no aim"},
      {{"--change", change, "--minimise", "sag", "--want", "x > 6 Hz"}, ">= or <="},
      {{"--change", change, "--minimise", "sag", "--want", "x >= 6 kg"}, "6 kg"},
      {{"--change", change, "--minimise", "power"}, "pump_flow"},
      {{"--change", change, "--change", "poses.neutral.position[2]=1.5:1.7 m", "--minimise", "sag",
        "--pose", "x=1 mm"},
       "poses.neutral.position[2]: error: has no effect at pose x=1 mm"},
      {{"--change", change, "--minimise", "sag", "--trade-off", "5"}, "two aims"},
      {{"--change", change, "--minimise", "sag", "--minimise", "sag"}, "an aim twice"},
      {{"--change", change, "--minimise", "sag", "--pose", "x=9 m"}, "--pose"}};
  for (const auto& [arguments, message] : wrong) {
    const auto run = design(arguments);
    EXPECT_EQ(run.exit_code, 2) << testing::PrintToString(arguments) << run.err;
    EXPECT_THAT(run.err, HasSubstr(message)) << testing::PrintToString(arguments);
    EXPECT_EQ(run.out, "");
  }
}

/// Before the search: no design would have a value.
TEST(DesignCommand, RefusesOutputsThatOtherMachinesHave) {
  const test::TemporaryFolder folder;
  const auto screws = (folder / "screws.toml").string(), struts = (folder / "struts.toml").string();
  test::write_text(screws, test::screw_file);
  test::write_text(struts, test::strut_file);
  const std::vector<std::array<std::string, 3>> wrong{
      {screws, "power", "power is that of the pump, and electric cylinders have none"},
      {screws, "jerk_x", "jerk_x is not limited"},
      {struts, "power", "power is that of the pump, and plain struts have none"},
      {struts, "drop_x", "drop_x compares flexible legs with rigid ones"},
      {struts, "stroke", "stroke is what pistons have left, and plain struts have none"},
      {struts, "sag", "sag is an offset at guide sleeves, and plain struts have none"},
      {struts, "velocity_z", "velocity_z is a limit of drives, and plain struts have none"}};
  for (const auto& [file, output, message] : wrong)
    for (const bool wanted : {true, false}) {
      std::vector<std::string> arguments{"design",     file,
                                         "--change",   "platform.mass=800:1200 kg",
                                         "--maximise", wanted ? "platform.mass" : output};
      if (wanted) arguments.insert(arguments.end(), {"--want", output + " >= 1"});
      const auto run = test::run_hydrapod(arguments);
      EXPECT_EQ(run.exit_code, 2) << output << run.out;
      EXPECT_THAT(run.err, AllOf(HasSubstr(message), HasSubstr("outputs of this machine are"),
                                 HasSubstr("oil_force")));
    }
}

/// Dakota's files (Reference Manual, parameters file format).
struct Evaluate : testing::Test {
  test::TemporaryFolder folder{};
  std::string parameters = (folder / "params.in").string();
  std::string results = (folder / "results.out").string();

  test::RunResult run(const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{"evaluate", "--machine", machine};
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {parameters, results});
    return test::run_hydrapod(all);
  }
  /// Numbers of the results file.
  std::vector<double> numbers() {
    std::vector<double> found;
    std::istringstream text(test::read_text(results));
    for (std::string word; text >> word;) {
      char* end = nullptr;
      const double value = std::strtod(word.c_str(), &end);
      if (end != word.c_str() && *end == '\0') found.push_back(value);
    }
    return found;
  }
  void write(double stiffness, double mass, int first, int second) {
    test::write_text(parameters,
                     fmt::format(R"(                                          2 variables
                      {:.15e} legs.guide_sleeve.stiffness
                      {:.15e} platform.mass
                                          2 functions
                                          {} ASV_1:lowest
                                          {} ASV_2:condition
                                          2 derivative_variables
                                          1 DVV_1:legs.guide_sleeve.stiffness
                                          2 DVV_2:platform.mass
                                          0 analysis_components
                                          3.7 eval_id
)",
                                 stiffness, mass, first, second));
  }
};

/// Dakota asks for the same file again; what is no results file of Dakota stays.
TEST_F(Evaluate, ReplacesItsOwnResultsAlone) {
  write(2.3e6, 14100.0, 3, 1);
  ASSERT_EQ(run().exit_code, 0);
  EXPECT_EQ(run().exit_code, 0);
  for (const char* text : {"a note\n", "1 2\n3 4\n", "FAIL\nnot so\n", "7.9 lowest mode\n"}) {
    test::write_text(results, text);
    const auto refused = run();
    EXPECT_EQ(refused.exit_code, 2) << text;
    EXPECT_THAT(refused.err, HasSubstr("was left as it is")) << text;
    EXPECT_EQ(test::read_text(results), text);
  }
  test::write_text(results, "FAIL\n");
  EXPECT_EQ(run().exit_code, 0);
}

TEST_F(Evaluate, AnswersTheStandardFormat) {
  write(2.3e6, 14100.0, 3, 1);
  const auto evaluated = run();
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_THAT(evaluated.err, HasSubstr("evaluation 3.7: frequencies of undamped modes: lowest\n"));
  const auto found = numbers();
  ASSERT_EQ(found.size(), 4U) << test::read_text(results);  // two values, one gradient
  const auto sensitivity = test::run_hydrapod(
      {"sensitivity", machine, "--set", "legs.guide_sleeve.stiffness=2.3e6", "--set",
       "platform.mass=14100", "--parameter", "platform.mass", "--format", "json"});
  const auto json = nlohmann::json::parse(sensitivity.out);
  // studies have undamped frequencies, sensitivities those that damping has shifted a little
  EXPECT_NEAR(found[0], json["modes"][0]["frequency_hz"], 1e-6);
  const double relative = json["percent_per_percent"][0][0];
  EXPECT_NEAR(found[3], relative * found[0] / 14100.0, 1e-5 * std::abs(found[3]));
  // the gradient against two more evaluations
  const double h = 1.4;
  write(2.3e6, 14100.0 + h, 1, 1);
  ASSERT_EQ(run({"--force"}).exit_code, 0);
  const double above = numbers()[0];
  write(2.3e6, 14100.0 - h, 1, 1);
  ASSERT_EQ(run({"--force"}).exit_code, 0);
  const double slope = (above - numbers()[0]) / (2.0 * h);
  EXPECT_NEAR(found[3], slope, 1e-6 * std::abs(slope));
}

TEST_F(Evaluate, AnswersTheApreproFormatInOtherUnits) {
  write(2.3e6, 14100.0, 3, 3);
  ASSERT_EQ(run().exit_code, 0);
  const auto si = numbers();
  ASSERT_EQ(si.size(), 6U);
  test::write_text(parameters, R"(                    { DAKOTA_VARS = 2 }
                    { k = 2.300000000000000e+00 }
                    { m = 1.410000000000000e+01 }
                    { DAKOTA_FNS = 2 }
                    { ASV_1:obj_fn = 3 }
                    { ASV_2:nln_ineq_con_1 = 2 }
                    { DAKOTA_DER_VARS = 1 }
                    { DVV_1:k = 1 }
                    { DAKOTA_AN_COMPS = 0 }
                    { DAKOTA_EVAL_ID = 12 }
)");
  const auto evaluated =
      run({"--variable", "k=legs.guide_sleeve.stiffness [kN/mm]", "--variable",
           "m = platform.mass [t]", "--function", "lowest", "--function", "condition"});
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_THAT(test::read_text(results), HasSubstr("obj_fn"));
  EXPECT_THAT(evaluated.err, AllOf(HasSubstr("evaluation 12"), HasSubstr("condition")));
  const auto found = numbers();
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0], si[0], 1e-12 * si[0]);
  EXPECT_NEAR(found[1], si[2] * 1e6, 1e-9 * std::abs(si[2] * 1e6));  // by kN/mm
}

TEST_F(Evaluate, ReportsAFailureAsDakotaExpects) {
  write(1.0e3, 14100.0, 1, 1);  // seals that hold nothing
  const auto evaluated = run();
  EXPECT_EQ(evaluated.exit_code, 0);
  EXPECT_EQ(test::read_text(results), "FAIL\n");
  EXPECT_THAT(evaluated.err, AllOf(HasSubstr("evaluation 3.7"), HasSubstr("FAIL")));
}

TEST_F(Evaluate, RefusesFilesThatAreWrong) {
  const auto refused = [&](const std::string& message, const std::vector<std::string>& more = {}) {
    const auto evaluated = run(more);
    EXPECT_EQ(evaluated.exit_code, 2) << evaluated.err;
    EXPECT_THAT(evaluated.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(results));
  };
  write(2.3e6, 14100.0, 4, 1);
  refused("Hessian");
  write(2.3e6, 14100.0, 9, 1);
  refused("sum of 1, 2 and 4");
  write(2.3e6, 14100.0, 1, 1);
  refused("is no output", {"--function", "lowest", "--function", "conditon"});
  refused("1 outputs for the 2 functions", {"--function", "lowest"});
  refused("no variable of", {"--variable", "k=platform.mass"});
  test::write_text(
      parameters,
      "1 variables\n3 platfrm.mass\n1 functions\n1 ASV_1:lowest\n0 derivative_variables\n");
  refused("did you mean `platform.mass`");
  refused("params.in:2:1: error");
  test::write_text(parameters, "2 variables\n3 platform.mass\n");
  refused("2 entries are to follow");
  test::write_text(parameters, "mass = 3\n");
  refused("params.in:1");
  test::write_text(parameters,
                   "1 variables\nnan platform.mass\n1 functions\n1 ASV_1:lowest\n"
                   "0 derivative_variables\n");
  refused("not a number");
}

}  // namespace
}  // namespace hydrapod
