/// What every command of the program has in common: help, version, exit codes, where messages go.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/base/version.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {
using test::run_hydrapod;
using test::run_program;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(Program, ToldNothingShowsItsHelp) {
  const auto result = run_hydrapod({});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("init"));
  EXPECT_EQ(result.out, run_hydrapod({"--help"}).out);
  EXPECT_EQ(result.err, "");
}

TEST(Program, SaysItsVersion) {
  const auto result = run_hydrapod({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, std::string("hydrapod ") + base::version + "\n");
}

TEST(Program, NamesTheCommandNearestToAnUnknownOne) {
  const auto result = run_hydrapod({"inti"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err,
            "error: unknown command 'inti'; did you mean 'init'? "
            "('hydrapod --help' lists the options)\n");
}

TEST(Program, DoesNotGuessWhenNothingIsNear) {
  const auto result = run_hydrapod({"xylophone"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "error: unknown command 'xylophone' ('hydrapod --help' lists the options)\n");
}

TEST(Program, NamesTheOptionNearestToAnUnknownOne) {
  const auto result = run_hydrapod({"init", "--forse"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "error: unknown option '--forse'; did you mean '--force'? "
            "('hydrapod init --help' lists the options)\n");
}

TEST(Program, NamesAnArgumentTooMany) {
  const test::TemporaryFolder folder;
  const auto result = run_hydrapod({"init", "a.toml", "b.toml"}, {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, StartsWith("error: one argument too many: 'b.toml'"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.toml"));
}

TEST(Program, FailsWhenItsOutputCannotBeWritten) {
  const std::string call = test::hydrapod_program().string() + " --help > /dev/full";
  const auto result = run_program("sh", {"-c", call});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "error: writing to the standard output failed: No space left on device\n");
}

TEST(Program, EndsQuietlyWhenItsReaderHasHadEnough) {
  const std::string call = test::hydrapod_program().string() + " init - | head -n 1";
  const auto result = run_program("sh", {"-c", call});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
}

TEST(Program, UsesNoColourOutsideATerminal) {
  EXPECT_THAT(run_hydrapod({"inti"}).err, Not(HasSubstr("\033")));
}

/// What `call` shows on a pseudo terminal, made by script(1).
std::string on_a_terminal(const std::string& call) {
  return run_program("script", {"-qec", call, "/dev/null"}, {.variables = {{"TERM", "xterm"}}}).out;
}

TEST(Program, ColoursErrorsOnATerminalUnlessToldNotTo) {
  if (on_a_terminal("echo here").empty()) GTEST_SKIP() << "no pseudo terminals here";
  const std::string call = test::hydrapod_program().string() + " inti";
  EXPECT_THAT(on_a_terminal("env -u NO_COLOR " + call), HasSubstr("\033[1;31merror:\033[0m"));
  EXPECT_THAT(on_a_terminal("env NO_COLOR=1 " + call), Not(HasSubstr("\033")));
}

TEST(Program, RefusesWhatIsNoNumber) {
  const std::string machine = test::source_file("models/zhang-jiang-2021.toml").string();
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--model-error", "nan"}, {"--shape-error", "inf"}}) {
    const auto result = run_hydrapod({"diagnose", machine, option[0], option[1]});
    EXPECT_EQ(result.exit_code, 2) << option[0];
    EXPECT_THAT(result.err, testing::HasSubstr("expected a finite number, not " + option[1]));
  }
  EXPECT_THAT(run_hydrapod({"identify", machine, "--highest-damping", "nan"}).err,
              testing::HasSubstr("finite"));
  const auto seed = run_hydrapod({"rig", machine, "--seed", "-1", "-o", "never.h5"});
  EXPECT_EQ(seed.exit_code, 2);
  EXPECT_THAT(seed.err, testing::HasSubstr("expected 0 or more, not -1"));
  const auto slow = run_hydrapod({"rig", machine, "--rate", "1e-05 Hz", "-o", "never.h5"});
  EXPECT_EQ(slow.exit_code, 2);
  EXPECT_THAT(slow.err, testing::HasSubstr("the record of 60 s would have no sample"));
}

/// C reads 010 as 8, and numbers that are too large as the largest.
TEST(Program, ReadsWholeNumbersAsTheyAreWritten) {
  const std::string machine = test::source_file("models/zhang-jiang-2021.toml").string();
  const test::TemporaryFolder folder;
  const auto record = [&](const std::string& seed, const std::string& name) {
    const auto run = run_hydrapod(
        {"rig", machine, "--duration", "0.2", "--settling", "0", "--seed", seed, "-o", name},
        {.folder = folder.path()});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto table =
        test::read_text(folder / name);  // without its notes, which state the command
    return table.substr(table.rfind("\n#") + 1);
  };
  const auto padded = record("010", "a.csv");
  EXPECT_EQ(padded, record("10", "b.csv"));
  EXPECT_NE(padded, record("8", "c.csv"));
  EXPECT_EQ(record("000", "d.csv"), record("0", "e.csv"));
  const auto huge = run_hydrapod({"simulate", machine, "--seed", "99999999999999999999"});
  EXPECT_EQ(huge.exit_code, 2);
  EXPECT_THAT(huge.err, HasSubstr("expected at most 18446744073709551615"));
}

/// What is wrong in one option ends with a message, also beside options that were right.
TEST(Program, WrongAmountsEndWithAMessage) {
  const std::string machine = test::source_file("models/zhang-jiang-2021.toml").string();
  const test::TemporaryFolder folder;
  test::write_text(folder / "modes.csv", "frequency [Hz],direction\n4.1,x\n4.1,y\n6.5,rz\n");
  const auto complaint = [&](const std::vector<std::string>& words) {
    const auto run = run_hydrapod(words, {.folder = folder.path()});
    EXPECT_TRUE(run.exit_code == 1 || run.exit_code == 2) << run.exit_code << " " << words[0];
    return run.err;
  };
  const std::vector<std::string> diagnose{"diagnose", machine, "--measured", "modes.csv"};
  const auto with = [&](const std::string& option, const std::string& value) {
    auto words = diagnose;
    words.insert(words.end(), {option, value});
    return complaint(words);
  };
  EXPECT_THAT(with("--want", "nan Hz"), HasSubstr("--want nan Hz: error:"));
  EXPECT_THAT(with("--want", "0 %"), HasSubstr("--want 0 %: error: expected a drop above 0 %"));
  EXPECT_THAT(with("--poses", "z=1e9 mm"), HasSubstr("error:"));
  EXPECT_THAT(with("--against", "nothing"), HasSubstr("error:"));
  ASSERT_EQ(
      run_hydrapod({"rig", machine, "--duration", "2", "-o", "run.h5"}, {.folder = folder.path()})
          .exit_code,
      0);
  for (const char* settling : {"1e308", "1e15", "3"})
    EXPECT_THAT(complaint({"frf", "run.h5", "--settling", settling}),
                HasSubstr("are left out as settling, and the record has 2 s"));
  for (const char* time : {"1e308", "1e-308"})
    EXPECT_THAT(
        complaint({"export", machine, "--to", "json", "--sample-time", time, "-o", "m.json"}),
        HasSubstr("the state space has no discrete form at a sample time of"));
}

/// Names may come from anybody with a file. None of them reaches a terminal as a command.
TEST(Program, NamesDoNotCommandTheTerminal) {
  const test::TemporaryFolder folder;
  auto text = test::read_text(test::source_file("models/zhang-jiang-2021.toml"));
  const auto at = text.find("\nname = ");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, text.find('\n', at + 1) - at,
               "\nname = \"A\\u001b]0;title\\u0007B\\u009b31mC\"");
  const std::string name = "a\033[31m\007.toml";
  test::write_text(folder / name, text);
  const std::vector<std::vector<std::string>> commands{
      {"check", name},
      {"modes", name},
      {"modes", "b" + name},
      {"modes", name, "-o", "t\033c.txt"},
      {"simulate", name, "--until", "0.01"},
      {"export", name, "--to", "json", "-o", "m.json"},
      {"compare", name, name},
      {"modes", name, "--pose", name}};
  for (const auto& words : commands) {
    const auto run = run_hydrapod(words, {.folder = folder.path()});
    for (const char* control : {"\033", "\007", "\u009b"})
      EXPECT_THAT(run.out + run.err, Not(HasSubstr(control))) << words[0];
    EXPECT_THAT(run.out + run.err, HasSubstr("?")) << words[0];
  }
  EXPECT_THAT(test::read_text(folder / "t\033c.txt"), Not(HasSubstr("\033")));
}

}  // namespace
}  // namespace hydrapod
