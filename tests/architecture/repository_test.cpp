/// What must not stand in any file of the repository.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace hydrapod {
namespace {
namespace fs = std::filesystem;

/// The text files of the repository, without what is built or fetched.
std::vector<fs::path> repository_files() {
  const std::set<std::string> skipped{".git", "build", "install", "node_modules"};
  std::vector<fs::path> files;
  auto entry = fs::recursive_directory_iterator(test::source_file(""));
  for (; entry != fs::recursive_directory_iterator(); ++entry) {
    if (skipped.contains(entry->path().filename().string())) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file()) {
      files.push_back(entry->path());
    }
  }
  return files;
}

TEST(Repository, HoldsNoPathOfOneParticularMachine) {
  // put together, so that this file does not hold them either
  const std::vector<std::string> private_paths{std::string("/wo") + "rk/",
                                               std::string("..") + "/shared"};
  for (const fs::path& file : repository_files()) {
    const std::string text = test::read_text(file);
    for (const std::string& path : private_paths) {
      EXPECT_EQ(text.find(path), std::string::npos) << file << " holds " << path;
    }
  }
}

}  // namespace
}  // namespace hydrapod
