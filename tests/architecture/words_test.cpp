/// One vocabulary: pages, help texts, messages and reports use the terms of the field.

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;

struct Term {
  const char* pattern;
  const char* instead;
};

constexpr Term terms[] = {
    {"\\bguilty\\b|\\bblames?d?\\b|\\binnocent", "cause, identified cause"},
    {"\\bsuspects?\\b", "candidate cause"},
    {"\\bexplanations?\\b", "hypothesis"},
    {"\\b(give|gives|gave|giving) way\\b", "compliant, compliance"},
    {"\\bas stated\\b", "nominal"},
    {"\\brigid calculation\\b", "rigid-leg model"},
    {"\\b(feel|feels|felt)\\b", "moves, measures; local seal mode"},
    {"\\bknees?\\b", "seals, rod tilt, seal mode"},
    {"\\bdampings\\b", "damping ratios"},
    {"what (moves|gives)\\b", "motion, compliance"},
};

/// `text` without what Markdown marks as code: blocks between lines of ``` and spans between `.
std::string without_code(const std::string& text) {
  std::string found;
  std::istringstream lines(text);
  bool block = false, span = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      block = !block;
      continue;
    }
    if (block) continue;
    for (const char c : line) {
      if (c == '`') span = !span;
      if (!span && c != '`') found += c;
    }
    found += '\n';
  }
  return found;
}

/// The string literals of C++, one a line.
std::string literals_of(const std::string& text) {
  static const std::regex literal(R"re("(?:[^"\\\n]|\\.)* (?:[^"\\\n]|\\.)*")re");
  std::string found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("///") != std::string::npos) continue;
    for (auto match = std::sregex_iterator(line.begin(), line.end(), literal);
         match != std::sregex_iterator(); ++match)
      found += match->str() + '\n';
  }
  return found;
}

std::vector<std::string> objections_to(const std::string& text) {
  std::vector<std::string> found;
  for (const auto& [pattern, instead] : terms) {
    const std::regex wrong(pattern, std::regex::icase);
    for (auto match = std::sregex_iterator(text.begin(), text.end(), wrong);
         match != std::sregex_iterator(); ++match)
      found.push_back('"' + match->str() + "\", use: " + instead);
  }
  return found;
}

TEST(Words, OfThePagesAreTermsOfTheField) {
  std::vector<fs::path> pages{test::source_file("README.md")};
  for (const auto& file : fs::recursive_directory_iterator(test::source_file("docs")))
    if (file.path().extension() == ".md") pages.push_back(file.path());
  EXPECT_GT(pages.size(), 20U);
  for (const auto& page : pages)
    for (const auto& what : objections_to(without_code(test::read_text(page))))
      ADD_FAILURE() << page << ": " << what;
}

TEST(Words, OfTheProgramAreTermsOfTheField) {
  for (const char* folder : {"src", "apps"})
    for (const auto& file : fs::recursive_directory_iterator(test::source_file(folder))) {
      if (file.path().extension() != ".cpp") continue;
      for (const auto& what : objections_to(literals_of(test::read_text(file.path()))))
        ADD_FAILURE() << file.path() << ": " << what;
    }
}

TEST(Words, APrivateTermIsSeen) {
  EXPECT_EQ(objections_to(without_code("the knee `knee` bends\n")).size(), 1U);
  EXPECT_EQ(objections_to(literals_of("f(\"the machine as stated\");  // as stated\n")).size(), 1U);
  EXPECT_TRUE(objections_to("the compliance of the base").empty());
}

}  // namespace
}  // namespace hydrapod
