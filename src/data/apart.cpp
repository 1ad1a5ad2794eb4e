#include "apart.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>
#include <nlohmann/json.hpp>

#include "hdf5_text.hpp"

namespace hydrapod::data {

namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t window_numbers = 1U << 17U;          // 1 MiB, a block of samples
constexpr std::uint64_t longest_answer = 1ULL << 29U;        // bytes
constexpr int socket_place = 3, file_place = 4, places = 6;  // descriptors; the library has 5

/// A piece of a variable as VariableFile::read takes it, or with `all` real numbers fast_first …
/// of what read_all gives, real and imaginary parts in turn; the first one has it read.
struct Request {
  std::uint64_t variable{}, slow_first{}, slow_count{}, fast_first{}, fast_count{}, all{};
};

/// Memory that two processes share.
class Window {
 public:
  Window() {
    void* at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    numbers_ = static_cast<double*>(at);
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  ~Window() { ::munmap(numbers_, bytes); }
  [[nodiscard]] double* numbers() const { return numbers_; }

 private:
  static constexpr std::size_t bytes = window_numbers * sizeof(double);
  double* numbers_{};
};

// ---- the other process

bool send_all(int socket, const void* data, std::size_t bytes) {
  for (const char* at = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t sent = ::send(socket, at, bytes, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    bytes -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_request(Request& request) {
  for (std::size_t done = 0; done < sizeof request;) {
    const ssize_t got =
        ::recv(socket_place, reinterpret_cast<char*>(&request) + done, sizeof request - done, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

/// Ended by SIGPROF after so much time of the processor from now on.
void limit_time(double seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6);
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

/// What this process has of writable memory of its own [bytes]; 0 where that is not known.
std::uint64_t data_bytes() {
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  unsigned long long pages = 0;
  const int found = std::fscanf(file, "%*u %*u %*u %*u %*u %llu", &pages);
  std::fclose(file);
  return found == 1 ? pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

void set_limit(__rlimit_resource resource, std::uint64_t most) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(most, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

/// Signals end it, but not those that a terminal sends to all of a group; crashes leave no core
/// file.
void settle_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) std::signal(number, SIG_IGN);
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPROF})
    std::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  set_limit(RLIMIT_CORE, 0);
}

/// Its socket and the file stay open, and there is one place more, for the library. Where the file
/// then is.
std::string settle_descriptors(int socket, const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  const int nothing = ::open("/dev/null", O_RDWR);
  const int high_socket = ::fcntl(socket, F_DUPFD, places),
            high_file = file < 0 ? -1 : ::fcntl(file, F_DUPFD, places);
  if (nothing >= 0)
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
      ::dup2(nothing, standard);
  ::dup2(high_socket, socket_place);
  const bool open = high_file >= 0 && ::dup2(high_file, file_place) >= 0;
  ::close_range(open ? file_place + 1 : file_place, ~0U, 0);
  set_limit(RLIMIT_NOFILE, places);
  const std::string place = fmt::format("/proc/self/fd/{}", file_place);
  return open && ::access(place.c_str(), R_OK) == 0 ? place : path;
}

json told(const std::vector<base::Diagnostic>& diagnostics) {
  json all = json::array();
  for (const auto& d : diagnostics)
    all.push_back({d.severity == base::Severity::error, d.line, d.column, d.message});
  return all;
}

json told(const VariableFile& file) {
  json all = json::array();
  for (const Variable& v : file.variables())
    all.push_back({v.name, static_cast<int>(v.kind), v.fast, v.slow, v.unit, v.number, v.text,
                   v.texts, v.sizes, v.is_complex, v.declared});
  return {{"format", static_cast<int>(file.format())}, {"variables", std::move(all)}};
}

void answer(const json& message) {
  const std::vector<std::uint8_t> bytes = json::to_cbor(message);
  const std::uint64_t size = bytes.size();
  if (!send_all(socket_place, &size, sizeof size) ||
      !send_all(socket_place, bytes.data(), bytes.size()))
    ::_exit(1);
}

std::unique_ptr<VariableFile> open_and_tell(const std::string& place, const std::string& path,
                                            OpenVariableFile open) {
  Notes notes(path);
  json message;
  std::unique_ptr<VariableFile> file;
  try {
    file = open(place, notes);
    message = told(*file);
    message["notes"] = told(notes.all());
  } catch (const base::InputError& error) {
    message = {{"failure", told(error.diagnostics())}};
  } catch (const std::bad_alloc&) {
    message = {{"memory", true}};
  }
  answer(message);
  return file;
}

constexpr char read_mark = 1, memory_mark = 2;  // 0: the file is damaged there

/// False where the file is damaged there.
bool read_request(VariableFile& file, const Request& r, std::vector<std::complex<double>>& kept,
                  double* numbers) {
  if (r.all == 0)
    return file.read(r.variable, r.slow_first, r.slow_count, r.fast_first, r.fast_count, numbers);
  if (r.fast_first == 0 && !file.read_all(r.variable, kept)) return false;
  if (r.fast_first + r.fast_count > 2 * kept.size()) return false;
  std::memcpy(numbers, reinterpret_cast<const double*>(kept.data()) + r.fast_first,
              r.fast_count * sizeof(double));
  return true;
}

[[noreturn]] void serve(int socket, const std::string& path, OpenVariableFile open, double* numbers,
                        const ApartLimits& limits) noexcept {
  settle_signals();
  if (const std::uint64_t now = data_bytes(); now > 0) set_limit(RLIMIT_DATA, now + limits.bytes);
  const std::string place = settle_descriptors(socket, path);
  limit_time(limits.seconds);
  const auto file = open_and_tell(place, path, open);
  Request r;
  std::vector<std::complex<double>> kept;
  while (file && receive_request(r)) {
    limit_time(limits.seconds);
    char mark = 0;
    try {
      mark = read_request(*file, r, kept, numbers) ? read_mark : 0;
    } catch (const std::bad_alloc&) {
      mark = memory_mark;
    }
    if (!send_all(socket_place, &mark, 1)) break;
  }
  ::_exit(0);
}

// ---- this process

class ApartFile final : public VariableFile {
 public:
  ApartFile(const std::string& path, Notes& notes, OpenVariableFile open, std::string library,
            const ApartLimits& limits)
      : path_(path), library_(std::move(library)), limits_(limits) {
    begin(open);
    try {
      take(receive_message(), notes);
    } catch (...) {
      end();
      throw;
    }
  }
  ~ApartFile() override { end(); }

  bool read(std::size_t variable, std::uint64_t slow_first, std::uint64_t slow_count,
            std::uint64_t fast_first, std::uint64_t fast_count, double* out) override {
    if (fast_count == 0) return true;
    if (slow_count == 1 && read_ahead(variable, slow_first, fast_first, fast_count, out))
      return true;
    const std::uint64_t lines = std::max<std::uint64_t>(window_numbers / fast_count, 1),
                        numbers = std::min(window_numbers, fast_count);
    for (std::uint64_t line = 0; line < slow_count; line += lines)
      for (std::uint64_t at = 0; at < fast_count; at += numbers) {
        const Request piece{variable,
                            slow_first + line,
                            std::min(lines, slow_count - line),
                            fast_first + at,
                            std::min(numbers, fast_count - at),
                            0};
        if (!read_piece(piece, out)) return false;
        out += piece.slow_count * piece.fast_count;
      }
    return true;
  }

  bool read_all(std::size_t variable, std::vector<std::complex<double>>& out) override {
    std::uint64_t count = 1;
    for (const std::uint64_t size : variables_.at(variable).sizes) {
      if (size > most_in_memory / std::max<std::uint64_t>(count, 1)) return false;
      count *= size;
    }
    out.clear();  // memory grows with what has come, whatever sizes the file states
    std::vector<double> numbers(std::min(window_numbers, 2 * count));
    for (std::uint64_t at = 0; at < 2 * count; at += numbers.size()) {
      const Request piece{.variable = variable,
                          .slow_count = 1,
                          .fast_first = at,
                          .fast_count = std::min(window_numbers, 2 * count - at),
                          .all = 1};
      if (!read_piece(piece, numbers.data())) return false;
      if (at == 0) out.reserve(count);
      for (std::uint64_t k = 0; k < piece.fast_count; k += 2)
        out.emplace_back(numbers[k], numbers[k + 1]);
    }
    return true;
  }

 private:
  void begin(OpenVariableFile open) {
    std::array<int, 2> pair{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0)
      base::refuse(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
    const Hdf5Lock quiet;
    process_ = ::fork();
    if (process_ == 0) serve(pair[1], path_, open, window_.numbers(), limits_);
    const int cause = errno;
    ::close(pair[1]);
    socket_ = pair[0];
    if (process_ < 0) {
      ::close(socket_);
      base::refuse(path_, fmt::format("cannot be read: no process can be made for it: {}",
                                      std::strerror(cause)));
    }
  }

  /// Gone when it returns; its wait status.
  int end(bool now = false) {
    if (process_ <= 0) return 0;
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    if (now) ::kill(process_, SIGKILL);
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

  [[noreturn]] void fail(const std::string& why) const {
    base::refuse(path_, "cannot be read: " + why);
  }

  [[noreturn]] void fail_for_memory() const {
    fail(
        fmt::format("more than {} MiB of memory are needed for it: it is damaged, or its arrays "
                    "are larger than that",
                    limits_.bytes >> 20U));
  }

  /// It has ended by itself.
  [[noreturn]] void say_how_it_ended() {
    const int status = end();
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF)
      fail(fmt::format("{} takes longer than {:g} s for a part of it; the file is damaged",
                       library_, limits_.seconds));
    fail(fmt::format("{} crashed on it; the file is damaged", library_));
  }

  void receive(void* data, std::size_t bytes) {
    if (process_ <= 0) fail(fmt::format("{} ended before", library_));
    const auto deadline = Clock::now() + std::chrono::duration<double>(limits_.patience);
    for (char* at = static_cast<char*>(data); bytes > 0;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      pollfd wanted{.fd = socket_, .events = POLLIN, .revents = 0};
      const int ready = left <= 0 ? 0 : ::poll(&wanted, 1, static_cast<int>(left));
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0) {
        end(true);
        fail(fmt::format("no answer within {:g} s", limits_.patience));
      }
      const ssize_t got = ::recv(socket_, at, bytes, 0);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) say_how_it_ended();
      at += got;
      bytes -= static_cast<std::size_t>(got);
    }
  }

  json receive_message() {
    std::uint64_t size = 0;
    receive(&size, sizeof size);
    if (size > longest_answer) fail("its texts are longer than 512 MiB");
    std::vector<std::uint8_t> bytes(size);
    receive(bytes.data(), bytes.size());
    return json::from_cbor(bytes);
  }

  void take(const json& message, Notes& notes) {
    if (message.contains("memory")) fail_for_memory();
    if (message.contains("failure")) {
      std::vector<base::Diagnostic> all = notes.all();
      for (const json& d : message["failure"])
        all.push_back(
            {.severity = d[0].get<bool>() ? base::Severity::error : base::Severity::warning,
             .file = path_,
             .line = d[1],
             .column = d[2],
             .message = d[3]});
      throw base::InputError(std::move(all));
    }
    for (const json& d : message.at("notes")) notes.add(d[3], d[1], d[2]);
    format_ = static_cast<RecordFormat>(message.at("format").get<int>());
    for (const json& v : message.at("variables"))
      variables_.push_back({.name = v[0],
                            .kind = static_cast<VariableKind>(v[1].get<int>()),
                            .fast = v[2],
                            .slow = v[3],
                            .declared = v[10],
                            .sizes = v[8],
                            .is_complex = v[9],
                            .unit = v[4],
                            .number = v[5],
                            .text = v[6],
                            .texts = v[7]});
    for (const Variable& v : variables_)
      if (v.kind == VariableKind::numbers && v.fast > v.slow) lines_ += v.slow;
  }

  /// More of a line than was asked for, kept for the next calls: of channels that stand one behind
  /// the other each block needs a piece of every line, and the processes would take turns for each.
  /// False where nothing was read.
  bool read_ahead(std::size_t variable, std::uint64_t line, std::uint64_t first,
                  std::uint64_t count, double* out) {
    constexpr std::uint64_t longest = 1U << 15U, all = 1U << 22U;  // numbers
    const Variable& v = variables_[variable];
    const std::uint64_t length = std::min(longest, all / (lines_ + 1));
    if (count >= length || first + count >= v.fast) return false;
    Ahead& kept = ahead_[{variable, line}];
    if (first < kept.first || first + count > kept.first + kept.numbers.size()) {
      kept.first = first;
      kept.numbers.resize(std::min(length, v.fast - first));
      if (!read_piece({variable, line, 1, first, kept.numbers.size(), 0}, kept.numbers.data())) {
        kept.numbers.clear();
        return false;
      }
    }
    std::copy_n(kept.numbers.data() + (first - kept.first), count, out);
    return true;
  }

  bool read_piece(const Request& piece, double* out) {
    if (process_ > 0 && !send_all(socket_, &piece, sizeof piece)) say_how_it_ended();
    char good = 0;
    receive(&good, 1);
    if (good == memory_mark) fail_for_memory();
    if (good != read_mark) return false;
    std::copy_n(window_.numbers(), piece.slow_count * piece.fast_count, out);
    return true;
  }

  struct Ahead {
    std::uint64_t first{};
    std::vector<double> numbers{};
  };

  std::string path_, library_;
  ApartLimits limits_;
  Window window_;
  pid_t process_{-1};
  int socket_{-1};
  std::uint64_t lines_{};  ///< that can be read ahead, of all variables
  std::map<std::pair<std::size_t, std::uint64_t>, Ahead> ahead_;
};

// A sanitizer or fuzzer must see into the reader; Debian's HDF5 is then trusted not to crash.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool apart = false;
#elif defined(__has_feature)
constexpr bool apart = !__has_feature(address_sanitizer);
#else
constexpr bool apart = true;
#endif

}  // namespace

std::unique_ptr<VariableFile> open_apart(const std::string& path, Notes& notes,
                                         OpenVariableFile open, const std::string& library,
                                         const ApartLimits& limits) {
  return std::make_unique<ApartFile>(path, notes, open, library, limits);
}

bool hdf5_is_read_apart() { return apart; }

std::unique_ptr<VariableFile> open_hdf5_variables(const std::string& path, Notes& notes) {
  return apart ? open_apart(path, notes, open_hdf5_here, "the HDF5 library")
               : open_hdf5_here(path, notes);
}

std::unique_ptr<VariableFile> open_hdf5_remains(const std::string& path, Notes& notes) {
  return apart ? open_apart(path, notes, open_hdf5_remains_here, "the HDF5 library")
               : open_hdf5_remains_here(path, notes);
}

}  // namespace hydrapod::data
