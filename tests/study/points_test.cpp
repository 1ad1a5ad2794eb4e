/// Where samples are placed, and the distributions that they follow.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"
#include "study/random_bits.hpp"

namespace hydrapod::study {
namespace {

using testing::HasSubstr;

/// Known answers of Random123 1.14, tests/kat_vectors, philox4x32 with 10 rounds.
TEST(Philox, GivesTheKnownAnswers) {
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(LatinHypercube, HasOneSampleInEachStratum) {
  const Plan plan{.design = Design::latin, .samples = 1013, .seed = 77};
  std::array<std::set<int>, 3> strata;
  std::array<double, 3> u{};
  for (std::uint64_t row = 0; row < plan.samples; ++row) {
    place(plan, row, u);
    for (std::size_t k = 0; k < 3; ++k)
      strata[k].insert(static_cast<int>(u[k] * static_cast<double>(plan.samples)));
  }
  for (const auto& of_input : strata) EXPECT_EQ(of_input.size(), plan.samples);
}

/// Every aligned block of 2^m elements of a Sobol sequence, shifted or not, has one in each of the
/// 2^m equal parts of every axis.
TEST(SobolSequence, IsBalancedInAnyOrderOfItsElements) {
  const Plan plan{.design = Design::sobol, .samples = 512, .seed = 5};
  std::array<std::set<int>, 4> parts;
  std::array<double, 4> u{};
  // The generator of Boost leaves the zeroth element out, so element `row` is number row + 1.
  for (std::uint64_t row = 511; row < 1023; ++row) {
    place(plan, (row * 7 + 3) % 512 + 511, u);
    for (std::size_t k = 0; k < 4; ++k) parts[k].insert(static_cast<int>(u[k] * 512.0));
  }
  for (const auto& part : parts) EXPECT_EQ(part.size(), 512U);
}

TEST(Grid, GoesThroughAllCombinationsTheLastInputFastest) {
  const Plan plan{.design = Design::grid, .samples = 6, .counts = {2, 3}};
  const Distribution first{.shape = Shape::values, .list = {1.0, 2.0}},
      second{.shape = Shape::values, .list = {10.0, 20.0, 30.0}};
  std::vector<double> seen;
  std::array<double, 2> u{};
  for (std::uint64_t row = 0; row < 6; ++row) {
    place(plan, row, u);
    seen.push_back(quantile(first, u[0]) + quantile(second, u[1]));
  }
  EXPECT_THAT(seen, testing::ElementsAre(11.0, 21.0, 31.0, 12.0, 22.0, 32.0));
}

/// Mean and variance of F⁻¹(u) by the midpoint rule, against closed forms.
struct Moments {
  double mean, deviation;
};
Moments moments_of(const Distribution& d) {
  constexpr int count = 400000;
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < count; ++k) {
    const double x = quantile(d, (k + 0.5) / count);
    sum += x;
    squares += x * x;
  }
  return {sum / count, std::sqrt(squares / count - std::pow(sum / count, 2))};
}
constexpr double midpoint = 3e-4;  // error of the rule in unbounded tails, relative to σ

TEST(Distributions, HaveTheirMeanAndDeviation) {
  for (const char* text : {"normal 5.3 kN/mm ± 7 %", "lognormal 5.3 kN/mm ± 0.371 kN/mm"}) {
    const auto found = moments_of(read_distribution(text, "N/m", 1.0, ""));
    EXPECT_NEAR(found.mean, 5.3e6, midpoint * 0.371e6) << text;
    EXPECT_NEAR(found.deviation, 0.371e6, midpoint * 0.371e6) << text;
  }
  const auto uniform = moments_of(read_distribution("uniform 4.1 .. 6.7 kN/mm", "N/m", 1.0, ""));
  EXPECT_NEAR(uniform.deviation, 2.6e6 / std::sqrt(12.0), midpoint * 1e6);
  const double a = 2.0, c = 3.0, b = 7.0;
  const auto triangular = moments_of(read_distribution("triangular 2 .. 3 .. 7", "1", 1.0, ""));
  EXPECT_NEAR(triangular.mean, (a + b + c) / 3.0, midpoint);
  EXPECT_NEAR(triangular.deviation,
              std::sqrt((a * a + b * b + c * c - a * b - a * c - b * c) / 18.0), midpoint);
}

TEST(Distributions, TakeTheNominalNumberAsTheirMean) {
  const auto d = read_distribution("normal ± 10 %", "N/m", 7.3e6, "");
  EXPECT_DOUBLE_EQ(d.a, 7.3e6);
  EXPECT_DOUBLE_EQ(d.b, 0.73e6);
}

/// Truncated at ± σ: variance 1 − 2 φ(1) / (2 Φ(1) − 1).
TEST(Distributions, AreTruncated) {
  const auto found = moments_of(read_distribution("normal 0 ± 1 within -1 .. 1", "1", 0.0, ""));
  EXPECT_NEAR(found.mean, 0.0, midpoint);
  EXPECT_NEAR(found.deviation, std::sqrt(1.0 - 2.0 * 0.24197072451914337 / 0.6826894921370859),
              midpoint);
}

std::string message_for(const char* text) {
  try {
    read_distribution(text, "N/m", 1e6, "--vary");
  } catch (const base::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Distributions, ThatCannotBeAreRefused) {
  EXPECT_THAT(message_for("normal 5 kN/mm ± 0 %"), HasSubstr("must be more than 0"));
  EXPECT_THAT(message_for("normal 5 kN/mm"), HasSubstr("no spread"));
  EXPECT_THAT(message_for("uniform 6 .. 4 kN/mm"), HasSubstr("needs spread"));
  EXPECT_THAT(message_for("norml 5 kN/mm ± 3 %"), HasSubstr("did you mean 'normal'"));
  EXPECT_THAT(message_for("normal 5 kg ± 3 %"), HasSubstr("5 kg"));
  EXPECT_THAT(message_for("normal 5 kN/mm ± 1 % within 90 .. 95 kN/mm"), HasSubstr("hardly any"));
}

}  // namespace
}  // namespace hydrapod::study
