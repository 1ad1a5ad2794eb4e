/// docs/howto/tutorial.md: every command runs, and prints every line that the page shows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {

/// A fenced block of the page.
struct Block {
  bool commands{};  ///< ```sh; else lines that the commands before it print
  std::vector<std::string> lines{};
};

std::vector<Block> blocks_of(const std::string& page) {
  std::vector<Block> blocks;
  std::istringstream lines(page);
  std::string line;
  bool inside = false;
  while (std::getline(lines, line)) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) blocks.push_back({.commands = line == "```sh"});
    } else if (inside) {
      blocks.back().lines.push_back(line);
    }
  }
  return blocks;
}

/// Numbers of a line, and what stands between them without blanks.
struct Parts {
  std::vector<double> numbers{};
  std::string text{};
};

Parts parts_of(const std::string& line) {
  static const std::regex number(R"([0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)?)");
  Parts parts;
  std::string rest = std::regex_replace(line, number, "#");
  for (std::sregex_iterator found(line.begin(), line.end(), number), end; found != end; ++found)
    parts.numbers.push_back(std::stod(found->str()));
  for (const char c : rest)
    if (c != ' ') parts.text += c;
  return parts;
}

/// Numbers within 2 %, and a unit of their last place of two digits: those of another processor may
/// be rounded to the other side.
bool says(const std::string& line, const Parts& wanted) {
  constexpr double share = 0.02, digit = 0.1;
  const auto found = parts_of(line);
  if (found.text != wanted.text || found.numbers.size() != wanted.numbers.size()) return false;
  for (std::size_t k = 0; k < found.numbers.size(); ++k) {
    const double size = std::abs(wanted.numbers[k]);
    const double allowed =
        size < 10.0 ? std::max(share, digit * (size < 1.0)) * size : share * size;
    if (std::abs(found.numbers[k] - wanted.numbers[k]) > allowed) return false;
  }
  return true;
}

bool printed(const std::string& output, const std::string& line) {
  const auto wanted = parts_of(line);
  std::istringstream lines(output);
  std::string found;
  while (std::getline(lines, found))
    if (says(found, wanted)) return true;
  return false;
}

TEST(Tutorial, DoesWhatItSays) {
  const test::TemporaryFolder folder;
  const auto path = test::hydrapod_program().parent_path().string() + ":" + std::getenv("PATH");
  const auto blocks = blocks_of(test::read_text(test::source_file("docs/howto/tutorial.md")));
  ASSERT_GT(blocks.size(), 10U);
  std::string output;
  for (const auto& block : blocks) {
    if (!block.commands) {
      for (const auto& line : block.lines)
        EXPECT_TRUE(printed(output, line)) << line << "\nis not among\n" << output;
      continue;
    }
    output.clear();
    for (const auto& command : block.lines) {
      const auto result = test::run_program(
          "bash", {"-c", command},
          {.folder = folder.path(), .variables = {{"PATH", path}}, .timeout = 250.0});
      ASSERT_EQ(result.exit_code, 0) << command << "\n" << result.err;
      output += result.out;
    }
  }
}

TEST(Tutorial, LinesWithOtherNumbersOrWordsAreToldApart) {
  const std::string line = "  x  15.155 Hz,  0.13 % of 1.2e+06";
  EXPECT_TRUE(printed("nothing\n x 15.16 Hz, 0.13 % of 1.21e+06\n", line));
  EXPECT_FALSE(printed("x 15.6 Hz, 0.13 % of 1.2e+06\n", line));
  EXPECT_FALSE(printed("y 15.155 Hz, 0.13 % of 1.2e+06\n", line));
  EXPECT_FALSE(printed("x 15.155 Hz, 0.13 % of 1.2e+05\n", line));
}

}  // namespace
}  // namespace hydrapod
