#include "hydrapod/studio/jobs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/progress.hpp"

namespace hydrapod::studio {

namespace {
namespace asio = boost::asio;
using Failure = boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::size_t largest_result = std::size_t{256} << 20U;
constexpr std::size_t largest_picture = std::size_t{8} << 20U;
constexpr std::size_t most_messages = 200;

/// Records that were sent are in FOLDER/NUMBER/NAME; who sent them knows the name.
std::string without_folder(std::string line, const std::string& folder) {
  if (folder.empty()) return line;
  const std::string begin = folder + "/";
  for (auto at = line.find(begin); at != line.npos; at = line.find(begin, at)) {
    const auto number_end = line.find_first_not_of("0123456789", at + begin.size());
    if (number_end == line.npos || line[number_end] != '/') {
      at += begin.size();
      continue;
    }
    line.erase(at, number_end + 1 - at);
  }
  return line;
}
constexpr std::string_view progress_word = "progress ";

struct Pipe {
  int read_end{-1}, write_end{-1};
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw base::ComputationError(fmt::format("no pipe: {}", std::strerror(errno)));
    read_end = ends[0];
    write_end = ends[1];
  }
};

/// Behind fork(): only what a signal handler may call, too.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment,
                         int out, int err, pid_t parent) {
  ::setpgid(0, 0);  // Ctrl-C is for the studio, which tells its jobs
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(1);
  ::signal(SIGINT, SIG_DFL);
  ::signal(SIGPIPE, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::execve(program, arguments, environment);
  ::_exit(127);
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (auto& text : texts) all.push_back(text.data());
  all.push_back(nullptr);
  return all;
}

pid_t started(const std::string& program, const std::vector<std::string>& arguments, int out,
              int err) {
  std::vector<std::string> words{"hydrapod"}, variables{std::string(cli::progress_variable) + "=1"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  for (char** one = environ; *one != nullptr; ++one) variables.emplace_back(*one);
  const auto argv = pointers(words), envp = pointers(variables);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) become(program.c_str(), argv.data(), envp.data(), out, err, parent);
  if (child < 0)
    throw base::ComputationError(
        fmt::format("no process could be begun: {}", std::strerror(errno)));
  ::setpgid(child, child);
  return child;
}

std::string picture_at(const std::string& path) {
  if (path.empty()) return {};
  try {
    return base::read_file(path, largest_picture, "a picture");
  } catch (const base::InputError&) {  // there is none
    return {};
  }
}

}  // namespace

/// A job with its process.
class Jobs::Work : public std::enable_shared_from_this<Jobs::Work> {
 public:
  Work(asio::io_context& context, std::function<void(const std::shared_ptr<Work>&)> told)
      : out_(context), err_(context), timer_(context), told_(std::move(told)) {}

  Job job;

  void begin(const std::string& program) {
    const Pipe out, err;
    out_.assign(out.read_end);
    err_.assign(err.read_end);
    begun_ = Clock::now();
    process_ = started(program, job.plan.arguments, out.write_end, err.write_end);
    ::close(out.write_end);
    ::close(err.write_end);
    job.state = JobState::running;
    read(out_, out_buffer_, [this](std::string_view text) { take_result(text); });
    read(err_, err_buffer_, [this](std::string_view text) { take_messages(text); });
  }

  void cancel() {
    if (job.state == JobState::waiting) {
      job.state = JobState::cancelled;
    } else if (process_ > 0) {
      cancelled_ = true;
      ::kill(-process_, SIGINT);
      kill_after(std::chrono::seconds(5));
    }
  }

  void kill() const {
    if (process_ > 0) ::kill(-process_, SIGKILL);
  }

 private:
  using Buffer = std::array<char, 65536>;

  template <class Take>
  void read(asio::posix::stream_descriptor& from, Buffer& buffer, Take take) {
    from.async_read_some(asio::buffer(buffer), [self = shared_from_this(), &from, &buffer, take](
                                                   Failure failure, std::size_t count) {
      if (failure) {
        Failure ignored;
        from.close(ignored);
        if (++self->ended_ == 2) self->wait();
        return;
      }
      take(std::string_view(buffer.data(), count));
      self->read(from, buffer, take);
    });
  }

  void take_result(std::string_view text) {
    if (result_.size() + text.size() > largest_result) {
      if (!too_large_) kill();
      too_large_ = true;
      return;
    }
    result_ += text;
  }

  void take_messages(std::string_view text) {
    line_ += text;
    for (auto end = line_.find('\n'); end != line_.npos; end = line_.find('\n')) {
      take_line(std::string_view(line_).substr(0, end));
      line_.erase(0, end + 1);
    }
    if (line_.size() > largest_line) line_.clear();
  }

  void take_line(std::string_view line) {
    if (!line.starts_with(progress_word)) {
      if (line.empty() || job.messages.size() >= most_messages) return;
      job.messages.push_back(
          base::printable(without_folder(std::string(line), job.plan.folder), largest_line));
      return told_(shared_from_this());
    }
    line.remove_prefix(progress_word.size());
    double share = 0.0;
    if (std::from_chars(line.data(), line.data() + line.size(), share).ec != std::errc()) return;
    job.fraction = std::clamp(share, 0.0, 1.0);
    const double spent = seconds_since_begin();
    job.seconds_left.reset();
    if (spent > 1.0 && job.fraction > 0.0)
      job.seconds_left = spent * (1.0 - job.fraction) / job.fraction;
    told_(shared_from_this());
  }

  [[nodiscard]] double seconds_since_begin() const {
    return std::chrono::duration<double>(Clock::now() - begun_).count();
  }

  void kill_after(std::chrono::seconds time) {
    timer_.expires_after(time);
    timer_.async_wait([self = shared_from_this()](Failure failure) {
      if (!failure) self->kill();
    });
  }

  /// Both streams have ended, so the process has or is about to.
  void wait() {
    int status = 0;
    const pid_t found = ::waitpid(process_, &status, WNOHANG);
    if (found == 0) {
      poll_.emplace(timer_.get_executor());
      poll_->expires_after(std::chrono::milliseconds(10));
      poll_->async_wait([self = shared_from_this()](Failure) { self->wait(); });
      return;
    }
    process_ = -1;
    timer_.cancel();
    finish(status);
    told_(shared_from_this());
  }

  void finish(int status) {
    if (!line_.empty()) take_line(std::exchange(line_, {}));
    job.seconds = seconds_since_begin();
    job.seconds_left.reset();
    job.drawn = picture_at(job.plan.picture);
    if (!result_.empty()) job.result = report::Json::parse(result_, nullptr, false);
    if (job.result.is_discarded()) job.result = nullptr;
    result_ = {};
    const bool well = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    job.state = well ? JobState::done : cancelled_ ? JobState::cancelled : JobState::failed;
    if (well) job.fraction = 1.0;
    if (well || cancelled_) return;
    if (too_large_)
      job.messages.emplace_back("error: the result is larger than 256 MiB");
    else if (WIFSIGNALED(status))
      job.messages.push_back(fmt::format("error: the calculation was ended by the signal {} ({})",
                                         WTERMSIG(status), ::strsignal(WTERMSIG(status))));
    else if (job.messages.empty())
      job.messages.push_back(fmt::format("error: exit code {}", WEXITSTATUS(status)));
  }

  static constexpr std::size_t largest_line = 16384;
  asio::posix::stream_descriptor out_, err_;
  asio::steady_timer timer_;
  std::optional<asio::steady_timer> poll_;
  std::function<void(const std::shared_ptr<Work>&)> told_;
  Buffer out_buffer_{}, err_buffer_{};
  std::string result_, line_;
  Clock::time_point begun_;
  pid_t process_{-1};
  int ended_{};
  bool cancelled_{}, too_large_{};
};

Jobs::Jobs(asio::io_context& context, std::string program, std::function<void(const Job&)> changed)
    : context_(context), program_(std::move(program)), changed_(std::move(changed)) {}

Jobs::~Jobs() {
  for (const auto& work : works_) work->kill();
}

std::uint64_t Jobs::start(JobPlan plan) {
  const auto waiting = std::ranges::count_if(
      works_, [](const auto& work) { return work->job.state == JobState::waiting; });
  if (static_cast<std::size_t>(waiting) >= most_waiting)
    base::refuse(plan.title, fmt::format("{} jobs wait already", waiting));
  const auto work = std::make_shared<Work>(context_, [this](const auto& one) {
    if (one->job.is_over()) return ended(one);
    changed_(one->job);
  });
  work->job.id = ++last_;
  work->job.plan = std::move(plan);
  works_.push_back(work);
  changed_(work->job);
  begin_next();
  return work->job.id;
}

void Jobs::begin_next() {
  if (stopping_) return;
  auto running = std::ranges::count_if(
      works_, [](const auto& work) { return work->job.state == JobState::running; });
  for (const auto& work : works_) {
    if (static_cast<std::size_t>(running) >= most_running) return;
    if (work->job.state != JobState::waiting) continue;
    try {
      work->begin(program_);
      ++running;
    } catch (const std::exception& error) {
      work->job.state = JobState::failed;
      work->job.messages.emplace_back(error.what());
    }
    changed_(work->job);
  }
}

void Jobs::ended(const std::shared_ptr<Work>& work) {
  const auto then = work->job.plan.then;
  const bool well = work->job.state == JobState::done;
  changed_(work->job);
  if (stopping_) return;
  if (well)
    for (const auto& plan : then) {
      try {
        start(plan);
      } catch (const base::InputError& error) {  // too many wait
        work->job.messages.emplace_back(error.what());
        changed_(work->job);
      }
    }
  begin_next();
  drop_old();
}

void Jobs::drop_old() {
  auto over = std::ranges::count_if(works_, [](const auto& work) { return work->job.is_over(); });
  std::erase_if(works_, [&](const auto& work) {
    return work->job.is_over() && over-- > static_cast<std::ptrdiff_t>(most_kept);
  });
}

bool Jobs::cancel(std::uint64_t id) {
  for (const auto& work : works_) {
    if (work->job.id != id || work->job.is_over()) continue;
    work->cancel();
    changed_(work->job);
    return true;
  }
  return false;
}

std::vector<std::shared_ptr<const Job>> Jobs::all() const {
  std::vector<std::shared_ptr<const Job>> jobs;
  for (const auto& work : works_) jobs.emplace_back(work, &work->job);
  return jobs;
}

std::shared_ptr<const Job> Jobs::find(std::uint64_t id) const {
  for (const auto& work : works_)
    if (work->job.id == id) return {work, &work->job};
  return {};
}

void Jobs::stop() {
  stopping_ = true;
  for (const auto& work : works_)
    if (!work->job.is_over()) work->cancel();
}

bool Jobs::any_running() const {
  return std::ranges::any_of(works_,
                             [](const auto& work) { return work->job.state == JobState::running; });
}

}  // namespace hydrapod::studio
