#pragma once
/// Runs a program the way a shell does and keeps what it wrote: tests of the command line.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hydrapod::test {

struct RunOptions {
  std::string input{};                                           ///< what stands on its stdin
  std::filesystem::path folder{};                                ///< working directory; empty: ours
  std::vector<std::pair<std::string, std::string>> variables{};  ///< added to the environment
  double timeout{60.0};                                          ///< [s], then it is killed
};

struct RunResult {
  int exit_code{-1};  ///< 128 + n when signal n ended it, as a shell reports it
  std::string out{};  ///< stdout
  std::string err{};  ///< stderr
  bool timed_out{};
  double processor_seconds{};  ///< of it and of the processes that it waited for
  double peak_mib{};           ///< the most memory of any of them
};

/// Runs `program` (looked up in PATH if it has no slash) with `arguments`. Throws std::system_error
/// when it cannot be started.
RunResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                      const RunOptions& options = {});

/// Runs the program `hydrapod` of this build.
RunResult run_hydrapod(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// Where the program `hydrapod` of this build stands.
std::filesystem::path hydrapod_program();

/// Makes calls of the system fail where it is preloaded (tests/faults); empty in builds with
/// sanitizers, whose own calls would fail.
std::filesystem::path failing_calls();

/// A file of the repository: `source_file("models/paper.toml")`.
std::filesystem::path source_file(const std::string& relative);

/// The whole text of a file; throws std::runtime_error if it cannot be read.
std::string read_text(const std::filesystem::path& path);

/// Replaces the file by `text`; throws std::runtime_error if it cannot be written.
void write_text(const std::filesystem::path& path, const std::string& text);

/// A new, empty folder that is removed with all it holds at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// `folder / "name"` is a path in it.
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace hydrapod::test
