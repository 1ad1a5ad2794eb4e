/// The launcher ./hydrapod where it cannot build.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

namespace fs = std::filesystem;

/// A checkout with sources and without a program, whose folder build/ cannot be written.
TEST(Launcher, InACheckoutThatCannotBeWrittenSaysSo) {
  const TemporaryFolder folder;
  fs::copy_file(source_file("hydrapod"), folder / "hydrapod");
  fs::copy(source_file("scripts"), folder / "scripts", fs::copy_options::recursive);
  fs::create_directories(folder / "src");
  // neither root nor anybody else can write into a folder as into a file
  fs::create_directories(folder / "build/.lock-release");
  const auto run = run_program(folder / "hydrapod", {"--version"},
                               {.variables = {{"HYDRAPOD_NO_INSTALL", "1"}}});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, testing::HasSubstr("cannot be written: build it as a user who may"));
  EXPECT_THAT(run.err, testing::Not(testing::HasSubstr("line ")));  // as the shell's own messages
}

}  // namespace
}  // namespace hydrapod::test
