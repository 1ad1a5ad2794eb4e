/// `hydrapod init`: a starter file that never costs anybody a file of theirs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "hydrapod/model/machine_file.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {
using test::run_hydrapod;

TEST(Init, WritesTheStarterFile) {
  const test::TemporaryFolder folder;
  const auto result = run_hydrapod({"init"}, {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "wrote machine.toml; next: hydrapod check machine.toml\n");
  EXPECT_EQ(test::read_text(folder / "machine.toml"), model::starter_machine_file());
}

TEST(Init, PrintsWithADash) {
  const auto result = run_hydrapod({"init", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, model::starter_machine_file());
}

TEST(Init, LeavesAnExistingFileUnlessForced) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "mine.toml").string();
  test::write_text(file, "mine");
  const auto refused = run_hydrapod({"init", file});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, testing::StartsWith(file + ": error: the file exists"));
  EXPECT_EQ(test::read_text(file), "mine");

  EXPECT_EQ(run_hydrapod({"init", file, "--force"}).exit_code, 0);
  EXPECT_EQ(test::read_text(file), model::starter_machine_file());
}

TEST(Init, NamesAMissingFolder) {
  const test::TemporaryFolder folder;
  const auto result = run_hydrapod({"init", "no/where/m.toml"}, {.folder = folder.path()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "no/where/m.toml: error: cannot write the file: there is no folder 'no/where'\n");
}

}  // namespace
}  // namespace hydrapod
