#pragma once
/// Long work: the program itself, once more, with the arguments that a person would give it.
///
/// A job is a process. Its result is what it prints (the JSON of `--format json`), its messages are
/// those of the command line, and a job that crashes takes nothing with it. It reports its progress
/// as HYDRAPOD_PROGRESS asks (terminal.hpp), ends by SIGINT as after Ctrl-C (what there is is
/// kept), and does not outlive the studio.

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/report/json.hpp"

namespace boost::asio {
class io_context;
}

namespace hydrapod::studio {

enum class JobState { waiting, running, done, failed, cancelled };

/// What is to be done, and where its result goes.
struct JobPlan {
  std::string kind{};                    ///< "identify"
  std::string title{};                   ///< "identify run.h5"
  std::vector<std::string> arguments{};  ///< behind the program's name
  std::string picture{};                 ///< SVG that it draws; empty: none
  std::string section{};                 ///< of the page; empty: the result is shown with the job
  std::string output{};                  ///< file that it writes for the user
  std::string folder{};                  ///< of records that were sent: messages leave it out
  std::vector<JobPlan> then{};           ///< begun when this has a result
};

struct Job {
  std::uint64_t id{};
  JobPlan plan{};
  JobState state{};
  double fraction{};
  std::optional<double> seconds_left{};
  double seconds{};                     ///< that it took, or has taken
  std::vector<std::string> messages{};  ///< warnings, errors, notes
  report::Json result{};                ///< null: none
  std::string drawn{};                  ///< the picture, as SVG

  [[nodiscard]] bool is_over() const { return state > JobState::running; }
};

class Jobs {
 public:
  static constexpr std::size_t most_running = 2;
  static constexpr std::size_t most_waiting = 16;
  static constexpr std::size_t most_kept = 30;  ///< that are over

  /// `changed` is called with each change of a job, in the io_context.
  Jobs(boost::asio::io_context& context, std::string program,
       std::function<void(const Job&)> changed);
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;
  ~Jobs();

  /// Throws base::InputError where too many wait.
  std::uint64_t start(JobPlan plan);
  /// False where there is no such job, or it is over.
  bool cancel(std::uint64_t id);
  [[nodiscard]] std::vector<std::shared_ptr<const Job>> all() const;
  [[nodiscard]] std::shared_ptr<const Job> find(std::uint64_t id) const;
  /// Ends all; those that run get a moment to keep what they have.
  void stop();
  [[nodiscard]] bool any_running() const;

 private:
  class Work;
  void begin_next();
  void ended(const std::shared_ptr<Work>& work);
  void drop_old();

  boost::asio::io_context& context_;
  std::string program_;
  std::function<void(const Job&)> changed_;
  std::deque<std::shared_ptr<Work>> works_;
  std::uint64_t last_{};
  bool stopping_{};
};

}  // namespace hydrapod::studio
