/// Files that are not machine files, or mean harm: a message, never a crash or a hang.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <clocale>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <locale>
#include <string>

#include "hydrapod/base/units.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"
#include "support/places.hpp"
#include "support/run_program.hpp"

namespace hydrapod::model {
namespace {

constexpr std::size_t largest_file = std::size_t{1} << 20;

std::string repeated(const std::string& part, std::size_t size) {
  std::string text;
  text.reserve(size + part.size());
  while (text.size() < size) text += part;
  return text;
}

/// A folder of its own for each test.
class FilesOnDisk : public testing::Test {
 protected:
  [[nodiscard]] std::string written(const std::string& text) const {
    const auto path = folder_ / "m.toml";
    test::write_text(path, text);
    return path.string();
  }
  static std::string complaint(const std::string& path) {
    try {
      read_machine_file(path);
    } catch (const base::InputError& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryFolder folder_{};
};

TEST_F(FilesOnDisk, AreRead) {
  const auto file = read_machine_file(written(sound_machine_file), {"platform.mass=2"});
  EXPECT_EQ(file.machine.platform.mass, 2.0);
  EXPECT_EQ(file.text, sound_machine_file);
}

TEST_F(FilesOnDisk, ThatAreNotThereAreNamed) {
  const std::string path = (folder_ / "none.toml").string();
  EXPECT_EQ(complaint(path), path + ": error: cannot be opened: No such file or directory");
}

TEST_F(FilesOnDisk, FoldersAreRefused) {
  EXPECT_EQ(complaint(folder_.path().string()),
            folder_.path().string() + ": error: is a directory, expected a machine file");
}

TEST_F(FilesOnDisk, WithoutPermissionAreNamed) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const std::string path = written(sound_machine_file);
  std::filesystem::permissions(path, std::filesystem::perms::none);
  EXPECT_EQ(complaint(path), path + ": error: cannot be opened: Permission denied");
}

TEST_F(FilesOnDisk, WithoutEndAreCutOff) {
  EXPECT_EQ(complaint("/dev/zero"),
            "/dev/zero: error: is larger than 1 MiB, expected a machine file of some kilobytes");
}

TEST(HostileFiles, EmptyOnesSayHowToBegin) {
  for (const char* text : {"", " \n\t\r\n"}) {
    EXPECT_EQ(complaint_about(text),
              "m.toml: error: is empty; `hydrapod init` writes a machine file to start from");
  }
}

TEST(HostileFiles, OnlyACommentMissesEverything) {
  EXPECT_EQ(complaint_about("# nothing\n"),
            "m.toml:1:1: error: name: required value (a string) is missing\n"
            "m.toml:1:1: error: platform: required table [platform] is missing\n"
            "m.toml:1:1: error: legs: required table [legs] is missing\n"
            "m.toml:1:1: error: base: required table [base] is missing\n"
            "m.toml:1:1: error: poses: required table [poses] is missing");
}

TEST(HostileFiles, TooLargeOnesAreRefused) {
  EXPECT_EQ(complaint_about(sound_machine_file + repeated("# comment\n", largest_file)),
            "m.toml: error: is larger than 1 MiB, expected a machine file of some kilobytes");
  EXPECT_EQ(complaint_about(sound_machine_file + repeated("# comment\n", largest_file / 2)), "");
}

TEST(HostileFiles, OtherEncodingsAreRefused) {
  EXPECT_EQ(complaint_about("name = \"µ\"\nsource = \"K\xf6ln\"\n"),
            "m.toml:2:12: error: not UTF-8 text");
  EXPECT_EQ(complaint_about("# µµ\xff"), "m.toml:1:5: error: not UTF-8 text");
  for (const std::string& text :
       {std::string("\xff\xfen\0a\0m\0", 8), std::string("\xfe\xff\0n\0a\0m", 8),
        std::string("n\0a\0m\0e\0", 8), std::string("\0n\0a\0m\0e", 8)})
    EXPECT_EQ(complaint_about(text), "m.toml:1:1: error: UTF-16 text; save the file as UTF-8");
}

TEST(HostileFiles, ControlCharactersAreRefused) {
  EXPECT_EQ(complaint_about(std::string("name = \0 1", 10)),
            "m.toml:1:8: error: not valid TOML in value: unexpected control character");
  EXPECT_NE(complaint_about(std::string("\0\0\0\0", 4)), "");
}

TEST(HostileFiles, AByteOrderMarkAndWindowsLineEndsAreFine) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : sound_machine_file) text += c == '\n' ? std::string("\r\n") : std::string{c};
  EXPECT_EQ(complaint_about(text), "");
}

/// toml++ would tear a hundred thousand nested tables down recursively and overflow the stack.
TEST(HostileFiles, DeepNestingIsRefused) {
  const std::string dots = "a" + repeated(".a", 200'000);
  EXPECT_EQ(complaint_about(dots + " = 1"),
            "m.toml:1:66: error: a dotted key of more than 32 parts");
  EXPECT_EQ(complaint_about("[" + dots + "]"),
            "m.toml:1:67: error: a dotted key of more than 32 parts");
  EXPECT_EQ(complaint_about("x = [\n{" + dots + " = 1}]"),
            "m.toml:2:67: error: a dotted key of more than 32 parts");
  EXPECT_EQ(complaint_about("x = " + repeated("[", 200'000)),
            "m.toml:1:37: error: brackets nested more than 32 deep");
  EXPECT_EQ(complaint_about("x = " + repeated("{a=", 200'000)),
            "m.toml:1:101: error: brackets nested more than 32 deep");
  EXPECT_NE(complaint_about(sound_machine_file, {"platform." + dots + "=1"}), "");
  EXPECT_NE(complaint_about(sound_machine_file, {"platform.mass=" + repeated("[", 4000)}), "");
}

TEST(HostileFiles, DeepNestingDoesNotHideBehindStrings) {
  const std::string dots = "a" + repeated(".a", 200'000) + " = 1";
  for (const char* before : {"x = \"\"\"a\"\"\"\"\n", "x = \"\"\"a\"\"\"\"\"\n", "x = '''a''''\n",
                             "x = \"\\\"\"\n", "x = '\\'\n", "x = '#'\n", "# \"\"\"\n",
                             "x = {y = \"\"\"a\"\"\"\", z = '[['}\n", "'x\"' = 1\n"}) {
    EXPECT_NE(complaint_about(before + dots).find("a dotted key of more than 32 parts"),
              std::string::npos)
        << before;
  }
}

TEST(HostileFiles, DotsAndBracketsInStringsAndCommentsAreFine) {
  EXPECT_EQ(complaint_about(edited({{"name = \"Sound\"", "name = \"\"\"" + repeated(".[{", 9000) +
                                                             "\"\"\" # " + repeated(".[", 900)}})),
            "");
}

/// The slowest texts known, as large as allowed; seconds would mean something quadratic.
TEST(HostileFiles, LargeOnesTakeNoTime) {
  const std::size_t size = largest_file - 100;
  std::string tables;
  for (int i = 0; tables.size() < size; ++i) tables += fmt::format("[a.a{}.b]\n", i);
  std::string legs = "[legs]\n";
  for (int i = 0; legs.size() < size / 2; ++i) legs += fmt::format("k{}=1\n", i);
  legs += "[leg.1]\n";
  for (int i = 0; legs.size() < size; ++i) legs += fmt::format("k{}=1\n", i);
  std::string poses = "[poses]\n";
  for (int i = 0; poses.size() < size; ++i) poses += fmt::format("p{}.position=1\n", i);
  const std::array texts{tables,
                         legs,
                         poses,
                         "x = [" + repeated("1,", size) + "]",
                         "x = [" + repeated("{a=1},", size) + "]",
                         repeated("[[x]]\n", size),
                         "x = '" + repeated("y", size) + "'",
                         "legs.rod.length = '" + repeated("9", size) + "'"};
  for (const auto& text : texts) {
    const std::clock_t begin = std::clock();  // of the processor: others may keep it busy
    EXPECT_NE(complaint_about(text), "");
    const double taken = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    constexpr double most = test::sanitized ? 100.0 : 20.0;  // seen: 2 s, under sanitizers 25 s
    EXPECT_LT(taken, most) << text.substr(0, 40);
  }
}

/// Sets the program's locale to one with a decimal comma, as a host program may have done. Compiles
/// one where none is installed; that needs the sources of the Debian package `locales`.
class CommaLocale : public FilesOnDisk {
 protected:
  CommaLocale() { found_ = installed() || compiled(); }
  ~CommaLocale() override {
    std::setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;
  bool found_{};

 private:
  static bool installed() {
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "ru_RU.UTF-8"}) {
      if (std::setlocale(LC_ALL, name) != nullptr) return true;
    }
    return false;
  }
  [[nodiscard]] bool compiled() const {
    const std::string command =
        "localedef -i de_DE -f UTF-8 " + (folder_ / "de_DE.UTF-8").string() + " >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0) return false;
    setenv("LOCPATH", folder_.path().c_str(), 1);
    return std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  }
};

struct CommaPunctuation : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
  [[nodiscard]] char do_thousands_sep() const override { return '.'; }
  [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

void expect_point_in_numbers() {
  const auto file = parse_machine(
      edited({{"length = 1.05", "length = \"1050.5 mm\""}, {"mass = 1500", "mass = 1500.25"}}),
      "m.toml", {"legs.rod.mass=1.5 psi in^2 s^2/in"});
  EXPECT_DOUBLE_EQ(file.machine.legs[0].rod.length, 1.0505);
  EXPECT_EQ(file.machine.platform.mass, 1500.25);
  EXPECT_EQ(complaint_about(edited({{"mass = 1500", "mass = -1500.25"}})),
            "m.toml:9:8: error: platform.mass: is -1500.25 kg, expected more than 0");
}

TEST_F(CommaLocale, OfTheCLibraryMakesNoDifference) {
  if (!found_) GTEST_SKIP() << "no locale with a decimal comma is to be had";
  ASSERT_STREQ(std::localeconv()->decimal_point, ",");
  expect_point_in_numbers();
}

TEST(CommaStreams, MakeNoDifference) {
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));
  expect_point_in_numbers();
  std::locale::global(before);
}

}  // namespace
}  // namespace hydrapod::model
