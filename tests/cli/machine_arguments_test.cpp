/// FILE, --set, --pose, --model, --format and -o, which all commands take alike.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "hydrapod/terminal.hpp"
#include "support/json_fields.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;
using test::run_hydrapod;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string published_file = test::source_file("models/zhang-jiang-2021.toml").string();
const std::string heavy_file = test::source_file("models/heavy-platform.toml").string();

class MachineCommand : public testing::TestWithParam<std::string> {
 protected:
  /// Runs the command on `file`, in a folder of its own.
  test::RunResult run(const std::vector<std::string>& more, const std::string& file = heavy_file) {
    std::vector<std::string> arguments{GetParam(), file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_hydrapod(arguments, {.folder = folder_.path()});
  }
  test::TemporaryFolder folder_;
};

TEST_P(MachineCommand, SaysWhichMachineItsResultsAreOf) {
  EXPECT_THAT(run({}).out, HasSubstr("\nmachine: nominal\n"));
  const auto heavier = run({"--set", "platform.mass=14.1 t"});
  EXPECT_THAT(heavier.out, HasSubstr("\nmachine: nominal, with platform.mass=14.1 t\n"));
  const auto worn = (folder_ / "worn.toml").string();
  test::write_text(worn, "state = \"with worn sleeves\"\n" + test::read_text(heavy_file));
  EXPECT_THAT(run({}, worn).out, HasSubstr("\nmachine: with worn sleeves\n"));
  const auto json = nlohmann::json::parse(run({"--format", "json"}, worn).out);
  EXPECT_EQ(json.at("machine").at("state"), "with worn sleeves");
}

struct WrongCall {
  std::vector<std::string> arguments;
  std::string error;
};

TEST_P(MachineCommand, SaysWhatIsWrongWithItsArguments) {
  const std::vector<WrongCall> calls{
      {{"--pose", "nutral"}, "--pose nutral: error: unknown pose; did you mean 'neutral'?\n"},
      {{"--pose", "upside"},
       "--pose upside: error: unknown pose; the file has neutral, low, surge, pitched\n"},
      {{"--pose", "w=3"}, "--pose w=3: error: unknown key 'w'; accepted are x, y, z, rx, ry, rz\n"},
      {{"--pose", "z=5 deg"},
       "--pose z=5 deg: error: z: \"5 deg\" has the unit \"deg\" (an angle), expected a length "
       "such "
       "as "
       "\"m\"\n"},
      {{"--pose", "ry=5 mm"},
       "--pose ry=5 mm: error: ry: \"5 mm\" has the unit \"mm\" (a length), expected an angle such "
       "as "
       "\"rad\"\n"},
      {{"--pose", "z=2 %"},
       "--pose z=2 %: error: z: \"2 %\" has the unit \"%\" (a pure number), expected a length such "
       "as "
       "\"m\"\n"},
      {{"--pose", "z=nan"}, "--pose z=nan: error: z: \"nan\" is not a finite number\n"},
      {{"--pose", "z=1 mm, z=2 mm"}, "--pose z=1 mm, z=2 mm: error: z is given twice\n"},
      {{"--model", "giude"},
       "--model giude: error: unknown value; did you mean 'guide'? accepted are rigid, guide, "
       "full\n"},
      {{"--model", "full"},
       "--model full: error: not every leg has a piston ring; give legs.piston_ring.stiffness in "
       "the "
       "file or with --set legs.piston_ring.stiffness=\"… N/m\"\n"},
      {{"--set", "platform.mas=3"},
       "--set platform.mas=3: error: platform.mas: unknown key; did you mean `mass`?\n"},
      {{"--set", "platform.mass=3 m"},
       "--set platform.mass=3 m: error: platform.mass: \"3 m\" has the unit \"m\" (a length), "
       "expected a mass such as \"kg\"\n"},
      {{"--set", "platform.mass"},
       "--set platform.mass: error: no \"=\", expected PATH=VALUE such as "
       "legs.guide_sleeve.stiffness=2e6 N/m\n"},
      {{"-o", "no/where"}, "no/where: error: cannot write the file: there is no folder 'no'\n"}};
  for (const auto& call : calls) {
    const auto result = run(call.arguments);
    EXPECT_EQ(result.exit_code, 2) << call.error;
    EXPECT_EQ(result.err, call.error);
    EXPECT_EQ(result.out, "");
  }
  EXPECT_TRUE(fs::is_empty(folder_.path())) << "nothing is left behind";
}

TEST_P(MachineCommand, NamesTheFormatMeant) {
  const auto result = run({"--format", "jsno"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, testing::StartsWith("--format jsno: error: unknown value; did you mean "
                                              "'json'? accepted are table, json"));
}

TEST_P(MachineCommand, RefusesAPoseOutOfReach) {
  const auto result = run({"--pose", "z=0.9"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err,
              AllOf(testing::StartsWith("--pose z=0.9: error: the piston of leg 1 is "),
                    HasSubstr(" m beyond its stroke from 0.36 m to 1.22 m; also all other "
                              "legs; did you mean \"z=0.9 mm\"?\n")));
  // with its unit too, where nobody writes so few millimetres and degrees
  EXPECT_THAT(run({"--pose", "z=5 m"}).err, testing::EndsWith("; did you mean \"z=5 mm\"?\n"));
  EXPECT_THAT(run({"--pose", "z=0.9 m"}).err, Not(HasSubstr("did you mean")));
  EXPECT_EQ(
      run({"--pose", "x=1 mm, rx=5 rad"}).err,
      "--pose x=1 mm, rx=5 rad: error: turns the platform by more than half a turn, 5 rad; did "
      "you mean \"x=1 mm, rx=5 deg\"?\n");
}

TEST_P(MachineCommand, NamesAFileThatIsNotThere) {
  const auto result = run({}, "not-there.toml");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "not-there.toml: error: cannot be opened: No such file or directory\n");
  EXPECT_EQ(run_hydrapod({GetParam()}).err, "error: FILE is required\n");
}

TEST_P(MachineCommand, LeavesNoHalfFileWhereItCannotWrite) {
  test::write_text(folder_ / "old", "old");
  fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
  const auto result = run({"-o", "new"});
  fs::permissions(folder_.path(), fs::perms::owner_all);
  if (result.exit_code == 0) GTEST_SKIP() << "permissions do not bind the superuser";
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, testing::StartsWith("new: error: cannot write the file"));
  EXPECT_FALSE(fs::exists(folder_ / "new"));
  EXPECT_EQ(test::read_text(folder_ / "old"), "old");
}

TEST_P(MachineCommand, KeepsItsOutputCleanOfColourAndMessages) {
  for (const char* format : {"table", "json"}) {
    const auto result = run({"--format", format});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out, Not(HasSubstr("\033")));
  }
  EXPECT_TRUE(test::Json::accept(run({"--format", "json"}).out));
}

TEST_P(MachineCommand, SaysTheSameTwice) {
  EXPECT_EQ(run({"--format", "json"}).out, run({"--format", "json"}).out);
}

INSTANTIATE_TEST_SUITE_P(, MachineCommand, testing::Values("modes", "bode", "check"),
                         [](const auto& test) { return test.param; });

/// What `call` shows on a pseudo terminal of so many columns, made by script(1).
std::string on_a_terminal(int columns, const std::string& call) {
  const std::string sized = "stty cols " + std::to_string(columns) + "; " + call;
  return test::run_program("script", {"-qec", sized, "/dev/null"},
                           {.variables = {{"TERM", "xterm"}}})
      .out;
}

TEST(Terminal, GetsTablesThatFit) {
  if (on_a_terminal(80, "echo here").empty()) GTEST_SKIP() << "no pseudo terminals here";
  const std::string call = "env NO_COLOR=1 " + test::hydrapod_program().string() + " modes '" +
                           published_file + "' --set platform.mass='900 kg'";
  const std::string narrow = on_a_terminal(80, call);
  EXPECT_THAT(narrow, AllOf(HasSubstr("mode      Hz    rad/s  damping"), HasSubstr("by --set"),
                            HasSubstr("\nmode  kinetic energy")));
  const std::string wide = on_a_terminal(220, call);
  EXPECT_THAT(wide, Not(HasSubstr("\nmode  kinetic energy")));
}

/// Long lines take several rows of the terminal.
TEST(Terminal, BriefFitsTwentyFourRows) {
  if (on_a_terminal(80, "echo here").empty()) GTEST_SKIP() << "no pseudo terminals here";
  for (const char* command : {"modes", "check", "sensitivity", "diagnose"}) {
    std::istringstream text(
        on_a_terminal(80, fmt::format("env NO_COLOR=1 {} {} '{}' --brief --quiet",
                                      test::hydrapod_program().string(), command, heavy_file)));
    std::size_t rows = 0;
    for (std::string line; std::getline(text, line);) {
      std::erase(line, '\r');
      rows += std::max<std::size_t>(1, (cli::display_width(line) + 79) / 80);
    }
    EXPECT_GT(rows, 5U) << text.str();
    EXPECT_LE(rows, 24U) << text.str();
  }
}

}  // namespace
}  // namespace hydrapod
