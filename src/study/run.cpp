#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "run_parts.hpp"

namespace hydrapod::study {

std::uint64_t fingerprint(const Problem& problem, const Plan& plan, const std::string& more) {
  std::string text = fmt::format("{}\n{} {} {} {}", more, static_cast<int>(plan.design),
                                 plan.samples, plan.seed, plan.indices);
  for (const int count : plan.counts) text += fmt::format(" {}", count);
  for (const auto& input : problem.inputs) {
    const auto& d = input.distribution;
    text += fmt::format("\n{} {} {} {} {} {} {}", input.name, static_cast<int>(d.shape), d.a, d.b,
                        d.c, d.low.value_or(0.0), d.high.value_or(0.0));
    for (const double value : d.list) text += fmt::format(" {}", value);
  }
  for (const auto& output : problem.outputs) text += fmt::format("\n{}", output.name);
  for (const double number : problem.correlation.reshaped()) text += fmt::format("\n{}", number);
  if (problem.beneath)
    text += fmt::format("\nworst of {}", fingerprint(*problem.beneath, plan, more));
  return hash_of(text.data(), text.size());
}

namespace {

/// Between two questions whether to stop, where rows take long.
constexpr auto often_enough = std::chrono::milliseconds(100);

/// Appends to the spool, unbuffered: what was written survives the end of the program.
class SpoolWriter {
 public:
  SpoolWriter(const std::string& path, const SpoolHead& head, bool resume, bool replace)
      : path_(path),
        head_(head),
        held_(std::make_shared<RowsFile>(path, head.magic, resume, replace)),
        file_(held_->number()) {
    if (resume) done_ = good_rows();
    if (done_ > 0) return;
    if (::ftruncate(file_, 0) != 0 || ::lseek(file_, 0, SEEK_SET) != 0) fail();
    write(&head_, sizeof head_);
  }
  SpoolWriter(const SpoolWriter&) = delete;
  SpoolWriter& operator=(const SpoolWriter&) = delete;
  ~SpoolWriter() = default;

  [[nodiscard]] std::shared_ptr<void> held() const { return held_; }
  [[nodiscard]] std::uint64_t done() const { return done_; }

  /// A chunk whose last number is room for the checksum.
  void add(std::vector<double>& chunk, std::uint64_t rows) {
    const std::size_t numbers = rows * head_.width;
    const std::uint64_t sum = hash_of(chunk.data(), numbers * sizeof(double));
    std::memcpy(chunk.data() + numbers, &sum, sizeof sum);
    write(chunk.data(), chunk_bytes(rows, head_.width));
    done_ += rows;
  }

 private:
  [[noreturn]] void fail() const {
    throw base::ComputationError(
        fmt::format("{} cannot be written: {}; {} rows are in it (go on with --resume)", path_,
                    std::strerror(errno), done_));
  }

  void write(const void* bytes, std::size_t size) const {
    if (!write_all(file_, bytes, size)) fail();
  }

  /// Rows up to the first chunk that is cut off or damaged; the file ends there then.
  std::uint64_t good_rows() const {
    SpoolHead head;
    const auto got = ::read(file_, &head, sizeof head);
    if (got < static_cast<ssize_t>(sizeof head)) return 0;  // killed before the head was written
    if (std::memcmp(&head, &head_, sizeof head) != 0)
      base::refuse(path_,
                   "holds rows of another study (machine, inputs, outputs, samples, seed or "
                   "program differ); --force without --resume begins anew");
    std::uint64_t done = 0;
    std::vector<double> chunk(chunk_rows * head.width + 1);
    while (done < head.count) {
      const std::uint64_t rows = std::min(chunk_rows, head.count - done);
      const auto bytes = chunk_bytes(rows, head.width);
      if (::read(file_, chunk.data(), bytes) != static_cast<ssize_t>(bytes)) break;
      const std::uint64_t sum = hash_of(chunk.data(), rows * head.width * sizeof(double));
      if (std::memcmp(&sum, chunk.data() + rows * head.width, sizeof sum) != 0) break;
      done += rows;
    }
    const std::uint64_t size =
        sizeof head + (done / chunk_rows) * chunk_bytes(chunk_rows, head.width) +
        (done % chunk_rows > 0 ? chunk_bytes(done % chunk_rows, head.width) : 0);
    if (::ftruncate(file_, static_cast<off_t>(size)) != 0 ||
        ::lseek(file_, static_cast<off_t>(size), SEEK_SET) < 0)
      fail();
    return done;
  }

  std::string path_;
  SpoolHead head_;
  std::shared_ptr<RowsFile> held_;
  int file_;
  std::uint64_t done_{};
};

/// The part of all rows that a shard consists of, in whole chunks.
SpoolHead head_of(const Problem& problem, const Plan& plan, const RunOptions& options) {
  const std::uint64_t all = rows_of(plan, problem.inputs.size());
  const std::uint64_t chunks = (all + chunk_rows - 1) / chunk_rows;
  const auto shards = static_cast<std::uint64_t>(options.shards);
  const auto begin = [&](int shard) {
    const auto before = static_cast<std::uint64_t>(shard);
    return std::min(all,
                    (chunks / shards * before + std::min(before, chunks % shards)) * chunk_rows);
  };
  const std::uint64_t first = begin(options.shard - 1);
  return {.fingerprint = fingerprint(problem, plan, options.fingerprint),
          .width = problem.inputs.size() + problem.outputs.size(),
          .all = all,
          .first = first,
          .count = begin(options.shard) - first};
}

}  // namespace

Evaluator::Evaluator(const Problem& problem) : problem_(problem) {
  if (problem.batch)
    batch_ = problem.batch();
  else
    model_ = problem.model();
}

std::optional<std::size_t> Evaluator::rows(const Plan& plan, std::uint64_t first,
                                           std::span<double> numbers,
                                           const std::function<bool()>& stop) {
  const std::size_t inputs = problem_.inputs.size(), width = inputs + problem_.outputs.size();
  rows_.clear();
  for (std::size_t at = 0; at + width <= numbers.size(); at += width) {
    const auto row = numbers.subspan(at, width);
    const auto x = row.first(inputs);
    place(plan, first++, x);
    if (problem_.correlation.size() > 0) correlate(problem_.correlation, x);
    for (std::size_t i = 0; i < inputs; ++i) x[i] = quantile(problem_.inputs[i].distribution, x[i]);
    rows_.push_back({x, row.subspan(inputs)});
  }
  std::size_t alone = 0;
  for (std::size_t from = 0; from < rows_.size();) {
    const auto some = std::span<const Row>(rows_).subspan(
        from, stop ? std::min(together_, rows_.size() - from) : rows_.size() - from);
    const auto begun = std::chrono::steady_clock::now();
    if (batch_)
      alone += batch_(some);
    else
      for (const auto& row : some) model_(row.inputs, row.outputs);
    from += some.size();
    if (!stop) continue;
    const auto taken = std::chrono::steady_clock::now() - begun;
    if (taken > often_enough && together_ > 1) together_ /= 2;
    if (taken > often_enough / 4 && stop()) return std::nullopt;
  }
  if (stop && problem_.interruption && stop()) return std::nullopt;
  return alone;
}

RunResult run(const Problem& problem, const Plan& plan, const RunOptions& options,
              const numerics::Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  const auto head = head_of(problem, plan, options);
  SpoolWriter spool(options.spool, head, options.resume, options.replace);
  RunResult result{.first = head.first, .count = head.count, .resumed = spool.done()};
  result.held = spool.held();
  constexpr std::size_t most = 32;      // chunks between two writes,
  constexpr double long_enough = 5e-3;  // [s] or as many as take this
  std::vector<std::vector<double>> chunks(most, std::vector<double>(chunk_rows * head.width + 1));
  bool stopped = false;
  std::atomic<std::uint64_t> alone{0};
  Evaluators evaluators(problem);
  numerics::Watch watch(progress);
  const Interruptible interruptible(problem, [&] { return watch.stopped(); });
  std::size_t batch =
      static_cast<std::size_t>(options.threads > 0 ? options.threads : numerics::processor_count());
  while (!stopped && spool.done() < head.count) {
    const std::uint64_t from = spool.done(), left = head.count - from;
    const auto now =
        std::min<std::size_t>(std::min(batch, most), (left + chunk_rows - 1) / chunk_rows);
    std::vector<std::atomic<bool>> ready(now);
    const auto rows_in = [&](std::size_t k) { return std::min(chunk_rows, left - k * chunk_rows); };
    const auto started = std::chrono::steady_clock::now();
    stopped = !numerics::parallel_for(
        now, options.threads,
        [&](std::size_t k) {
          auto evaluator = evaluators.take();
          const auto done = evaluator->rows(plan, head.first + from + k * chunk_rows,
                                            std::span(chunks[k]).first(rows_in(k) * head.width),
                                            interruptible.asked());
          evaluators.give(std::move(evaluator));
          if (!done) return;
          alone += *done;
          ready[k] = true;
        },
        [&](double share) {
          const auto done = static_cast<double>(from) +
                            share * static_cast<double>(std::min(now * chunk_rows, left));
          return watch.at(done / static_cast<double>(head.count));
        });
    for (std::size_t k = 0; k < now && ready[k]; ++k) spool.add(chunks[k], rows_in(k));
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() <
        long_enough)
      batch = std::min(2 * batch, most);
  }
  result.done = spool.done();
  result.alone = alone;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

}  // namespace hydrapod::study
