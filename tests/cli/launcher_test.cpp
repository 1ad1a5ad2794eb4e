/// The launcher ./hydrapod where it cannot build.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

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

/// A checkout that was moved while its first build was not finished is built anew, at once.
TEST(Launcher, AnUnfinishedBuildOfAnotherPlaceIsMadeAnew) {
  const TemporaryFolder folder;
  fs::copy_file(source_file("hydrapod"), folder / "hydrapod");
  fs::copy(source_file("scripts"), folder / "scripts", fs::copy_options::recursive);
  fs::create_directories(folder / "build/release");
  write_text(folder / "build/release/CMakeCache.txt",
             "CMAKE_HOME_DIRECTORY:INTERNAL=/where/it/was\n");
  write_text(folder / "build/release/old", "");
  fs::create_directories(folder / "bin");
  write_text(folder / "bin/cmake",
             "#!/bin/sh\n"
             "mkdir -p build/release/apps/hydrapod\n"
             "printf '#!/bin/sh\\necho \"built: $*\"\\n' >build/release/apps/hydrapod/hydrapod\n"
             "chmod +x build/release/apps/hydrapod/hydrapod\n");
  fs::permissions(folder / "bin/cmake", fs::perms::owner_all);
  const auto run =
      run_program(folder / "hydrapod", {"--version"},
                  {.variables = {{"HYDRAPOD_NO_INSTALL", "1"},
                                 {"PATH", (folder / "bin").string() + ":" + std::getenv("PATH")}}});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "built: --version\n");
  EXPECT_FALSE(fs::exists(folder / "build/release/old"));
  EXPECT_TRUE(fs::exists(folder / "build/release/.up-to-date"));
}

}  // namespace
}  // namespace hydrapod::test
