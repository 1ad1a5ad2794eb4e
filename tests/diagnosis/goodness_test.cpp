/// What a χ² says of a hypothesis, in closed forms.

#include "hydrapod/diagnosis/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "diagnosis/ranking.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "support/binomial.hpp"

namespace hydrapod::diagnosis {
namespace {

/// With two degrees of freedom χ² is exponential, with four P = (1 + x/2) e^{−x/2}.
TEST(ChiSquared, HasItsProbabilityInClosedForm) {
  for (const double x : {0.37, 2.9, 11.3, 41.0}) {
    EXPECT_NEAR((ChiSquared{x, 5, 2}.probability()), std::exp(-0.5 * x),
                1e-12 * std::exp(-0.5 * x));
    const double four = (1.0 + 0.5 * x) * std::exp(-0.5 * x);
    EXPECT_NEAR((ChiSquared{x, 7, 4}.probability()), four, 1e-12 * four);
  }
  EXPECT_EQ((ChiSquared{3.1, 2, 0}.probability()), 1.0);
  EXPECT_EQ((ChiSquared{std::numeric_limits<double>::infinity(), 7, 4}.probability()), 0.0);
}

/// Two frequencies off by 3 and 4 deviations, one number fitted, five values of shapes and
/// responses of four values.
TEST(Goodness, JudgesKindByKind) {
  Diagnosis d{.values = 2 + 10 + 4};
  d.targets.modes.resize(2);
  d.targets.responses.resize(1);
  d.targets.responses[0].values = 4;
  Hypothesis e{.parameters = 1, .misfit = 25.0 + 7.0 + 1.44};
  e.fit.targets = {{.difference = 3.0}, {.difference = -4.0}};
  e.fit.responses = {{.difference = 1.2}};
  d.hypotheses = {e};
  const auto g = goodness(d, e);
  EXPECT_NEAR(g.frequencies.sum, 25.0, 1e-12);
  EXPECT_EQ(g.frequencies.degrees, 1);
  EXPECT_NEAR(g.shapes.sum, 7.0, 1e-12);
  EXPECT_EQ(g.shapes.degrees, 10);
  EXPECT_NEAR(g.responses.sum, 1.44, 1e-12);
  EXPECT_EQ(g.responses.degrees, 4);
  EXPECT_NEAR(g.reduced, 33.44 / 15.0, 1e-12);
  // one degree of freedom: two tails of the normal distribution beyond 5; three kinds
  EXPECT_NEAR(g.probability, 3.0 * std::erfc(5.0 / std::sqrt(2.0)), 1e-15);
}

/// Eight frequencies of which the nominal machine misses each by `nominal` deviations, and a
/// hypothesis of `causes` causes and `parameters` numbers that misses each by `off`. One of 30
/// candidate causes.
Diagnosis of_eight(double off, int parameters = 1, std::size_t causes = 1, double nominal = 40.0) {
  constexpr int n = 8;
  Diagnosis d{.finding = Finding::unexplained, .values = n};
  d.causes.resize(30);
  d.targets.modes.resize(n);
  d.modes.resize(n);
  const auto add = [&](double difference, Hypothesis e) {
    e.fit.targets.assign(n, {.difference = difference});
    e.fit.parameters.resize(static_cast<std::size_t>(e.parameters));
    e.misfit = n * difference * difference;
    e.bic = e.misfit + e.parameters * std::log(n);
    d.hypotheses.push_back(e);
  };
  Hypothesis hypothesis{.parameters = parameters};
  for (std::size_t k = 0; k < causes; ++k) hypothesis.causes.push_back(k);
  add(off, hypothesis);
  add(nominal, {});
  return d;
}

/// Judgement and words are one: whatever is wrong with the best hypothesis is what the reason says.
void expect_reason(Diagnosis d, Unexplained why, const char* words) {
  const auto found = why_unexplained(d, d.judged());
  ASSERT_EQ(found, why);
  d.unexplained = found;
  EXPECT_THAT(report::reason_words(d).front(), testing::HasSubstr(words));
}

/// The nominal χ² is 12800, so that an unlisted cause has the BIC 8 (1 + ln 1600) + ln 8 = 69.1.
/// χ² 28.9 with 7 degrees of freedom has a probability of 0.015 %, 16.0 of 2.5 %, 14.0 with 6 of
/// 3.0 %.
TEST(Unexplained, HasTheReasonThatTheWordsGive) {
  EXPECT_EQ(why_unexplained(of_eight(0.7), of_eight(0.7).judged()), std::nullopt);
  expect_reason(of_eight(2.7), Unexplained::unlisted, "no better than a change of each mode");
  expect_reason(of_eight(1.9), Unexplained::misfit, "frequencies χ² 28.9 with 7 degrees");
  EXPECT_EQ(why_unexplained(of_eight(1.4142), of_eight(1.4142).judged()), std::nullopt);
  expect_reason(of_eight(1.3229, 2, 2), Unexplained::misfit, "χ² 14 with 6 degrees");
  expect_reason(of_eight(0.7, 7), Unexplained::untested, "fits 7 numbers to 8 frequencies");
  // five numbers of two causes meet five frequencies that have moved one by one; those of one cause
  // are not chosen from hundreds
  for (const std::size_t causes : {1, 2})
    for (const int moved : {6, 5}) {
      auto several = of_eight(0.7, 5, causes);
      ASSERT_TRUE(several.hypotheses[1].causes.empty());
      for (std::size_t k = static_cast<std::size_t>(moved); k < 8; ++k)
        several.hypotheses[1].fit.targets[k].difference = -2.9;
      EXPECT_EQ(moved_frequencies(several), moved);
      if (causes == 1 || moved == 6)
        EXPECT_EQ(why_unexplained(several, several.judged()), std::nullopt) << causes;
      else
        expect_reason(several, Unexplained::untested,
                      "5 numbers, and only 5 frequencies are not those of the nominal machine");
    }
  auto held = of_eight(0.7);
  auto& number = held.hypotheses[0].fit.parameters[0];
  number = {.paths = {"platform.mass"}, .unit = "kg", .verdict = calibration::Verdict::at_bound};
  expect_reason(held, Unexplained::at_bound,
                "a parameter at the bound of its range (platform.mass 0 kg");
  auto scattered = of_eight(0.7);
  scattered.scatter = 2.31;
  expect_reason(scattered, Unexplained::scatter, "differs from the measured values by 2.3 σ");
}

/// No cause is shown, and the nominal machine meets the data: χ² 11.5 with 8 degrees of freedom has
/// a probability of 17 %, 18 of 2.1 %. The hypothesis is better by more than 6 both times, and no
/// better than an unlisted cause, whose BIC is 13.0 and 16.6.
TEST(Judgement, OfAMachineThatNeedsNoCauseNamesNone) {
  auto sound = of_eight(0.5, 1, 1, 1.2);
  ASSERT_TRUE(why_unexplained(sound, sound.judged()));
  judge(sound);
  EXPECT_EQ(sound.finding, Finding::nominal);
  EXPECT_EQ(sound.equivalent, std::vector<std::size_t>{1});
  EXPECT_FALSE(sound.unexplained);
  auto other = of_eight(0.7, 1, 1, 1.5);
  judge(other);
  EXPECT_EQ(other.finding, Finding::unexplained);
  EXPECT_EQ(other.unexplained, Unexplained::unlisted);
}

/// With the frequencies of the nominal machine only shapes are left to be wrong, unless dampings or
/// responses are compared: leakage is in these alone.
TEST(Unexplained, DoubtsTheShapesOnlyWhereNothingElseIsCompared) {
  auto d = of_eight(0.7);
  for (auto& target : d.hypotheses[1].fit.targets) target.difference = 0.9;
  d.hypotheses[1].misfit = 12800.0;
  d.values = 8 * 6;
  expect_reason(d, Unexplained::shapes_only, "check places, signs and directions");
  d.targets.modes[3].damping = 0.031;
  EXPECT_EQ(why_unexplained(d, d.judged()), std::nullopt);
}

/// The best hypothesis has as many numbers as values: the reason is that of the best one which the
/// values could have refuted.
TEST(Unexplained, IsSaidOfTheBestThatValuesCouldRefute) {
  auto d = of_eight(1.9);
  d.hypotheses.insert(d.hypotheses.begin(), {.causes = {7}, .parameters = 8});
  EXPECT_EQ(d.judged().causes, std::vector<std::size_t>{0});
  d.hypotheses.resize(1);
  EXPECT_EQ(d.judged().causes, std::vector<std::size_t>{7});
}

/// s is 1 at least, and what it comes from is not.
TEST(Goodness, TellsAReducedMisfitBelowOne) {
  Diagnosis d{.values = 12};
  Hypothesis e{.parameters = 2, .misfit = 3.1};
  d.hypotheses = {e};
  EXPECT_NEAR(raw_scatter2(d), 0.31, 1e-12);
}

/// At the ends the interval is a power: none of n, upper end 1 − 0.025^(1/n).
TEST(ClopperPearson, IsExactAtTheEnds) {
  for (const int n : {6, 60, 131}) {
    const double end = 1.0 - std::pow(0.025, 1.0 / n);
    EXPECT_EQ(test::clopper_pearson(0, n).first, 0.0);
    EXPECT_NEAR(test::clopper_pearson(0, n).second, end, 1e-12);
    EXPECT_NEAR(test::clopper_pearson(n, n).first, 1.0 - end, 1e-12);
    EXPECT_EQ(test::clopper_pearson(n, n).second, 1.0);
  }
}

}  // namespace
}  // namespace hydrapod::diagnosis
