/// The layering of docs: a module includes only modules of lower floors, so there is no cycle.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;

const std::map<std::string, int> floors{
    {"base", 0},        {"spatial", 1},  {"numerics", 2},       {"model", 3},
    {"data", 3},        {"signals", 3},  {"kinematics", 4},     {"hydraulics", 4},
    {"dynamics", 5},    {"control", 5},  {"modal", 6},          {"response", 6},
    {"simulation", 6},  {"rig", 7},      {"identification", 7}, {"observation", 7},
    {"calibration", 8}, {"realtime", 8}, {"diagnosis", 9},      {"study", 9},
    {"exchange", 9},    {"report", 10},  {"tasks", 11}};

struct Include {
  std::string file{};
  std::size_t line{};
  std::string module{};  ///< that is included
};

/// The includes of hydrapod's own headers in `text`.
std::vector<Include> includes_of(const std::string& file, const std::string& text) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]hydrapod/(\w+)/)");
  std::vector<Include> found;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (std::regex_search(line, match, pattern)) found.push_back({file, number, match[1]});
  }
  return found;
}

/// What is wrong with `include` standing in a file of `module`; empty when it is allowed.
std::string objection(const std::string& module, const Include& include) {
  if (include.module == module) return {};
  const std::string place = include.file + ':' + std::to_string(include.line) + ": ";
  if (!floors.contains(include.module)) return place + "unknown module " + include.module;
  if (floors.at(include.module) < floors.at(module)) return {};
  return place + module + " (floor " + std::to_string(floors.at(module)) + ") includes " +
         include.module + " (floor " + std::to_string(floors.at(include.module)) + ')';
}

std::vector<std::string> objections_in(const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& module_folder : fs::directory_iterator(folder)) {
    if (!module_folder.is_directory()) continue;
    const std::string module = module_folder.path().filename().string();
    if (!floors.contains(module)) {
      found.push_back(module_folder.path().string() + ": a module without a floor");
      continue;
    }
    for (const auto& file : fs::recursive_directory_iterator(module_folder)) {
      if (!file.is_regular_file()) continue;
      for (const Include& include :
           includes_of(file.path().string(), test::read_text(file.path()))) {
        if (const auto what = objection(module, include); !what.empty()) found.push_back(what);
      }
    }
  }
  return found;
}

TEST(Floors, ModulesIncludeOnlyLowerFloors) {
  for (const char* folder : {"include/hydrapod", "src"}) {
    for (const auto& what : objections_in(test::source_file(folder))) ADD_FAILURE() << what;
  }
}

TEST(Floors, TheLibraryDoesNotIncludeTheProgramOrTheTests) {
  const std::regex upward(R"(#\s*include\s*[<"](hydrapod/\w+\.hpp|apps/|support/|exact/))");
  for (const char* folder : {"include/hydrapod", "src"}) {
    for (const auto& file : fs::recursive_directory_iterator(test::source_file(folder))) {
      if (!file.is_regular_file()) continue;
      EXPECT_FALSE(std::regex_search(test::read_text(file.path()), upward)) << file.path();
    }
  }
}

/// What files in quotes include, with the files that do.
std::map<std::string, std::vector<fs::path>> includers_in(const char* folder) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*"([^"]+)")re");
  std::map<std::string, std::vector<fs::path>> found;
  for (const auto& file : fs::recursive_directory_iterator(test::source_file(folder))) {
    if (!file.is_regular_file()) continue;
    std::istringstream lines(test::read_text(file.path()));
    for (std::string line; std::getline(lines, line);) {
      std::smatch match;
      if (std::regex_search(line, match, pattern)) found[match[1]].push_back(file.path());
    }
  }
  return found;
}

/// The module of a file below include/hydrapod or src; empty for the umbrella header.
std::string module_of(const fs::path& file) {
  for (const char* folder : {"include/hydrapod", "src"}) {
    const fs::path inside = fs::relative(file, test::source_file(folder));
    if (!inside.empty() && *inside.begin() != "..")
      return inside.has_parent_path() ? inside.begin()->string() : std::string{};
  }
  return {};
}

TEST(Floors, PrivateHeadersAreIncludedByTheirOwnModuleOnly) {
  for (const auto& [header, files] : includers_in("src")) {
    if (header.starts_with("hydrapod/")) continue;
    for (const fs::path& file : files) {
      const fs::path module = test::source_file("src") / fs::path(module_of(file));
      EXPECT_TRUE(fs::exists(file.parent_path() / header) || fs::exists(module / header) ||
                  header.starts_with(module_of(file) + '/'))
          << file << " includes " << header;
    }
  }
  for (const auto& [header, files] : includers_in("include/hydrapod"))
    EXPECT_TRUE(header.starts_with("hydrapod/")) << files.front() << " includes " << header;
}

TEST(Floors, PublicHeadersAreFew) {
  constexpr int most = 60;
  int count = 1;  // base/version.hpp, which the build writes
  for (const auto& file : fs::recursive_directory_iterator(test::source_file("include/hydrapod")))
    count += file.is_regular_file() ? 1 : 0;
  EXPECT_LE(count, most);
}

/// Needed by another module or by the program, itself or through another public header. What tasks
/// has is there for users of the library.
TEST(Floors, PublicHeadersAreNeededOutsideTheirModule) {
  std::map<std::string, std::vector<fs::path>> includers;
  for (const char* folder : {"include/hydrapod", "src", "apps"})
    for (auto& [header, files] : includers_in(folder))
      includers[header].insert(includers[header].end(), files.begin(), files.end());
  const fs::path include = test::source_file("include");
  std::map<std::string, bool> needed;
  const auto is_needed = [&](const auto& self, const std::string& header) -> bool {
    if (const auto known = needed.find(header); known != needed.end()) return known->second;
    const std::string module = module_of(include / header);
    bool result = module.empty() || module == "tasks";
    for (const fs::path& file : includers[header]) {
      const std::string other = module_of(file);
      const fs::path inside = fs::relative(file, include);
      const bool is_public = *inside.begin() != "..";
      result = result || (other != module && !(is_public && other.empty())) ||
               (is_public && other == module && self(self, inside.generic_string()));
    }
    return needed[header] = result;
  };
  for (const auto& file : fs::recursive_directory_iterator(include / "hydrapod")) {
    if (!file.is_regular_file()) continue;
    const std::string header = fs::relative(file.path(), include).generic_string();
    EXPECT_TRUE(is_needed(is_needed, header)) << header << " belongs into src";
  }
}

TEST(Floors, FewFilesOfTheProgramCompileCli11) {
  std::set<std::string> files;
  for (const auto& file : fs::directory_iterator(test::source_file("apps/hydrapod")))
    if (test::read_text(file.path()).find("#include <CLI/") != std::string::npos)
      files.insert(file.path().filename().string());
  EXPECT_EQ(files,
            (std::set<std::string>{"help.cpp", "help_pages.cpp", "main.cpp", "options.cpp"}));
}

TEST(Floors, AnUpwardIncludeIsSeen) {
  const auto found =
      includes_of("x.cpp", "#include <vector>\n  #  include \"hydrapod/modal/m.hpp\"\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(objection("model", found[0]), "x.cpp:2: model (floor 3) includes modal (floor 6)");
  EXPECT_EQ(objection("response", found[0]),
            "x.cpp:2: response (floor 6) includes modal (floor 6)");
  EXPECT_EQ(objection("study", found[0]), "");
}

}  // namespace
}  // namespace hydrapod
