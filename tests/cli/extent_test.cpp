/// --brief and --all: how much of a result a command prints.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using test::run_hydrapod;
using testing::HasSubstr;

const std::string heavy = test::source_file("models/heavy-platform.toml").string();

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of('\n');
  return text.substr(text.rfind('\n', end) + 1);
}

class Extent : public testing::TestWithParam<std::vector<std::string>> {
 protected:
  static std::string out(const char* more = nullptr) {
    auto arguments = GetParam();
    if (more != nullptr) arguments.emplace_back(more);
    return run_hydrapod(arguments).out;
  }
};

/// A screen has 24 lines.
TEST_P(Extent, BriefFitsAScreenAndEndsWithTheVerdict) {
  const auto brief = out("--brief"), whole = out();
  EXPECT_LE(std::ranges::count(brief, '\n'), 24) << brief;
  EXPECT_GT(std::ranges::count(whole, '\n'), 24);
  EXPECT_EQ(brief.substr(0, brief.find('\n')), whole.substr(0, whole.find('\n')));
}

TEST_P(Extent, AllIsWhatAFileGets) { EXPECT_EQ(out("--all"), out()); }

TEST_P(Extent, IsOneOfTheTwo) {
  auto arguments = GetParam();
  arguments.insert(arguments.end(), {"--brief", "--all"});
  const auto both = run_hydrapod(arguments);
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err,
              AnyOf(HasSubstr("--all excludes --brief"), HasSubstr("--brief excludes --all")));
}

TEST_P(Extent, StandsInHelpManPageAndCompletion) {
  const auto& command = GetParam().front();
  const auto help = run_hydrapod({command, "--help"}).out;
  EXPECT_THAT(help, HasSubstr("--brief"));
  EXPECT_THAT(help, HasSubstr("All rows of tables"));
  const auto script = run_hydrapod({"help", "--completion"}).out;
  const auto at = script.find("'hydrapod " + command + "') words='");
  ASSERT_NE(at, script.npos);
  const auto words = script.substr(at, script.find('\n', at) - at);
  EXPECT_THAT(words, HasSubstr("--brief --all"));
}

INSTANTIATE_TEST_SUITE_P(Commands, Extent,
                         testing::Values(std::vector<std::string>{"modes", heavy},
                                         std::vector<std::string>{"check", heavy},
                                         std::vector<std::string>{"sensitivity", heavy},
                                         std::vector<std::string>{"diagnose", heavy}));

TEST(Brief, EndsWithTheVerdict) {
  for (const char* command : {"check", "modes"})
    EXPECT_EQ(last_line(run_hydrapod({command, heavy, "--brief"}).out),
              last_line(run_hydrapod({command, heavy}).out));
}

// Forty poses were a hundred and twenty lines.
TEST(Brief, OneCauseIsOneLineHoweverManyPosesThereAre) {
  std::string machine = test::read_text(heavy);
  for (int k = 0; k < 40; ++k)
    machine += fmt::format("[poses.p{}]\nposition = [0, 0, {}]\n", k, 1.3 + 0.005 * k);
  const auto result =
      run_hydrapod({"check", "-", "--brief", "--set", "platform.mass=80 t"}, {.input = machine});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_LE(std::ranges::count(result.out, '\n'), 24) << result.out;
  std::size_t lines = 0;
  for (auto at = result.out.find("the oil can give"); at != std::string::npos;
       at = result.out.find("the oil can give", at + 1))
    ++lines;
  EXPECT_EQ(lines, 1U) << result.out;
  EXPECT_THAT(result.out, HasSubstr("; also at 43 others: "));
  EXPECT_THAT(last_line(result.out), testing::AllOf(HasSubstr(" of 44 poses: neutral, "),
                                                    HasSubstr("cannot hold the load at all 44")));
  // the worst pose is named: 840 N/mm carry least with the rods far out
  EXPECT_THAT(
      run_hydrapod({"check", heavy, "--brief"}).out,
      HasSubstr("buckle with 2690 kg more on the platform (in all 1.19 times its mass) (pose "
                "neutral; also surge)\n"));
}

TEST(Brief, LeavesFilesOfOtherFormatsWhole) {
  EXPECT_EQ(run_hydrapod({"modes", heavy, "--format", "csv", "--brief"}).out,
            run_hydrapod({"modes", heavy, "--format", "csv"}).out);
}

}  // namespace
}  // namespace hydrapod
