/// Estimates of studies against closed forms, and what their intervals promise.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"
#include "study/order_statistics.hpp"

namespace hydrapod::study {
namespace {

namespace fs = std::filesystem;

/// A spool that goes with its test.
struct Rows {
  std::string path =
      (fs::temp_directory_path() /
       ("hydrapod-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
        ".rows"))
          .string();
  ~Rows() { fs::remove(path); }
};

Problem problem_of(std::vector<Distribution> distributions, Model model, int outputs = 1) {
  Problem problem{.model = [model] { return model; }};
  for (std::size_t k = 0; k < distributions.size(); ++k)
    problem.inputs.push_back(
        {.name = "x" + std::to_string(k), .unit = "1", .distribution = distributions[k]});
  for (int k = 0; k < outputs; ++k) problem.outputs.push_back({"y" + std::to_string(k), "1", ""});
  return problem;
}

Summary studied(const Problem& problem, const Plan& plan,
                const std::vector<Requirement>& requirements = {}) {
  const Rows rows;
  run(problem, plan, {.spool = rows.path, .threads = 1});
  return summarise(Spool({rows.path}), problem, plan, requirements);
}

/// y = 2 x_0 − 3 x_1 of normal numbers is normal, with mean and variance in closed form.
const Distribution first{.shape = Shape::normal, .a = 1.3, .b = 0.7};
const Distribution second{.shape = Shape::normal, .a = -0.4, .b = 0.25};
const double linear_mean = 2.0 * 1.3 + 3.0 * 0.4;
const double linear_deviation = std::hypot(2.0 * 0.7, 3.0 * 0.25);

Problem linear_problem() {
  return problem_of({first, second}, [](std::span<const double> x, std::span<double> y) {
    y[0] = 2.0 * x[0] - 3.0 * x[1];
  });
}

/// Of 200 seeds, how many intervals hold the truth: at least 95 % in expectation, so fewer than
/// 178 (3.7 deviations of a binomial variable) has a probability of 1e-4.
constexpr int seeds = 200, fewest = 178;

TEST(LinearStudy, IntervalsCoverTheTruth) {
  const auto problem = linear_problem();
  const double median = linear_mean;
  const double tail_quantile = linear_mean - 1.6448536269514722 * linear_deviation;
  const Requirement wanted{.text = "y",
                           .output = 0,
                           .at_least = true,
                           .bound = linear_mean - 1.2815515655446004 * linear_deviation};
  int mean = 0, middle = 0, lower = 0, missing = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto summary =
        studied(problem, {.samples = 640, .seed = static_cast<std::uint64_t>(seed)}, {wanted});
    const auto& output = summary.outputs.at(0);
    const auto holds = [](const std::optional<Interval>& interval, double value) {
      return interval && interval->low <= value && value <= interval->high ? 1 : 0;
    };
    mean += holds(output.mean_interval, linear_mean);
    lower += holds(output.quantiles.at(1).interval, tail_quantile);
    middle += holds(output.quantiles.at(2).interval, median);
    missing += holds(summary.requirements.at(0).interval, 0.1);
  }
  for (const int hits : {mean, middle, lower, missing}) EXPECT_GE(hits, fewest);
  EXPECT_LT(mean, seeds);  // an interval that always holds it would say nothing
}

TEST(LinearStudy, HasTheExactMeanAndVariance) {
  const Plan plan{.samples = 200000, .seed = 9};
  const auto output = studied(linear_problem(), plan).outputs.at(0);
  const double of_mean = linear_deviation / std::sqrt(2e5);
  EXPECT_NEAR(output.mean, linear_mean, 4.0 * of_mean);
  EXPECT_NEAR(output.deviation, linear_deviation, 4.0 * of_mean / std::sqrt(2.0));
}

/// Order statistics found bit by bit are those of the sorted values.
TEST(Quantiles, AreExactOrderStatistics) {
  const Rows rows;
  const auto problem = linear_problem();
  const Plan plan{.samples = 1237, .seed = 3};
  run(problem, plan, {.spool = rows.path, .threads = 1});
  const Spool spool({rows.path});
  std::vector<double> values;
  spool.each_chunk([&](std::uint64_t, std::span<const double> numbers) {
    for (std::size_t at = 2; at < numbers.size(); at += 3) values.push_back(numbers[at]);
  });
  ASSERT_EQ(values.size(), 1237U);
  std::ranges::sort(values);
  EXPECT_LT(values.front(), 0.0);  // both signs are among them
  const auto output = summarise(spool, problem, plan, {}).outputs.at(0);
  EXPECT_EQ(output.quantiles.at(0).value, values.at(12));   // ⌈0.01 · 1237⌉ = 13
  EXPECT_EQ(output.quantiles.at(2).value, values.at(618));  // ⌈0.5 · 1237⌉ = 619
  EXPECT_EQ(output.least, values.front());
}

/// Where most values are is a guess: they may all lie below, above or on either side of it.
TEST(Quantiles, AreExactWhereverValuesWereExpected) {
  const Rows rows;
  const auto problem = linear_problem();
  run(problem, {.samples = 60000, .seed = 4}, {.spool = rows.path});
  const Spool spool({rows.path});
  std::vector<double> values;
  spool.each_chunk([&](std::uint64_t, std::span<const double> numbers) {
    for (std::size_t at = 2; at < numbers.size(); at += 3) values.push_back(numbers[at]);
  });
  for (const Range range : {Range{}, Range{1e9, 2e9}, Range{-1e-300, -1e-301}, Range{-7e9, -7e9},
                            Range{linear_mean, linear_mean + 1e-7}}) {
    OrderSearch search(std::array{range});
    search.count(0, values);
    const auto found = search.find(spool, 2, {{0, 0}, {0, 17}, {0, 31'337}, {0, 59'999}},
                                   [](std::uint64_t) { return true; });
    auto sorted = values;
    std::ranges::sort(sorted);
    EXPECT_THAT(found, testing::ElementsAre(sorted[0], sorted[17], sorted[31'337], sorted[59'999]))
        << range.least;
  }
}

/// Many equal values, heavy tails, both signs, and more values than are sorted in memory.
TEST(Quantiles, AreExactWhateverTheValuesAre) {
  const Rows rows;
  const Distribution unit{.shape = Shape::uniform, .a = 0.0, .b = 1.0};
  constexpr int outputs = 4;
  const auto problem = problem_of(
      {unit},
      [](std::span<const double> x, std::span<double> y) {
        y[0] = std::floor(6.0 * x[0]);
        y[1] = std::tan(std::numbers::pi * (x[0] - 0.5));
        y[2] = x[0] < 0.9 ? 5.0 + 1e-12 * x[0] : 1e200 * (x[0] - 0.95);
        y[3] = x[0] < 0.5 ? -0.0 : 0.0;
      },
      outputs);
  const Plan plan{.samples = 150000, .seed = 5};
  run(problem, plan, {.spool = rows.path});
  const Spool spool({rows.path});
  std::array<std::vector<double>, outputs> values;
  spool.each_chunk([&](std::uint64_t, std::span<const double> numbers) {
    for (std::size_t at = 0; at < numbers.size(); at += 1 + outputs)
      for (std::size_t k = 0; k < outputs; ++k) values[k].push_back(numbers[at + 1 + k]);
  });
  const auto summary = summarise(spool, problem, plan, {});
  for (std::size_t k = 0; k < outputs; ++k) {
    std::ranges::sort(values[k]);
    for (const auto& quantile : summary.outputs.at(k).quantiles) {
      const auto rank = static_cast<std::size_t>(std::ceil(quantile.probability * 150000.0)) - 1;
      EXPECT_EQ(quantile.value, values[k].at(rank)) << "output " << k;
      ASSERT_TRUE(quantile.interval.has_value());
      EXPECT_TRUE(std::ranges::binary_search(values[k], quantile.interval->low));
      EXPECT_TRUE(std::ranges::binary_search(values[k], quantile.interval->high));
    }
  }
}

/// f = sin x₁ + a sin² x₂ + b x₃⁴ sin x₁ on (−π, π)³ (T. Ishigami & T. Homma, 1990).
TEST(Ishigami, HasItsExactIndices) {
  constexpr double a = 7.0, b = 0.1, pi = std::numbers::pi;
  const Distribution uniform{.shape = Shape::uniform, .a = -pi, .b = pi};
  const auto problem =
      problem_of({uniform, uniform, uniform}, [](std::span<const double> x, std::span<double> y) {
        y[0] = std::sin(x[0]) + a * std::pow(std::sin(x[1]), 2) +
               b * std::pow(x[2], 4) * std::sin(x[0]);
      });
  const double pi4 = std::pow(pi, 4), pi8 = pi4 * pi4;
  const double v1 = 0.5 * std::pow(1.0 + b * pi4 / 5.0, 2), v2 = a * a / 8.0;
  const double v13 = b * b * pi8 * (1.0 / 18.0 - 1.0 / 50.0), v = v1 + v2 + v13;
  const std::array<double, 3> exact_first{v1 / v, v2 / v, 0.0};
  const std::array<double, 3> exact_total{(v1 + v13) / v, v2 / v, v13 / v};
  std::array<int, 3> first_hits{}, total_hits{};
  for (int seed = 1; seed <= seeds; ++seed) {
    const Plan plan{.samples = 1024, .seed = static_cast<std::uint64_t>(seed), .indices = true};
    const auto indices = studied(problem, plan).indices.at(0);
    ASSERT_EQ(indices.used, 1024U);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto holds = [](const Index& index, double value) {
        return index.interval.low <= value && value <= index.interval.high ? 1 : 0;
      };
      first_hits[k] += holds(indices.first.at(k), exact_first[k]);
      total_hits[k] += holds(indices.total.at(k), exact_total[k]);
    }
  }
  // Percentiles of a bootstrap of 256 groups are approximate: 93 % in expectation, 3.7 deviations.
  constexpr int fewest_of_bootstrap = 172;
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GE(first_hits[k], fewest_of_bootstrap) << "S of input " << k;
    EXPECT_GE(total_hits[k], fewest_of_bootstrap) << "T of input " << k;
  }
  const auto precise =
      studied(problem, {.design = Design::sobol, .samples = 1U << 15U, .seed = 1, .indices = true});
  constexpr double error = 4e-3;  // 8.5/√N · 10⁻¹: Sobol points are an order better than √N
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(precise.indices.at(0).first.at(k).value, exact_first[k], error);
    EXPECT_NEAR(precise.indices.at(0).total.at(k).value, exact_total[k], error);
  }
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Rows, AreTheSameWithAnyNumberOfThreads) {
  const auto problem = linear_problem();
  const Plan plan{.samples = 5003, .seed = 41};
  std::string bytes;
  for (const int threads : {1, 2, 5}) {
    const Rows rows;
    run(problem, plan, {.spool = rows.path, .threads = threads});
    if (bytes.empty()) bytes = bytes_of(rows.path);
    EXPECT_EQ(bytes_of(rows.path), bytes) << threads;
  }
}

/// A file cut off anywhere, as a kill leaves it, or with a damaged chunk: what is resumed equals
/// what was never interrupted.
TEST(Rows, ResumeBitForBitWhereverTheyWereCutOff) {
  const Rows rows;
  const auto problem = linear_problem();
  const Plan plan{.samples = 5003, .seed = 41};
  run(problem, plan, {.spool = rows.path, .threads = 1});
  const std::string whole = bytes_of(rows.path);
  std::vector<std::string> remains;
  for (std::size_t k = 0; k < 20; ++k)
    remains.push_back(whole.substr(0, whole.size() * (2 * k + 1) / 40 + 13 * k));
  remains.push_back(whole);
  remains.back()[whole.size() / 2] ^= 1;
  for (const auto& remain : remains) {
    std::ofstream(rows.path, std::ios::binary) << remain;
    const auto result = run(problem, plan, {.spool = rows.path, .resume = true, .threads = 2});
    EXPECT_TRUE(result.complete());
    EXPECT_EQ(bytes_of(rows.path), whole) << remain.size() << " bytes were left";
  }
}

TEST(Rows, OfAnotherStudyAreNotResumed) {
  const Rows rows;
  run(linear_problem(), {.samples = 500, .seed = 41}, {.spool = rows.path, .threads = 1});
  EXPECT_THROW(run(linear_problem(), {.samples = 500, .seed = 42},
                   {.spool = rows.path, .resume = true, .threads = 1}),
               base::InputError);
}

TEST(Rows, OfShardsAreThoseOfTheWhole) {
  const Rows whole;
  const auto problem = linear_problem();
  const Plan plan{.samples = 5003, .seed = 41};
  run(problem, plan, {.spool = whole.path, .threads = 1});
  std::vector<std::string> parts;
  for (int shard = 1; shard <= 3; ++shard) {
    parts.push_back(whole.path + std::to_string(shard));
    run(problem, plan, {.spool = parts.back(), .threads = 1, .shard = shard, .shards = 3});
  }
  const auto all_of = [](const std::vector<std::string>& paths) {
    std::vector<double> all;
    Spool(paths).each_chunk([&](std::uint64_t, std::span<const double> numbers) {
      all.insert(all.end(), numbers.begin(), numbers.end());
    });
    return all;
  };
  EXPECT_EQ(all_of(parts), all_of({whole.path}));
  EXPECT_THROW(Spool({parts[0], parts[2]}), base::InputError);
  for (const auto& part : parts) fs::remove(part);
}

TEST(Rows, ThatWereComputedBeforeAStopStay) {
  const Rows rows;
  const Plan plan{.samples = 20000, .seed = 41};
  const auto result = run(linear_problem(), plan, {.spool = rows.path, .threads = 1},
                          [](double share) { return share > 0.4; });
  EXPECT_FALSE(result.complete());
  EXPECT_GT(result.done, 0U);
  EXPECT_EQ(Spool({rows.path}).rows(), result.done);
}

}  // namespace
}  // namespace hydrapod::study
