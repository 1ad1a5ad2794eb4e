/// What a χ² says of a hypothesis, in closed forms.

#include "hydrapod/diagnosis/diagnose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
