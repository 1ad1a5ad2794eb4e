/// Correlated inputs against closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "hydrapod/base/error.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/tasks/study.hpp"
#include "support/run_program.hpp"

namespace hydrapod::study {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t samples = 20000;

/// Columns of the inputs of a study without outputs.
std::vector<std::vector<double>> drawn(std::vector<Distribution> distributions,
                                       const Eigen::MatrixXd& correlations, Design design) {
  Problem problem{.model = [] { return [](std::span<const double>, std::span<double>) {}; },
                  .correlation = correlation_factor(correlations, "")};
  for (auto& one : distributions) problem.inputs.push_back({.distribution = std::move(one)});
  const std::size_t width = problem.inputs.size();
  std::vector<double> numbers(samples * width);
  Evaluator(problem).rows({.design = design, .samples = samples, .seed = 41}, 0, numbers);
  std::vector<std::vector<double>> columns(width);
  for (std::size_t k = 0; k < numbers.size(); ++k) columns[k % width].push_back(numbers[k]);
  return columns;
}

double mean(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

double correlation(const std::vector<double>& x, const std::vector<double>& y) {
  const double a = mean(x), b = mean(y);
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - a) * (x[k] - a);
    yy += (y[k] - b) * (y[k] - b);
    xy += (x[k] - a) * (y[k] - b);
  }
  return xy / std::sqrt(xx * yy);
}

std::vector<double> ranks(const std::vector<double>& x) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t k) { return x[k]; });
  std::vector<double> rank(x.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<double>(k);
  return rank;
}

/// Of a sample correlation: (1 − r²)/√N, four of them.
double tolerance(double r) { return 4.0 * (1.0 - r * r) / std::sqrt(double{samples}); }

const Distribution normal{.shape = Shape::normal, .a = 1.3, .b = 0.7};
const Distribution lognormal{.shape = Shape::lognormal, .a = 2.1, .b = 0.9};
const Distribution uniform{.shape = Shape::uniform, .a = -0.4, .b = 1.7};

TEST(Correlation, IsThatStated) {
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  const auto set = [&](int i, int j, double r) { R(i, j) = R(j, i) = r; };
  set(0, 1, 0.63);
  set(0, 2, -0.37);
  set(2, 3, 0.81);
  for (const auto design : {Design::random, Design::sobol, Design::latin}) {
    const auto x = drawn({normal, lognormal, uniform, uniform}, R, design);
    std::vector<double> logarithms;
    for (const double value : x[1]) logarithms.push_back(std::log(value));
    EXPECT_NEAR(correlation(x[0], logarithms), 0.63, tolerance(0.63));
    // Of the ranks, 6/π asin(r/2) (K. Pearson 1907): whatever the distributions are.
    const auto rank = [](double r) { return 6.0 / std::numbers::pi * std::asin(r / 2.0); };
    EXPECT_NEAR(correlation(ranks(x[2]), ranks(x[3])), rank(0.81), tolerance(0.81));
    EXPECT_NEAR(correlation(ranks(x[0]), ranks(x[2])), rank(-0.37), tolerance(0.37));
    EXPECT_NEAR(correlation(x[1], x[3]), 0.0, tolerance(0.0));
    // Each one alone is distributed as without.
    EXPECT_NEAR(mean(x[1]), 2.1, 4.0 * 0.9 / std::sqrt(double{samples}));
    EXPECT_NEAR(mean(x[3]), 0.65, 4.0 * 2.1 / std::sqrt(12.0 * double{samples}));
  }
}

TEST(Correlation, OfOneAndMinusOneIsTheSameNumber) {
  Eigen::Matrix3d R;
  R << 1.0, 1.0, -1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0;
  const auto x = drawn({normal, normal, normal}, R, Design::random);
  for (std::size_t k = 0; k < samples; k += 997) {
    EXPECT_NEAR(x[1][k], x[0][k], 1e-9);
    EXPECT_NEAR(x[2][k] - 1.3, 1.3 - x[0][k], 1e-9);
  }
}

/// Var(2 a − 3 b) = 4 σ_a² + 9 σ_b² − 12 r σ_a σ_b.
TEST(Correlation, GivesTheVarianceOfASum) {
  Eigen::Matrix2d R;
  R << 1.0, -0.72, -0.72, 1.0;
  const Distribution other{.shape = Shape::normal, .a = -0.2, .b = 0.31};
  const auto x = drawn({normal, other}, R, Design::random);
  double squares = 0.0;
  for (std::size_t k = 0; k < samples; ++k)
    squares += std::pow(2.0 * (x[0][k] - 1.3) - 3.0 * (x[1][k] + 0.2), 2);
  const double variance = 4.0 * 0.49 + 9.0 * 0.0961 + 12.0 * 0.72 * 0.7 * 0.31;
  EXPECT_NEAR(squares / double{samples}, variance, 4.0 * variance * std::sqrt(2.0 / samples));
}

TEST(Correlation, ThatNoNumbersCanHaveIsRefused) {
  Eigen::Matrix3d R;
  R << 1.0, 0.9, 0.9, 0.9, 1.0, -0.9, 0.9, -0.9, 1.0;
  EXPECT_THROW(correlation_factor(R, "--correlate"), base::InputError);
  Eigen::Matrix3d same;
  same << 1.0, 1.0, 0.2, 1.0, 1.0, 0.3, 0.2, 0.3, 1.0;
  EXPECT_THROW(correlation_factor(same, "--correlate"), base::InputError);
}

tasks::StudyOptions options_of(const std::vector<std::string>& correlate) {
  tasks::StudyOptions options{
      .vary = {{"legs.guide_sleeve.stiffness", "normal ± 7 % per leg correlated 0.8", "--vary"},
               {"legs.rod.mass", "uniform ± 3 % per leg", "--vary"},
               {"platform.mass", "normal ± 2 %", "--vary"}},
      .plan = {.samples = 4000, .seed = 3}};
  for (const auto& text : correlate) options.correlate.push_back({text, "--correlate"});
  return options;
}

tasks::Machine published() {
  return tasks::read_machine(
      {.file = test::source_file("models/zhang-jiang-2021-transverse.toml").string()});
}

TEST(Correlation, OfLegsIsThatOfTheSameLeg) {
  const auto job = tasks::prepare_study(
      published(), options_of({"legs.guide_sleeve.stiffness, legs.rod.mass = -0.3",
                               "leg.2.rod.mass, platform.mass=0.3"}));
  const Eigen::MatrixXd R = job.problem.correlation * job.problem.correlation.transpose();
  ASSERT_EQ(R.rows(), 13);
  EXPECT_NEAR(R(0, 5), 0.8, 1e-12);
  EXPECT_NEAR(R(3, 9), -0.3, 1e-12);
  EXPECT_NEAR(R(3, 8), 0.0, 1e-12);
  EXPECT_NEAR(R(7, 12), 0.3, 1e-12);
  EXPECT_NEAR(R(6, 12), 0.0, 1e-12);
}

TEST(Correlation, SaysWhatIsWrong) {
  const auto machine = published();
  for (const auto& [text, why] : std::initializer_list<std::pair<const char*, const char*>>{
           {"platform.mass = 0.5", "expected two paths"},
           {"platform.mass, legs.rod.mass = 1.5", "from -1 to 1"},
           {"platform.mass, legs.rod.mass = a lot", "from -1 to 1"},
           {"platform.mass, legs.rod.length = 0.5", "does not vary"},
           {"legs.rod.mass, legs.rod.mass = 0.5", "same number twice"}})
    try {
      tasks::prepare_study(machine, options_of({text}));
      ADD_FAILURE() << text;
    } catch (const base::InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  auto indices = options_of({"platform.mass, leg.1.rod.mass = 0.5"});
  indices.plan.indices = true;
  EXPECT_THROW(tasks::prepare_study(machine, indices), base::InputError);
  auto twice =
      options_of({"platform.mass, leg.1.rod.mass = 0.5", "leg.1.rod.mass, platform.mass = 0.4"});
  EXPECT_THROW(tasks::prepare_study(machine, twice), base::InputError);
}

}  // namespace
}  // namespace hydrapod::study
