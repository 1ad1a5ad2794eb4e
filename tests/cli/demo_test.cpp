/// `hydrapod demo`, and the program that a fresh clone builds for it alone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

namespace fs = std::filesystem;

std::string demo_program() { return hydrapod_program().string() + "-demo"; }

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(Demo, OfAFreshCloneIsThatOfTheProgram) {
  const TemporaryFolder whole, alone;
  const auto expected = run_hydrapod({"demo"}, {.folder = whole.path()});
  const auto run = run_program(demo_program(), {}, {.folder = alone.path()});
  ASSERT_EQ(expected.exit_code, 0) << expected.err;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, expected.out);
  EXPECT_THAT(run.out, testing::HasSubstr("1. The published machine"));
  const auto names = names_in(whole / "hydrapod-demo");
  EXPECT_EQ(names.size(), 15u);  // of three machines: file, report, Bode diagram in three forms
  EXPECT_EQ(names_in(alone / "hydrapod-demo"), names);
  for (const auto& name : names)
    EXPECT_EQ(read_text(alone / "hydrapod-demo" / name), read_text(whole / "hydrapod-demo" / name))
        << name;
}

TEST(Demo, SaysWhereItCannotMakeItsFolder) {
  const TemporaryFolder folder;
  write_text(folder / "taken", "mine");
  for (const bool alone : {true, false}) {
    const std::string taken = (folder / "taken").string();
    const auto run = alone ? run_program(demo_program(), {taken}) : run_hydrapod({"demo", taken});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, testing::HasSubstr(taken + ": error: cannot make a folder here"));
    EXPECT_EQ(read_text(folder / "taken"), "mine");
  }
}

/// A checkout whose cmake is a script that makes `program` and notes what it was asked for.
struct Checkout {
  TemporaryFolder folder{};

  Checkout() {
    fs::copy_file(source_file("hydrapod"), folder / "hydrapod");
    fs::copy(source_file("scripts"), folder / "scripts", fs::copy_options::recursive);
    fs::create_directories(folder / "bin");
    write_text(folder / "bin/cmake",
               "#!/bin/sh\n"
               "echo \"$*\" >>asked\n"
               "case \"$*\" in\n"
               "*'--build --preset demo'*) name=hydrapod-demo ;;\n"
               "*--build*) name=hydrapod ;;\n"
               "*) exit ;;\n"
               "esac\n"
               "mkdir -p build/release/apps/hydrapod\n"
               "printf '#!/bin/sh\\necho \"'$name': $*\"\\n' >build/release/apps/hydrapod/$name\n"
               "chmod +x build/release/apps/hydrapod/$name\n");
    fs::permissions(folder / "bin/cmake", fs::perms::owner_all);
  }

  /// What the launcher prints for `arguments`.
  [[nodiscard]] std::string run(const std::vector<std::string>& arguments) const {
    const auto run = run_program(
        folder / "hydrapod", arguments,
        {.variables = {{"HYDRAPOD_NO_INSTALL", "1"},
                       {"PATH", (folder / "bin").string() + ":" + std::getenv("PATH")}}});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.out;
  }
};

TEST(Demo, IsBuiltAloneAsLongAsThereIsNoProgram) {
  const Checkout checkout;
  EXPECT_EQ(checkout.run({"demo", "results"}), "hydrapod-demo: results\n");
  EXPECT_FALSE(fs::exists(checkout.folder / "build/release/.up-to-date"));
  EXPECT_THAT(read_text(checkout.folder / "asked"),
              testing::Not(testing::HasSubstr("--build --preset release")));
  EXPECT_EQ(checkout.run({"modes", "m.toml"}), "hydrapod: modes m.toml\n");
  EXPECT_THAT(read_text(checkout.folder / "asked"), testing::HasSubstr("--build --preset release"));
  EXPECT_EQ(checkout.run({"demo"}), "hydrapod: demo\n");
}

TEST(Demo, IsTheWholeProgramWhereOptionsAreGiven) {
  const Checkout checkout;
  EXPECT_EQ(checkout.run({"demo", "--help"}), "hydrapod: demo --help\n");
}

}  // namespace
}  // namespace hydrapod::test
