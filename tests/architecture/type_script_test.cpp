/// The files of the page import each other without a circle, types included.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;

/// For each file the files that it imports.
using Imports = std::map<std::string, std::vector<std::string>>;

Imports imports_of(const std::map<std::string, std::string>& texts) {
  static const std::regex pattern(R"re((?:from|import)\s+'(\.[^']*)')re");
  Imports found;
  for (const auto& [file, text] : texts) {
    auto& imported = found[file];
    for (auto match = std::sregex_iterator(text.begin(), text.end(), pattern);
         match != std::sregex_iterator(); ++match) {
      const fs::path path = fs::path(file).parent_path() / ((*match)[1].str() + ".ts");
      imported.push_back(path.lexically_normal().generic_string());
    }
  }
  return found;
}

/// A circle that is met on the way from `file`, as "a -> b -> a"; empty without one.
std::string circle_from(const std::string& file, const Imports& imports,
                        std::map<std::string, bool>& done, std::vector<std::string>& way) {
  const auto before = std::find(way.begin(), way.end(), file);
  if (before != way.end()) {
    std::string circle = *before;
    for (auto next = before + 1; next != way.end(); ++next) circle += " -> " + *next;
    return circle + " -> " + file;
  }
  way.push_back(file);
  if (!done[file] && imports.contains(file)) {
    for (const auto& next : imports.at(file))
      if (auto circle = circle_from(next, imports, done, way); !circle.empty()) return circle;
  }
  done[file] = true;
  way.pop_back();
  return {};
}

std::string circle_in(const Imports& imports) {
  std::map<std::string, bool> done;
  for (const auto& [file, imported] : imports) {
    std::vector<std::string> way;
    if (auto circle = circle_from(file, imports, done, way); !circle.empty()) return circle;
  }
  return {};
}

TEST(TypeScript, FilesImportEachOtherWithoutACircle) {
  const fs::path folder = test::source_file("web/src");
  std::map<std::string, std::string> texts;
  for (const auto& file : fs::recursive_directory_iterator(folder))
    if (file.path().extension() == ".ts")
      texts[file.path().lexically_relative(folder).generic_string()] = test::read_text(file.path());
  const Imports imports = imports_of(texts);
  EXPECT_GT(imports.size(), 30U);
  for (const auto& [file, imported] : imports)
    for (const auto& path : imported) EXPECT_TRUE(imports.contains(path)) << file << ": " << path;
  EXPECT_EQ(circle_in(imports), "");
}

TEST(TypeScript, ACircleIsSeen) {
  const Imports imports = imports_of({{"a.ts", "import { b } from './part/b';"},
                                      {"part/b.ts", "import type {\n  C,\n} from '../c';"},
                                      {"c.ts", "import './part/b';"}});
  EXPECT_EQ(circle_in(imports), "part/b.ts -> c.ts -> part/b.ts");
  EXPECT_EQ(circle_in({{"a.ts", {"b.ts"}}, {"b.ts", {"c.ts"}}, {"c.ts", {}}}), "");
}

}  // namespace
}  // namespace hydrapod
