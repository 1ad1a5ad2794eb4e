#include "support/run_program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "support/places.hpp"

/// HDF5, where a sanitizer reads it in the same process, leaks what it had read of a file that it
/// then refuses. This file is part of every test program.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5_serial\n"; }

namespace hydrapod::test {

namespace fs = std::filesystem;

namespace {
[[noreturn]] void throw_errno(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// In the child: no return. Only calls that are safe after fork, besides setenv.
[[noreturn]] void become(const std::string& program, std::vector<char*>& argv,
                         const RunOptions& options, const fs::path& streams) {
  const int in = ::open((streams / "in").c_str(), O_RDONLY);
  const int out = ::open((streams / "out").c_str(), O_WRONLY | O_CREAT, 0600);
  const int err = ::open((streams / "err").c_str(), O_WRONLY | O_CREAT, 0600);
  ::dup2(in, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::setenv("SOURCE_DATE_EPOCH", "1700000001", 0);  // results of two runs can be compared
  for (const auto& [name, value] : options.variables) ::setenv(name.c_str(), value.c_str(), 1);
  if (options.folder.empty() || ::chdir(options.folder.c_str()) == 0) {
    ::execvp(program.c_str(), argv.data());
  }
  ::_exit(127);
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// Waits for `child` until the timeout, then kills it; its wait status.
int wait_for(pid_t child, double timeout, RunResult& result) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(timeout);
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    if (Clock::now() > deadline) {
      result.timed_out = true;
      ::kill(child, SIGKILL);
      ::wait4(child, &status, 0, &usage);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  result.processor_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  result.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return status;
}
}  // namespace

RunResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                      const RunOptions& options) {
  const TemporaryFolder streams;
  write_text(streams / "in", options.input);
  for (const char* stream : {"out", "err"})  // one that is killed at once has made none
    write_text(streams / stream, "");
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = ::fork();
  if (child < 0) throw_errno("fork");
  if (child == 0) become(program, argv, options, streams.path());

  RunResult result;
  const int status = wait_for(child, options.timeout, result);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_text(streams / "out");
  result.err = read_text(streams / "err");
  if (result.exit_code == 127) {
    throw std::system_error(ENOENT, std::generic_category(), "cannot start " + program);
  }
  return result;
}

RunResult run_hydrapod(const std::vector<std::string>& arguments, const RunOptions& options) {
  return run_program(hydrapod_program().string(), arguments, options);
}

fs::path hydrapod_program() { return program_file; }

fs::path failing_calls() { return failing_calls_file; }

fs::path source_file(const std::string& relative) { return fs::path(source_folder) / relative; }

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "hydrapod-test-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw_errno("mkdtemp " + pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace hydrapod::test
