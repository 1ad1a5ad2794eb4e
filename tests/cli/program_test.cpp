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

}  // namespace
}  // namespace hydrapod
