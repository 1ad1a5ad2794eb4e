#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <future>
#include <optional>
#include <thread>

#include "hydrapod/base/error.hpp"
#include "run_parts.hpp"

namespace hydrapod::study {

namespace {

namespace fs = std::filesystem;

/// Chunks that are handed out together.
struct Range {
  std::uint64_t first{}, count{};
};

std::string file_of_rank(const std::string& spool, int rank) {
  return fmt::format("{}.{}", spool, rank);
}

std::optional<SpoolHead> head_in(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  SpoolHead head;
  if (!file.read(reinterpret_cast<char*>(&head), sizeof head) || head.magic != rank_magic)
    return {};
  return head;
}

/// The file of a rank, appended to without a buffer: what was written survives the end of the
/// program.
class RankFile {
 public:
  RankFile(std::string path, const SpoolHead& head, bool resume)
      : path_(std::move(path)),
        head_(head),
        record_(record_bytes(head.width) / sizeof(std::uint64_t)),
        held_(std::make_shared<RowsFile>(path_, head.magic, resume, true)),
        file_(held_->number()) {
    cut_to_good_records();
  }

  [[nodiscard]] std::shared_ptr<void> held() const { return held_; }

  /// `numbers`: the rows, followed by room for a whole chunk.
  void add(std::uint64_t chunk, std::span<const double> numbers) {
    record_.front() = chunk;
    std::fill(record_.begin() + 1, record_.end(), 0);
    std::memcpy(record_.data() + 1, numbers.data(), numbers.size_bytes());
    record_.back() = hash_of(record_.data(), (record_.size() - 1) * sizeof(std::uint64_t));
    write(record_.data(), record_.size() * sizeof(std::uint64_t));
  }

 private:
  [[noreturn]] void fail() const {
    throw base::ComputationError(
        fmt::format("{} cannot be written: {} (go on with --resume)", path_, std::strerror(errno)));
  }
  void write(const void* bytes, std::size_t size) const {
    if (!write_all(file_, bytes, size)) fail();
  }
  /// The file ends behind the last whole record.
  void cut_to_good_records() {
    const auto size = static_cast<std::uint64_t>(::lseek(file_, 0, SEEK_END));
    const std::uint64_t bytes = record_bytes(head_.width);
    const bool headed = size >= sizeof head_;
    const std::uint64_t good = headed ? sizeof head_ + (size - sizeof head_) / bytes * bytes : 0;
    if (::ftruncate(file_, static_cast<off_t>(good)) != 0 ||
        ::lseek(file_, static_cast<off_t>(good), SEEK_SET) < 0)
      fail();
    if (!headed) write(&head_, sizeof head_);
  }

  std::string path_;
  SpoolHead head_;
  std::vector<std::uint64_t> record_;
  std::shared_ptr<RowsFile> held_;
  int file_;
};

/// Hands out what no file has yet: a quarter of what is left, over the ranks, at most 64 chunks.
class Dispenser {
 public:
  Dispenser(std::uint64_t chunks, int ranks) : done_(chunks), ranks_(ranks), left_(chunks) {}

  /// Marks the good chunks of the files of an earlier run. Throws base::InputError for files of
  /// another study.
  std::uint64_t take_files(const std::vector<std::string>& files, const SpoolHead& expected) {
    std::uint64_t found = 0;
    std::vector<std::uint64_t> record(record_bytes(expected.width) / sizeof(std::uint64_t));
    for (const auto& path : files) {
      std::ifstream file(path, std::ios::binary);
      SpoolHead head;
      if (!file.read(reinterpret_cast<char*>(&head), sizeof head)) continue;  // killed before
      if (std::memcmp(&head, &expected, sizeof head) != 0)
        base::refuse(path,
                     "holds rows of another study (machine, inputs, outputs, samples, seed or "
                     "program differ); --force without --resume begins anew");
      while (file.read(reinterpret_cast<char*>(record.data()),
                       static_cast<std::streamsize>(record_bytes(expected.width)))) {
        if (record.front() >= done_.size() ||
            record.back() != hash_of(record.data(), (record.size() - 1) * sizeof(std::uint64_t)))
          base::refuse(path, "is damaged; delete it, the study goes on with --resume");
        if (!done_[record.front()]) ++found;
        done_[record.front()] = true;
      }
    }
    left_ -= found;
    return found;
  }

  std::optional<Range> next() {
    while (at_ < done_.size() && done_[at_]) ++at_;
    if (stopped_ || at_ == done_.size()) return {};
    constexpr std::uint64_t most = 64;
    const std::uint64_t fair = left_ / (4 * static_cast<std::uint64_t>(ranks_));
    const std::uint64_t wanted = std::clamp<std::uint64_t>(fair, 1, most);
    Range range{.first = at_};
    while (at_ < done_.size() && !done_[at_] && range.count < wanted) {
      ++at_;
      ++range.count;
    }
    left_ -= range.count;
    return range;
  }
  void stop() { stopped_ = true; }

 private:
  std::vector<bool> done_;
  int ranks_;
  std::uint64_t left_, at_{};
  bool stopped_{};
};

/// Requests: rows that had to be computed alone and chunks that were done since the last one, and
/// whether the rank goes. Answers: a range, or −1.
constexpr std::int64_t no_more = -1;
constexpr unsigned count_bits = 8;

struct Request {
  std::uint64_t alone{}, done{};
  bool goes{};
  [[nodiscard]] std::int64_t packed() const {
    return static_cast<std::int64_t>((alone << count_bits | done) << 1U | (goes ? 1U : 0U));
  }
  static Request unpacked(std::int64_t request) {
    const auto bits = static_cast<std::uint64_t>(request);
    return {bits >> (count_bits + 1), bits >> 1U & ((1U << count_bits) - 1), (bits & 1U) != 0};
  }
};

std::int64_t packed(const std::optional<Range>& range) {
  return range ? static_cast<std::int64_t>(range->first << count_bits | range->count) : no_more;
}

std::optional<Range> unpacked(std::int64_t answer) {
  if (answer == no_more) return {};
  const auto bits = static_cast<std::uint64_t>(answer);
  return Range{bits >> count_bits, bits & ((1U << count_bits) - 1)};
}

/// Rank 0's side: a thread answers the others while this one computes as well.
class Server {
 public:
  Server(Team& team, Dispenser dispenser, std::uint64_t chunks_before)
      : team_(team), dispenser_(std::move(dispenser)), done_(chunks_before) {
    if (team.size() > 1) thread_ = std::async(std::launch::async, [this] { serve(); });
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  /// Where rank 0 fails the others are sent away, so that they end.
  ~Server() { stop(); }

  std::optional<Range> ask(std::uint64_t done) {
    const std::lock_guard lock(mutex_);
    done_ += done;
    return dispenser_.next();
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    dispenser_.stop();
  }
  /// Until all other ranks have gone.
  void wait() {
    if (thread_.valid()) thread_.get();
  }
  [[nodiscard]] std::uint64_t done() {
    const std::lock_guard lock(mutex_);
    return done_;
  }
  /// After wait().
  [[nodiscard]] std::uint64_t handed_out() const { return handed_out_; }
  [[nodiscard]] double serving() const { return serving_; }
  /// Of other ranks.
  [[nodiscard]] std::uint64_t alone() const { return alone_; }

 private:
  void serve() {
    constexpr auto pause = std::chrono::microseconds(500);
    int there = team_.size() - 1;
    while (there > 0)
      if (!team_.answer([&](std::int64_t request) { return reply(request, there); }))
        std::this_thread::sleep_for(pause);
    timespec spent{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
    constexpr double nano = 1e-9;
    serving_ = static_cast<double>(spent.tv_sec) + nano * static_cast<double>(spent.tv_nsec);
  }
  std::int64_t reply(std::int64_t request, int& there) {
    const std::lock_guard lock(mutex_);
    const auto asked = Request::unpacked(request);
    done_ += asked.done;
    alone_ += asked.alone;
    const auto range = asked.goes ? std::nullopt : dispenser_.next();
    if (!range) --there;
    if (range) ++handed_out_;
    return packed(range);
  }

  Team& team_;
  std::mutex mutex_{};
  Dispenser dispenser_;
  std::uint64_t done_, handed_out_{}, alone_{};
  double serving_{};
  std::future<void> thread_{};  // its end waits for the thread
};

/// One rank's work on its ranges.
class Worker {
 public:
  Worker(const Problem& problem, const Plan& plan, const SpoolHead& head, int threads)
      : plan_(plan), head_(head), threads_(threads), evaluators_(problem) {}

  void compute(const Range& range, RankFile& file) {
    chunks_.resize(range.count, std::vector<double>(chunk_rows * head_.width));
    const auto rows_in = [&](std::size_t k) {
      return std::min(chunk_rows, head_.all - (range.first + k) * chunk_rows);
    };
    numerics::parallel_for(range.count, threads_, [&](std::size_t k) {
      auto evaluator = evaluators_.take();
      alone_ += *evaluator->rows(plan_, (range.first + k) * chunk_rows,
                                 std::span(chunks_[k]).first(rows_in(k) * head_.width));
      evaluators_.give(std::move(evaluator));
    });
    for (std::size_t k = 0; k < range.count; ++k)
      file.add(range.first + k, std::span(chunks_[k]).first(rows_in(k) * head_.width));
  }
  [[nodiscard]] std::uint64_t alone() const { return alone_; }

 private:
  const Plan& plan_;
  SpoolHead head_;
  int threads_;
  Evaluators evaluators_;
  std::atomic<std::uint64_t> alone_{0};
  std::vector<std::vector<double>> chunks_{};
};

/// What a rank other than 0 does.
void follow(Team& team, Worker& worker, const std::string& path, const SpoolHead& head, bool resume,
            const numerics::Progress& progress) {
  Request since{};
  std::uint64_t alone = 0;
  const auto say = [&](bool goes) {
    since.alone = worker.alone() - std::exchange(alone, worker.alone());
    since.goes = goes;
    return team.ask(std::exchange(since, {}).packed());
  };
  try {
    RankFile file(path, head, resume);
    while (const auto range = unpacked(say(false))) {
      worker.compute(*range, file);
      since.done = range->count;
      if (progress && progress(0.0)) {
        say(true);
        return;
      }
    }
  } catch (...) {
    say(true);
    throw;
  }
}

}  // namespace

std::vector<std::string> rank_files(const std::string& spool) {
  const fs::path path(spool);
  const std::string begin = path.filename().string() + ".";
  std::vector<std::pair<int, std::string>> found;
  std::error_code none;
  for (const auto& entry :
       fs::directory_iterator(path.has_parent_path() ? path.parent_path() : ".", none)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin)) continue;
    int rank = -1;
    const char* from = name.data() + begin.size();
    const auto [end, error] = std::from_chars(from, name.data() + name.size(), rank);
    if (error != std::errc{} || end != name.data() + name.size() || rank < 0) continue;
    const std::string file = file_of_rank(spool, rank);
    if (file.ends_with(name) && head_in(file)) found.emplace_back(rank, file);
  }
  std::ranges::sort(found);
  std::vector<std::string> files;
  for (auto& [rank, file] : found) files.push_back(std::move(file));
  return files;
}

RunResult run_as_team(Team& team, const Problem& problem, const Plan& plan,
                      const RunOptions& options, const numerics::Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  const std::uint64_t all = rows_of(plan, problem.inputs.size());
  const std::uint64_t chunks = (all + chunk_rows - 1) / chunk_rows;
  const SpoolHead head{.magic = rank_magic,
                       .fingerprint = fingerprint(problem, plan, options.fingerprint),
                       .width = problem.inputs.size() + problem.outputs.size(),
                       .all = all,
                       .count = all};
  RunResult result{.count = all};
  Worker worker(problem, plan, head, options.threads);
  const std::string path = file_of_rank(options.spool, team.rank());
  if (team.rank() > 0) {
    if (team.least(1) == 0) return result;  // rank 0 has said why
    follow(team, worker, path, head, options.resume, progress);
    return result;
  }
  Dispenser dispenser(chunks, team.size());
  std::uint64_t before = 0;
  try {
    const auto files = rank_files(options.spool);
    for (const auto& file : files)
      const RowsFile free(file, head.magic, options.resume, options.replace);
    if (options.resume)
      before = dispenser.take_files(files, head);
    else
      for (const auto& file : files) fs::remove(file);
  } catch (...) {
    team.least(0);
    throw;
  }
  team.least(1);
  Server server(team, std::move(dispenser), before);
  const auto rows_of_chunks = [&](std::uint64_t count) {
    return std::min(all, count * chunk_rows);
  };
  result.resumed = rows_of_chunks(before);
  std::uint64_t done = 0;
  RankFile file(path, head, options.resume);
  result.held = file.held();
  while (const auto range = server.ask(std::exchange(done, 0))) {
    worker.compute(*range, file);
    done = range->count;
    const double share = static_cast<double>(server.done() + done) / static_cast<double>(chunks);
    if (progress && progress(share)) server.stop();
  }
  server.wait();
  result.done = rows_of_chunks(server.done());
  result.alone = worker.alone() + server.alone();
  result.handed_out = server.handed_out();
  result.serving = server.serving();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

}  // namespace hydrapod::study
