/// Many modes, few references, many outputs: a few seeds of foreign_many_modes_long_test.cpp, and
/// what is said where modes are missing.

#include <gtest/gtest.h>

#include "many_modes.hpp"

namespace hydrapod::identification {
namespace {

TEST(Foreign, TwelveModesFromOneReferenceWithoutVariances) {
  const auto score = score_of_many({}, 1);
  EXPECT_EQ(score.ours.found, 12);
  EXPECT_EQ(score.ours.false_modes, 0);
  EXPECT_EQ(score.unexplained, 0);
  EXPECT_LT(score.ours.largest_frequency_error(), 5e-4);
  EXPECT_LT(score.ours.largest_damping_error(), 0.1);
}

/// Without known errors the misfit is one as well: what is rough along frequency is the noise.
TEST(Foreign, RoughnessIsTheNoise) {
  const ManyModes made{.modes = 7, .outputs = 5, .references = 2};
  test::Random random(41);
  const auto system = random_system(made, random);
  const auto found = identify_modes(responses_of_many(system, made, random));
  EXPECT_TRUE(found.errors_assumed);
  EXPECT_FALSE(found.responses.has_errors());
  EXPECT_EQ(found.modes.size(), 7U);
  EXPECT_NEAR(found.model.misfit, 1.0, 0.12);
  EXPECT_TRUE(found.unexplained.empty());
}

/// A search that is made to miss most modes says so, and does not call the others good.
TEST(Foreign, WhatTheModelMissesIsSaid) {
  const ManyModes made{.known = true};
  test::Random random(43);
  const auto system = random_system(made, random);
  IdentifyOptions options;
  options.orders = {2, 40, 2};
  options.weak.rounds = 0;
  options.trial.rounds = 0;
  auto responses = responses_of_many(system, made, random);
  for (const bool known : {true, false}) {
    if (!known) responses.noise.clear();
    const auto found = identify_modes(responses, options);
    ASSERT_FALSE(found.modes.empty()) << known;
    ASSERT_LT(found.modes.size(), system.modes.size()) << known;
    ASSERT_FALSE(found.unexplained.empty()) << known;
    const auto& worst = found.unexplained.front();
    EXPECT_GT(worst.level, options.residual_test.level);
    const auto warning =
        std::ranges::find(found.warnings, ModeWarning::Kind::unexplained, &ModeWarning::kind);
    ASSERT_NE(warning, found.warnings.end());
    EXPECT_EQ(warning->output,
              found.responses.outputs[static_cast<std::size_t>(worst.output)].name);
    EXPECT_EQ(warning->value, worst.level);
    EXPECT_GT(warning->count, warning->total / 2);
    // where a part of the band is not explained, no mode has the best quality
    for (const auto& mode : found.modes) {
      const double f = mode.fit.omega() / (2.0 * std::numbers::pi);
      if (std::ranges::any_of(found.unexplained, [&](const Unexplained& part) {
            return f >= part.from && f <= part.to;
          }))
        EXPECT_LT(mode.quality(), 0.61) << f;
    }
  }
}

}  // namespace
}  // namespace hydrapod::identification
