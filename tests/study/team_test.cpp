/// Studies by several ranks, here threads of one program, against a study by one.

#include <gtest/gtest.h>

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <random>
#include <thread>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"
#include "support/run_program.hpp"

namespace hydrapod::study {
namespace {

namespace fs = std::filesystem;

/// What ranks say to each other.
struct Exchange {
  explicit Exchange(int ranks) : size(ranks), answers(ranks) {}
  const int size;
  std::mutex mutex{};
  std::condition_variable changed{};
  std::deque<std::pair<int, std::int64_t>> requests{};
  std::vector<std::deque<std::int64_t>> answers;
  int arrived{}, round{};
  std::int64_t least{INT64_MAX}, result{};
};

class Rank : public Team {
 public:
  Rank(Exchange& exchange, int rank) : exchange_(exchange), rank_(rank) {}
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return exchange_.size; }
  std::int64_t least(std::int64_t value) override {
    std::unique_lock lock(exchange_.mutex);
    exchange_.least = std::min(exchange_.least, value);
    const int round = exchange_.round;
    if (++exchange_.arrived == exchange_.size) {
      exchange_.result = std::exchange(exchange_.least, INT64_MAX);
      exchange_.arrived = 0;
      ++exchange_.round;
      exchange_.changed.notify_all();
    }
    exchange_.changed.wait(lock, [&] { return exchange_.round != round; });
    return exchange_.result;
  }
  std::int64_t ask(std::int64_t request) override {
    std::unique_lock lock(exchange_.mutex);
    exchange_.requests.emplace_back(rank_, request);
    auto& mine = exchange_.answers[static_cast<std::size_t>(rank_)];
    exchange_.changed.wait(lock, [&] { return !mine.empty(); });
    const auto answer = mine.front();
    mine.pop_front();
    return answer;
  }
  bool answer(const std::function<std::int64_t(std::int64_t)>& reply) override {
    const std::lock_guard lock(exchange_.mutex);
    if (exchange_.requests.empty()) return false;
    const auto [from, request] = exchange_.requests.front();
    exchange_.requests.pop_front();
    exchange_.answers[static_cast<std::size_t>(from)].push_back(reply(request));
    exchange_.changed.notify_all();
    return true;
  }

 private:
  Exchange& exchange_;
  int rank_;
};

/// f(x) that is different for each row; `fails`: throws there.
Problem problem_of(double fails = -1.0) {
  Problem problem;
  for (const char* name : {"a", "b"})
    problem.inputs.push_back(
        {.name = name, .distribution = {.shape = Shape::uniform, .a = 0.0, .b = 1.0}});
  problem.outputs = {{"sum", "1", ""}, {"product", "1", ""}};
  problem.model = [fails]() -> Model {
    return [fails](std::span<const double> x, std::span<double> y) {
      if (x[0] < fails) throw base::ComputationError("the disk is full");
      y[0] = x[0] + x[1];
      y[1] = x[0] * x[1];
    };
  };
  return problem;
}

constexpr Plan plan{.samples = 23'417, .seed = 5};

RunResult run_ranks(int ranks, const RunOptions& options, const Problem& problem,
                    int* failures = nullptr) {
  Exchange exchange(ranks);
  RunResult first;
  std::atomic<int> failed{0};
  {
    std::vector<std::jthread> threads;
    for (int rank = 0; rank < ranks; ++rank)
      threads.emplace_back([&, rank] {
        Rank team(exchange, rank);
        try {
          const auto result = run_as_team(team, problem, plan, options);
          if (rank == 0) first = result;
        } catch (const base::ComputationError&) {
          ++failed;
        } catch (const base::InputError&) {
          ++failed;
        }
      });
  }
  if (failures != nullptr)
    *failures = failed;
  else
    EXPECT_EQ(failed, 0);
  return first;
}

std::vector<double> rows_in(const std::vector<std::string>& files) {
  std::vector<double> all;
  Spool(files).each_chunk([&](std::uint64_t, std::span<const double> rows) {
    all.insert(all.end(), rows.begin(), rows.end());
  });
  return all;
}

struct Runs : testing::Test {
  test::TemporaryFolder folder{};
  std::string alone = (folder / "alone").string(), team = (folder / "team").string();
  std::vector<double> expected{};
  void SetUp() override {
    ASSERT_TRUE(run(problem_of(), plan, {.spool = alone}).complete());
    expected = rows_in({alone});
    ASSERT_EQ(expected.size(), 4 * plan.samples);
  }
};

TEST_F(Runs, ByRanksHaveTheRowsOfARunAlone) {
  for (const int ranks : {1, 2, 5}) {
    const auto result = run_ranks(ranks, {.spool = team, .threads = 1}, problem_of());
    EXPECT_TRUE(result.complete());
    EXPECT_EQ(result.resumed, 0U);
    EXPECT_EQ(rank_files(team).size(), static_cast<std::size_t>(ranks));
    EXPECT_EQ(rows_in(rank_files(team)), expected);
    const Spool spool(rank_files(team));
    for (const std::uint64_t row : {0UL, 63UL, 64UL, 12'345UL, plan.samples - 1})
      EXPECT_EQ(spool.row(row)[3], expected[4 * row + 3]);
  }
}

/// What a kill leaves: files that end anywhere, also in their heads, or are not there. Then another
/// number of ranks goes on.
TEST_F(Runs, GoOnFromWhateverWasLeft) {
  std::mt19937_64 random(71);
  for (int kill = 0; kill < 20; ++kill) {
    run_ranks(4, {.spool = team, .threads = 1}, problem_of());
    for (const auto& file : rank_files(team)) {
      const auto size = fs::file_size(file);
      std::uniform_int_distribution<std::uintmax_t> length(0, size);
      switch (random() % 4) {
        case 0:
          fs::remove(file);
          break;
        case 1:
          fs::resize_file(file, length(random) % 60);
          break;
        case 2:
          fs::resize_file(file, length(random));
          break;
        default:
          break;
      }
    }
    const int ranks = 1 + static_cast<int>(random() % 6);
    const auto result =
        run_ranks(ranks, {.spool = team, .resume = true, .threads = 1}, problem_of());
    EXPECT_TRUE(result.complete());
    EXPECT_EQ(rows_in(rank_files(team)), expected) << "kill " << kill;
  }
}

TEST_F(Runs, OfAnotherStudyAreNotGoneOnWith) {
  run_ranks(2, {.spool = team, .threads = 1}, problem_of());
  int failures = 0;
  run_ranks(2, {.spool = team, .resume = true, .threads = 1, .fingerprint = "other"}, problem_of(),
            &failures);
  EXPECT_EQ(failures, 1) << "rank 0 alone says why";
  EXPECT_EQ(rows_in(rank_files(team)), expected);
}

/// A rank whose computation fails says so; the others end, and the study can be gone on with.
TEST_F(Runs, EndWhenARankFails) {
  int failures = 0;
  constexpr double one_row_in_some_thousand = 2e-4;
  const auto cut =
      run_ranks(3, {.spool = team, .threads = 1}, problem_of(one_row_in_some_thousand), &failures);
  EXPECT_GE(failures, 1);
  EXPECT_FALSE(cut.complete() && failures == 0);
  const auto result = run_ranks(3, {.spool = team, .resume = true, .threads = 1}, problem_of());
  EXPECT_TRUE(result.complete());
  EXPECT_EQ(rows_in(rank_files(team)), expected);
}

TEST_F(Runs, LeaveOtherFilesAlone) {
  test::write_text(team + ".7", "a letter");
  test::write_text(team + ".notes", "another");
  run_ranks(2, {.spool = team, .threads = 1}, problem_of());
  EXPECT_EQ(test::read_text(team + ".7"), "a letter");
  EXPECT_EQ(test::read_text(team + ".notes"), "another");
}

}  // namespace
}  // namespace hydrapod::study
