/// Concepts that were once defined many times have one definition each.

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;

struct Concept {
  const char* name;
  const char* definition;          ///< a regular expression
  std::vector<std::string> files;  ///< where it stands
};

const std::vector<Concept> concepts{
    {"two pi", R"(2\.0\s*\*\s*std::numbers::pi\b|6\.28318)", {"include/hydrapod/base/units.hpp"}},
    {"names of directions", R"("x",\s*"y",\s*"z",\s*"rx")", {"include/hydrapod/spatial/pose.hpp"}},
    {"trimmed text", R"(string(_view)?\s+trimmed\([^;]*\)\s*\{)", {"src/base/text.cpp"}},
    {"pose by its name", R"(&(model::)?NamedPose::name\b)", {"src/model/parameters.cpp"}},
    {"Fourier transform", R"(unsupported/Eigen/FFT)", {"src/numerics/fft.cpp"}},
    {"loop over threads",
     R"(std::j?thread\b)",
     {"src/numerics/parallel.cpp", "src/realtime/record_queue.cpp",
      "src/realtime/record_queue.hpp"}},
    {"quantiles", R"(1\.96\b|1\.9599|3\.8414)", {"include/hydrapod/numerics/statistics.hpp"}},
};

/// Files of library and program in which `pattern` stands, relative to the repository.
std::vector<std::string> files_with(const std::string& pattern) {
  const std::regex expression(pattern);
  const fs::path root = test::source_file("");
  std::vector<std::string> found;
  for (const char* folder : {"include/hydrapod", "src", "apps"})
    for (const auto& file : fs::recursive_directory_iterator(test::source_file(folder))) {
      const auto ending = file.path().extension();
      if (ending != ".cpp" && ending != ".hpp") continue;
      if (std::regex_search(test::read_text(file.path()), expression))
        found.push_back(fs::relative(file.path(), root).string());
    }
  std::ranges::sort(found);
  return found;
}

TEST(Concepts, HaveOneDefinition) {
  for (const auto& one : concepts) EXPECT_EQ(files_with(one.definition), one.files) << one.name;
}

}  // namespace
}  // namespace hydrapod
