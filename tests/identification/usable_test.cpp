// Responses with lines and channels that hold nothing to identify modes from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "exact/modal_system.hpp"
#include "found_pole.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Three modes between 3 Hz and 12 Hz, two inputs, three outputs, lines from 0 Hz on.
test::ModalSystem system_of_three() {
  return pushed_at_first({test::real_mode(3.37, 0.021, Eigen::Vector3d(0.71, -0.33, 0.52)),
                          test::real_mode(5.91, 0.013, Eigen::Vector3d(0.28, 0.64, -0.47)),
                          test::real_mode(11.83, 0.034, Eigen::Vector3d(-0.39, 0.57, 0.83))},
                         2);
}

FrequencyResponses from_zero(bool errors, std::uint64_t seed = 1) {
  const auto system = system_of_three();
  test::Random random(seed);
  FrequencyResponses r;
  const auto header = test::header_of(2, 3, 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + 2);
  r.outputs.assign(header.channels.begin() + 2, header.channels.end());
  constexpr double deviation = 3e-6, spacing = 0.0417;  // the largest response is about 0.01
  for (int k = 0; k < 380; ++k) {
    r.frequency.push_back(k * spacing);
    r.H.push_back(system.response(k * spacing));
    for (auto& h : r.H.back().reshaped())
      h += deviation * std::sqrt(0.5) *
           std::complex<double>(test::normal(random), test::normal(random));
    if (k == 0) r.H.back() = r.H.back().real().cast<std::complex<double>>();
    if (!errors) continue;
    r.noise.emplace_back(deviation * deviation * Eigen::Matrix3cd::Identity());
    r.input_factor.emplace_back(Eigen::Matrix2cd::Identity());
  }
  return r;
}

void expect_three_modes(const Identification& found, std::size_t outputs = 3) {
  const auto system = system_of_three();
  ASSERT_EQ(found.modes.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    const auto& fit = found.modes[r].fit;
    const TruePole pole(system.modes[r].pole);
    EXPECT_TRUE(std::isfinite(fit.omega_deviation) && fit.omega_deviation > 0.0);
    EXPECT_TRUE(std::isfinite(fit.damping_deviation) && fit.damping_deviation > 0.0);
    expect_within_deviations(fit, pole);
    EXPECT_LT(fit.omega_deviation, 1e-3 * pole.omega);
    EXPECT_EQ(static_cast<std::size_t>(fit.shape.size()), outputs);
    EXPECT_TRUE(fit.shape.allFinite() && found.modes[r].displacement.allFinite());
    EXPECT_TRUE(fit.shape_deviation.allFinite());
    EXPECT_TRUE(std::isfinite(found.modes[r].quality()));
  }
}

std::vector<Kind> kinds(const Identification& found) {
  std::vector<Kind> list;
  for (const auto& warning : found.responses.warnings) list.push_back(warning.kind);
  return list;
}

class UsableResponses : public testing::TestWithParam<bool> {};

TEST_P(UsableResponses, ALineAtZeroIsLeftOut) {
  const auto found = identify_modes(from_zero(GetParam()));
  expect_three_modes(found);
  EXPECT_GT(found.from, 0.0);
  EXPECT_THAT(kinds(found), testing::IsEmpty());
}

TEST_P(UsableResponses, AnAskedBandMayBeginAtZero) {
  expect_three_modes(identify_modes(from_zero(GetParam()), {.from = 0.0, .to = 15.0}));
}

TEST_P(UsableResponses, LinesThatAreNotFiniteAreLeftOutAndCounted) {
  auto r = from_zero(GetParam());
  r.H[17](1, 0) = nan;
  r.H[141](2, 1) = {0.0, std::numeric_limits<double>::infinity()};
  r.H[300](0, 1) = {0.0, nan};
  const auto found = identify_modes(r);
  expect_three_modes(found);
  ASSERT_THAT(kinds(found), testing::ElementsAre(Kind::lines_not_finite));
  EXPECT_EQ(found.responses.warnings[0].count, 3);
  EXPECT_EQ(found.responses.warnings[0].total, 380);
}

/// As analysers write outside of their band, and where the coherence is low.
TEST_P(UsableResponses, LinesThatAreZeroAreLeftOutAndCounted) {
  auto r = from_zero(GetParam());
  for (std::size_t k = 0; k < r.lines(); ++k) {
    if (r.frequency[k] < 1.5 || r.frequency[k] > 14.0) r.H[k].setZero();
    if (r.frequency[k] > 8.0 && r.frequency[k] < 9.0) r.H[k](1, 0) = 0.0;  // an antiresonance
  }
  const auto found = identify_modes(r);
  expect_three_modes(found);
  EXPECT_GE(found.from, 1.5);
  EXPECT_LE(found.to, 14.0);
  ASSERT_THAT(kinds(found), testing::ElementsAre(Kind::lines_zero));
  const auto& warning = found.responses.warnings[0];
  // 1 … 35 (36 is at 1.501 Hz), 192 … 215, 336 … 379
  EXPECT_EQ(warning.count, 35 + 24 + 44);
  EXPECT_EQ(warning.total, 380);
  EXPECT_EQ(warning.channel, "y2");
  EXPECT_EQ(warning.other, "u1");
}

/// All lines of a transform, up to one spacing below the sample rate or up to it.
TEST_P(UsableResponses, ConjugatesAboveHalfTheSampleRateAreLeftOut) {
  for (const bool to_the_rate : {false, true}) {
    auto r = from_zero(GetParam());
    const std::size_t half = r.lines() - 1;
    const double spacing = r.frequency[1];
    for (std::size_t k = half - 1; k + 1 > (to_the_rate ? 0 : 1); --k) {
      r.frequency.push_back(static_cast<double>(2 * half - k) * spacing);
      r.H.push_back(Eigen::MatrixXcd(std::as_const(r.H)[k].conjugate()));
      if (!GetParam()) continue;
      r.noise.push_back(Eigen::MatrixXcd(std::as_const(r.noise)[k]));
      r.input_factor.push_back(Eigen::MatrixXcd(std::as_const(r.input_factor)[k]));
    }
    const auto found = identify_modes(r);
    expect_three_modes(found);
    ASSERT_THAT(kinds(found), testing::ElementsAre(Kind::two_sided));
    EXPECT_NEAR(found.responses.warnings[0].value, 379 * spacing, 1e-9);
    EXPECT_EQ(found.responses.warnings[0].count, to_the_rate ? 379 : 378);
  }
}

/// In a table of few digits small responses are 0.
TEST_P(UsableResponses, WhatIsRoundedToZeroIsNoReasonToLeaveLinesOut) {
  for (const double step : {1e-4, 5e-4}) {  // the largest is 0.027
    auto r = from_zero(GetParam());
    int zeros = 0;
    for (auto& H : r.H)
      for (auto& h : H.reshaped()) {
        h = step * std::complex<double>(std::round(h.real() / step), std::round(h.imag() / step));
        zeros += h == 0.0 ? 1 : 0;
      }
    EXPECT_GT(zeros, 20);
    EXPECT_EQ(usable_responses(r).lines(), 379U) << step;
  }
}

TEST_P(UsableResponses, AResponseThatIsZeroEverywhereIsNoReasonToLeaveLinesOut) {
  auto r = from_zero(GetParam());
  for (auto& H : r.H) H(1, 0) = 0.0;
  EXPECT_THAT(kinds(identify_modes(r)), testing::IsEmpty());
}

/// As targets of a fit of parameters they are no measurements either.
TEST_P(UsableResponses, AreGivenToOthers) {
  auto r = from_zero(GetParam());
  EXPECT_EQ(usable_responses(r).lines(), 379U);  // not at 0 Hz
  for (std::size_t k = 100; k < 120; ++k) r.H[k](0, 1) = 0.0;
  const auto usable = usable_responses(r);
  EXPECT_EQ(usable.lines(), 359U);
  EXPECT_EQ(usable.noise.size(), GetParam() ? 359U : 0U);
  ASSERT_EQ(usable.warnings.size(), 1U);
  EXPECT_EQ(usable.warnings[0].kind, Kind::lines_zero);
}

TEST_P(UsableResponses, TooFewLinesThatAreNotZeroAreSaid) {
  auto r = from_zero(GetParam());
  for (std::size_t k = 10; k < r.lines(); ++k) r.H[k](2, 1) = 0.0;
  try {
    identify_modes(r);
    FAIL() << "not refused";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("at all but 9 of 380 frequencies (that of y3 to "
                                                 "u2 at 370); at least 16 are needed"));
  }
}

TEST_P(UsableResponses, ADeadOutputIsLeftOutAndNamed) {
  auto r = from_zero(GetParam());
  for (auto& H : r.H) H.row(1).setZero();
  const auto found = identify_modes(r);
  expect_three_modes(found, 2);
  ASSERT_THAT(kinds(found), testing::ElementsAre(Kind::dead_output));
  EXPECT_EQ(found.responses.warnings[0].channel, "y2");
  EXPECT_EQ(cross_check(found, r).size(), 3U);
}

TEST_P(UsableResponses, ADeadInputIsLeftOutAndNamed) {
  auto r = from_zero(GetParam());
  for (auto& H : r.H) H.col(0).setZero();
  const auto found = identify_modes(r);
  expect_three_modes(found);
  ASSERT_THAT(kinds(found), testing::ElementsAre(Kind::dead_input));
  EXPECT_EQ(found.responses.warnings[0].channel, "u1");
}

TEST_P(UsableResponses, ADeadOutputAndADeadInputAreLeftOutTogether) {
  auto r = from_zero(GetParam());
  for (auto& H : r.H) {
    H.row(2).setZero();
    H.col(1).setZero();
  }
  const auto found = identify_modes(r);
  expect_three_modes(found, 2);
  ASSERT_THAT(kinds(found), testing::ElementsAre(Kind::dead_output, Kind::dead_input));
  EXPECT_EQ(found.responses.warnings[0].channel, "y3");
  EXPECT_EQ(found.responses.warnings[1].channel, "u2");
}

TEST_P(UsableResponses, NothingButZerosIsSaid) {
  auto r = from_zero(GetParam());
  for (auto& H : r.H) H.setZero();
  EXPECT_THROW(identify_modes(r), base::ComputationError);
  for (auto& H : r.H) H.setConstant(nan);
  EXPECT_THROW(identify_modes(r), base::ComputationError);
}

TEST_P(UsableResponses, SizesThatNoUnitGivesAreRefused) {
  for (const double factor : {1e150, 1e-150}) {
    auto r = from_zero(GetParam());
    for (auto& H : r.H) H *= factor;
    EXPECT_THROW(identify_modes(r), base::ComputationError);
  }
}

/// Without errors and with responses that no noise makes rough, or that a few modes cannot explain.
TEST_P(UsableResponses, WhateverIsThereNoNumberIsNotFinite) {
  const auto system = system_of_three();
  for (int trial = 0; trial < 6; ++trial) {
    auto r = from_zero(GetParam());
    for (std::size_t k = 0; k < r.lines(); ++k) {
      auto& H = r.H[k];
      if (trial == 0) H.setConstant(1.0);                                             // a gain
      if (trial == 1) H.setConstant(std::polar(1.0, -0.3 * static_cast<double>(k)));  // a delay
      if (trial == 2) H = system.response(r.frequency[k]);                            // no noise
      if (trial == 3) H *= 1e40;
      if (trial == 4) H *= 1e-40;
      if (trial == 5 && k % 2 == 0) H.setZero();
      if (!r.noise.empty() && (trial == 3 || trial == 4)) r.noise[k] *= trial == 3 ? 1e80 : 1e-80;
    }
    SCOPED_TRACE(trial);
    const auto found = identify_modes(r);
    for (const auto& mode : found.modes) {
      EXPECT_TRUE(std::isfinite(mode.fit.omega_deviation));
      EXPECT_TRUE(std::isfinite(mode.fit.damping_deviation));
      EXPECT_TRUE(mode.fit.shape.allFinite() && mode.fit.shape_deviation.allFinite());
      EXPECT_TRUE(std::isfinite(mode.quality()));
    }
    EXPECT_TRUE(std::isfinite(found.model.error) && std::isfinite(found.model.misfit));
    if (trial == 2 || trial == 3 || trial == 4) EXPECT_EQ(found.modes.size(), 3U);
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutErrors, UsableResponses, testing::Bool(),
                         [](const auto& errors) { return errors.param ? "Given" : "Assumed"; });

}  // namespace
}  // namespace hydrapod::identification
