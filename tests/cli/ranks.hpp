#pragma once
/// A study by ranks of MPI that are killed.

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "support/run_program.hpp"

namespace hydrapod::test {

/// Whether this build has MPI and the machine has mpirun.
inline bool has_mpi() {
  const auto plugin = hydrapod_program().parent_path().parent_path() / "mpi" / "hydrapod_mpi.so";
  return std::filesystem::exists(plugin) &&
         run_program("sh", {"-c", "command -v mpirun"}).exit_code == 0;
}

/// mpirun also as root, with more ranks than processors.
inline std::vector<std::string> mpirun(int ranks, const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"--allow-run-as-root", "--oversubscribe", "-n",
                               std::to_string(ranks), hydrapod_program().string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

/// Children of a process.
inline std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> all;
  const auto tasks = std::filesystem::path("/proc") / std::to_string(parent) / "task";
  std::error_code none;
  for (const auto& task : std::filesystem::directory_iterator(tasks, none)) {
    std::ifstream list(task.path() / "children");
    for (pid_t child = 0; list >> child;) all.push_back(child);
  }
  return all;
}

/// Kills mpirun and the ranks that it has started.
inline bool kill_all(pid_t job) {
  const auto ranks = children_of(job);
  const bool killed = ::kill(job, SIGKILL) == 0;
  for (const pid_t rank : ranks) ::kill(rank, SIGKILL);
  return killed;
}

/// The status of a job at its end. An mpirun that loses a rank while it starts the others may wait
/// for them for ever: after a while it is killed as well.
inline int status_at_end(pid_t job) {
  constexpr int most = 400;
  int status = 0;
  for (int k = 0; k < most; ++k) {
    if (::waitpid(job, &status, WNOHANG) == job) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  kill_all(job);
  ::waitpid(job, &status, 0);
  return status;
}

/// Runs a job; after `moment` seconds kills its rank number `which` (of those there are), or mpirun
/// itself where it is negative. True where the job was still at work.
inline bool killed_job(const std::vector<std::string>& arguments, double moment, int which) {
  const pid_t job = ::fork();
  if (job == 0) {
    std::vector<std::string> words{"mpirun"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(moment));
  const auto ranks = children_of(job);
  bool killed = false;
  if (which < 0 || ranks.empty()) {
    killed = kill_all(job);
  } else {
    killed = ::kill(ranks[static_cast<std::size_t>(which) % ranks.size()], SIGKILL) == 0;
  }
  const int status = status_at_end(job);
  return killed && !(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace hydrapod::test
