/// What results say of how they were made: the command they name makes them again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hydrapod/base/error.hpp"
#include "hydrapod/reproduction.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {
using nlohmann::json;
using test::read_text;
using test::run_hydrapod;
namespace fs = std::filesystem;

/// As the program `sha256sum` has it.
std::string sum_of(const fs::path& file) {
  return test::run_program("sha256sum", {file.string()}).out.substr(0, 64);
}

class Reproduction : public testing::Test {
 protected:
  Reproduction() {
    fs::copy_file(test::source_file("models/zhang-jiang-2021.toml"),
                  folder / "it's a machine.toml");
  }

  test::RunResult run(const std::vector<std::string>& arguments) const {
    return run_hydrapod(arguments, {.folder = folder.path(), .timeout = 120.0});
  }

  std::string text(const std::string& file) const { return read_text(folder / file); }

  /// Runs it, then the command that its result names; both results are equal to the last byte.
  json expect_repeatable(const std::vector<std::string>& arguments) const {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const std::string& output = arguments.back();
    const auto first = run(arguments);
    EXPECT_EQ(first.exit_code, 0) << first.err;
    const std::string before = text(output);
    const auto made = json::parse(before).at("reproduction");
    EXPECT_EQ(made.at("command"), json(arguments));
    fs::remove(folder / output);
    const auto again = run(made.at("command").get<std::vector<std::string>>());
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(text(output), before);
    for (const auto& input : made.at("inputs")) {
      const fs::path path = folder / input.at("path").get<std::string>();
      EXPECT_EQ(input.at("sha256"), sum_of(path)) << path;
      EXPECT_EQ(input.at("bytes"), fs::file_size(path)) << path;
    }
    return made;
  }

  /// The same of a result that is printed.
  json expect_printed_again(const std::vector<std::string>& arguments) const {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const auto first = run(arguments);
    EXPECT_EQ(first.exit_code, 0) << first.err;
    const auto made = json::parse(first.out).at("reproduction");
    EXPECT_EQ(run(made.at("command").get<std::vector<std::string>>()).out, first.out);
    return made;
  }

  static std::vector<std::string> paths(const json& made) {
    std::vector<std::string> list;
    for (const auto& input : made.at("inputs")) list.push_back(input.at("path"));
    return list;
  }

  test::TemporaryFolder folder;
  const std::string machine{"it's a machine.toml"};
};

TEST_F(Reproduction, OfEveryModelResultIsItsCommand) {
  const std::vector<std::vector<std::string>> commands{
      {"modes", machine, "--set", "platform.mass=1234.5 kg"},
      {"modes", machine, "--system"},
      {"check", machine},
      {"bode", machine, "--pose", "z=-31 mm, ry=2 deg", "--points", "40"},
      {"sensitivity", machine, "--model", "guide"}};
  for (auto arguments : commands) {
    arguments.insert(arguments.end(), {"-o", arguments[0] + ".json"});
    EXPECT_THAT(paths(expect_repeatable(arguments)), testing::ElementsAre(machine));
  }
}

TEST_F(Reproduction, OfEveryMeasuredResultIsItsCommand) {
  using testing::ElementsAre;
  const auto rig = run({"rig", machine, "--duration", "24", "-o", "run 1.h5"});
  ASSERT_EQ(rig.exit_code, 0) << rig.err;
  EXPECT_THAT(paths(expect_repeatable({"record", "show", "run 1.h5", "-o", "shown.json"})),
              ElementsAre("run 1.h5"));
  EXPECT_THAT(paths(expect_repeatable({"frf", "run 1.h5", "-o", "frf.json"})),
              ElementsAre("run 1.h5"));
  EXPECT_THAT(paths(expect_repeatable({"identify", "run 1.h5", "--to", "60", "-o", "found.json"})),
              ElementsAre("run 1.h5"));
  EXPECT_THAT(paths(expect_repeatable({"compare", machine, "run 1.h5", "-o", "sides.json"})),
              ElementsAre(machine, "run 1.h5"));
  EXPECT_THAT(
      paths(expect_repeatable({"report", machine, "--command", "step z=2 mm, rise=0.1 s",
                               "--measured", "run 1.h5", "--format", "json", "-o", "page.json"})),
      ElementsAre(machine, "run 1.h5"));
  test::write_text(folder / "modes.csv",
                   "frequency [Hz],deviation [%],x,y,z,rx,ry,rz\n"
                   "4.71,1,1,0,0,0,0.2,0\n4.72,1,0,1,0,0.2,0,0\n8.8,1,0,0,1,0,0,0\n");
  EXPECT_THAT(
      paths(expect_repeatable({"diagnose", machine, "--measured", "modes.csv", "-o", "why.json"})),
      ElementsAre(machine, "modes.csv"));
}

/// A record holds its command with all options, -o included, and the checksum of its machine file.
TEST_F(Reproduction, OfARecordIsItsCommand) {
  const std::vector<std::vector<std::string>> commands{
      {"rig", machine, "--duration", "0.3", "--settling", "0.1", "--seed", "7", "-o", "run.h5"},
      {"simulate", machine, "--command", "step z=1 mm", "--until", "0.2", "-o", "run.csv"}};
  for (const auto& arguments : commands) {
    ASSERT_EQ(run(arguments).exit_code, 0);
    const std::string &output = arguments.back(), before = text(output);
    const auto shown = run({"record", "show", output}).out;
    EXPECT_THAT(shown, testing::AllOf(testing::HasSubstr("\ncommand: hydrapod " + arguments[0] +
                                                         " 'it'\\''s a machine.toml' --"),
                                      testing::HasSubstr(" -o " + output + "\n"),
                                      testing::HasSubstr("\nread it's a machine.toml: sha256 " +
                                                         sum_of(folder / machine) + "\n")));
    fs::remove(folder / output);
    const auto from = shown.find("hydrapod " + arguments[0]);
    const auto line = shown.substr(from, shown.find('\n', from) - from);
    const auto again =
        test::run_program("sh", {"-c", "cd '" + folder.path().string() + "' && " +
                                           test::hydrapod_program().string() + line.substr(8)});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(text(output), before);
  }
}

TEST_F(Reproduction, OfWhatIsPrintedIsItsCommand) {
  using testing::ElementsAre;
  EXPECT_THAT(paths(expect_printed_again({"simulate", machine, "--command", "step z=3.1 mm",
                                          "--until", "0.07", "--format", "json"})),
              ElementsAre(machine));
  test::write_text(folder / "modes.csv",
                   "frequency [Hz],deviation [%],x,y,z,rx,ry,rz\n"
                   "4.71,1,1,0,0,0,0.2,0\n4.72,1,0,1,0,0.2,0,0\n");
  EXPECT_THAT(paths(expect_printed_again({"calibrate", machine, "--targets", "modes.csv", "--free",
                                          "legs.guide_sleeve.stiffness", "--format", "json"})),
              ElementsAre(machine, "modes.csv"));
}

/// A table in a file names its command, which a shell makes the same file with.
TEST_F(Reproduction, OfATableInAFileIsItsCommand) {
  const std::vector<std::string> arguments{"modes", machine,    "--set", "platform.mass=1234.5 kg",
                                           "-o",    "modes.txt"};
  ASSERT_EQ(run(arguments).exit_code, 0);
  const std::string before = text("modes.txt");
  EXPECT_THAT(before, testing::HasSubstr("\nread it's a machine.toml: sha256 " +
                                         sum_of(folder / machine) + "\n\nwritten by hydrapod "));
  const std::string made = " by: hydrapod ";
  const auto from = before.find(made);
  ASSERT_NE(from, std::string::npos) << before;
  const auto begin = from + made.size();
  const auto line = before.substr(begin, before.find('\n', begin) - begin);
  fs::remove(folder / "modes.txt");
  const auto again =
      test::run_program("sh", {"-c", "cd '" + folder.path().string() + "' && " +
                                         test::hydrapod_program().string() + " " + line});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(text("modes.txt"), before);
}

TEST_F(Reproduction, HasTheDateAndTheCommit) {
  const std::vector<std::string> arguments{"check", machine, "--format", "json"};
  const auto made = [&](const char* epoch) {
    const auto run = run_hydrapod(
        arguments, {.folder = folder.path(), .variables = {{"SOURCE_DATE_EPOCH", epoch}}});
    return json::parse(run.out).at("reproduction");
  };
  EXPECT_EQ(made("1234567890").at("date"), "2009-02-13T23:31:30Z");
  const auto stamp = [](std::time_t time) {
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
    return std::string(text);
  };
  const auto before = stamp(std::time(nullptr));
  const auto now = made("");  // not a number: as if it were not there
  EXPECT_GE(now.at("date"), before);
  EXPECT_LE(now.at("date"), stamp(std::time(nullptr)));
  EXPECT_EQ(now.at("program"), "hydrapod");
  EXPECT_THAT(run({"--version"}).out, testing::HasSubstr(now.at("version").get<std::string>()));
  if (!now.at("commit").is_null())
    EXPECT_THAT(now.at("commit").get<std::string>(),
                testing::MatchesRegex("[0-9a-f]{40}(-changed)?"));
}

TEST_F(Reproduction, OfStandardInputHasNoChecksum) {
  const auto run = run_hydrapod({"check", "-", "--format", "json"},
                                {.input = text(machine), .folder = folder.path()});
  EXPECT_EQ(json::parse(run.out).at("reproduction").at("inputs"), json::array()) << run.err;
}

// FIPS 180-4 has the sum of "abc".
TEST_F(Reproduction, ChecksumsAreThoseOfTheStandard) {
  test::write_text(folder / "abc", "abc");
  EXPECT_EQ(cli::sha256_of_file((folder / "abc").string()),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  std::string long_text(3000017, 'q');  // several blocks
  test::write_text(folder / "long", long_text);
  EXPECT_EQ(cli::sha256_of_file((folder / "long").string()), sum_of(folder / "long"));
  EXPECT_THROW(cli::sha256_of_file((folder / "none").string()), base::InputError);
}

TEST_F(Reproduction, AFileThatChangedMeanwhileHasNoChecksum) {
  for (const char* name : {"kept", "changed", "removed"}) {
    test::write_text(folder / name, "7.31");
    cli::note_input("FILE", (folder / name).string());
  }
  test::write_text(folder / "changed", "8.407");
  fs::remove(folder / "removed");
  const auto made = cli::reproduction();
  const auto& inputs = made.at("inputs");
  ASSERT_EQ(inputs.size(), 3U);
  EXPECT_EQ(inputs[0].at("sha256"), sum_of(folder / "kept"));
  EXPECT_TRUE(inputs[1].at("sha256").is_null());
  EXPECT_TRUE(inputs[2].at("sha256").is_null());
  EXPECT_EQ(inputs[2].at("bytes"), 4);
}

}  // namespace
}  // namespace hydrapod
