/// Channels that an amplifier cut off before the recorder added its noise: what is said of them,
/// what becomes of hits, and what is no such channel.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "hammer.hpp"
#include "identification/cut_tops.hpp"
#include "identification/flat_tops.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;
using Eigen::Index;
using Eigen::VectorXd;

std::vector<data::ResponseWarning> warnings_of(const FrequencyResponses& r, Kind kind) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : r.warnings)
    if (warning.kind == kind) found.push_back(warning);
  return found;
}

std::vector<std::string> clipped_of(const FrequencyResponses& r) {
  std::vector<std::string> names;
  for (const auto& warning : warnings_of(r, Kind::clipped)) names.push_back(warning.channel);
  return names;
}

/// Cut off at `limit`, with noise that came later.
template <class Channel>
void saturate(Channel&& x, double limit, double noise, test::Random& random) {
  for (double& value : x) value = std::clamp(value, -limit, limit) + noise * test::normal(random);
}

void saturate_outputs(double share, double noise, test::Random& random, data::Record& record) {
  for (Index c = 1; c < record.samples.cols(); ++c) {
    const double largest = record.samples.col(c).cwiseAbs().maxCoeff();
    saturate(record.samples.col(c), share * largest, noise * largest, random);
  }
}

/// White noise moves the beam.
data::Record shaken(std::uint64_t seed) {
  return test::record_of(beam(), {.sample_rate = hammer_rate,
                                  .samples = 41000,
                                  .output_noise = Eigen::Vector3d(1e-8, 2e-8, 1e-8),
                                  .seed = seed});
}

void expect_beam(const Identification& found) {
  const auto truth = beam();
  ASSERT_EQ(found.modes.size(), truth.modes.size());
  for (std::size_t r = 0; r < truth.modes.size(); ++r) {
    const auto& fit = found.modes[r].fit;
    const auto pole = truth.modes[r].pole;
    EXPECT_LT(std::abs(fit.omega() - std::abs(pole)), 4.0 * fit.omega_deviation) << r;
    EXPECT_LT(std::abs(fit.damping_ratio() + pole.real() / std::abs(pole)),
              4.0 * fit.damping_deviation)
        << r;
  }
}

TEST(Saturated, OutputsOfARandomTestAreSaidAndTheirModesHaveALowQuality) {
  for (const double noise : {0.0, 3e-4, 1e-3}) {
    SCOPED_TRACE(noise);
    test::Random random(711);
    auto record = shaken(7);
    auto y = record.samples.col(2);
    const double rms = std::sqrt(y.squaredNorm() / static_cast<double>(y.size()));
    saturate(y, 1.43 * rms, noise * rms, random);
    const auto r = measured({record}).responses;
    ASSERT_THAT(clipped_of(r), testing::ElementsAre("y2"));
    const auto warning = warnings_of(r, Kind::clipped).front();
    EXPECT_NEAR(warning.highest, 1.43 * rms, 0.06 * rms);
    EXPECT_GT(warning.share, 0.02);
    EXPECT_GT(warning.value, 0.05);
    const auto found = identify_modes(r), clean = identify_modes(measured({shaken(7)}).responses);
    ASSERT_EQ(found.modes.size(), clean.modes.size());
    for (std::size_t k = 0; k < found.modes.size(); ++k) {
      EXPECT_LT(found.modes[k].quality(), 0.8);
      EXPECT_GT(clean.modes[k].quality(), 0.95);
    }
  }
}

TEST(Saturated, AForceIsSaid) {
  test::Random random(727);
  auto record = shaken(11);
  saturate(record.samples.col(0), 1.57, 4e-3, random);
  const auto r = measured({record}).responses;
  EXPECT_THAT(clipped_of(r), testing::ElementsAre("u1"));
  for (const auto& mode : identify_modes(r).modes) EXPECT_LT(mode.quality(), 0.5);
}

TEST(Saturated, OutputsOfTheOnlyHitAreSaidAndTheirModesHaveALowQuality) {
  for (std::uint64_t seed = 81; seed <= 86; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    auto record = hammer_record({.noise = 0.0}, seed);
    saturate_outputs(0.47, 2e-3, random, record);
    const auto r = measured({record}).responses;
    EXPECT_GE(clipped_of(r).size(), 2U);
    for (const auto& mode : identify_modes(r).modes) EXPECT_LT(mode.quality(), 0.6);
  }
}

/// Each hit is a block: those that were too strong are not needed.
TEST(Saturated, HitsAreLeftOutWhereOthersRemain) {
  for (std::uint64_t seed = 91; seed <= 93; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    std::vector<data::Record> records;
    for (const double size : {1.0, 0.37, 1.13, 0.41})
      records.push_back(hammer_record({.size = {size}, .noise = 0.0}, seed + records.size()));
    VectorXd largest(4);
    for (Index c = 1; c < 4; ++c) largest[c] = records[2].samples.col(c).cwiseAbs().maxCoeff();
    for (auto& record : records)
      for (Index c = 1; c < 4; ++c)
        saturate(record.samples.col(c), 0.44 * largest[c], 1e-3 * largest[c], random);
    const auto r = measured(records).responses;
    EXPECT_THAT(clipped_of(r), testing::IsEmpty());
    const auto left_out = warnings_of(r, Kind::clipped_hits);
    ASSERT_EQ(left_out.size(), 1U);
    EXPECT_EQ(left_out[0].count, 2);
    EXPECT_EQ(left_out[0].total, 4);
    const auto found = identify_modes(r);
    expect_beam(found);
    for (const auto& mode : found.modes) EXPECT_GT(mode.quality(), 0.9);
  }
}

/// Hits that come before the last one has rung down are one block, up to the first that was too
/// strong.
TEST(Saturated, WhatComesBeforeAHitThatIsTooStrongIsUsed) {
  test::Random random(97);
  auto record = hammer_record(
      {.seconds = 3.1, .at = {0.113, 0.71, 1.83}, .size = {0.4, 0.31, 1.2}, .noise = 0.0}, 97);
  saturate_outputs(0.6, 1e-3, random, record);
  const auto r = measured({record}).responses;
  EXPECT_THAT(clipped_of(r), testing::IsEmpty());
  const auto left_out = warnings_of(r, Kind::clipped_hits);
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out[0].count, 1);
  EXPECT_EQ(left_out[0].total, 3);
  expect_beam(identify_modes(r));
}

// what is not cut off

CutOff cut_off_of(const VectorXd& x, Index piece) {
  CutTops tops;
  double step = std::numeric_limits<double>::infinity();
  for (Index t = 1; t < x.size(); ++t)
    if (const double by = std::abs(x[t] - x[t - 1]); by > 0.0) step = std::min(step, by);
  for (Index at = 0; at < x.size(); at += piece) {
    const VectorXd part = x.segment(at, std::min(piece, x.size() - at));
    tops.add(part, part.minCoeff(), part.maxCoeff());
  }
  return tops.cut_off(step);
}

constexpr double rate = 1000.0;

double sine(double frequency, double t) { return std::sin(2.0 * std::numbers::pi * frequency * t); }

/// What a resonator makes of x.
VectorXd through(const VectorXd& x, double frequency, double damping) {
  const double w = 2.0 * std::numbers::pi * frequency / rate, decay = std::exp(-damping * w),
               turn = std::cos(w * std::sqrt(1 - damping * damping));
  VectorXd y(x.size());
  for (Index t = 0; t < x.size(); ++t)
    y[t] = x[t] + (t > 0 ? 2.0 * decay * turn * y[t - 1] : 0.0) -
           (t > 1 ? decay * decay * y[t - 2] : 0.0);
  return y / std::max(y.cwiseAbs().maxCoeff(), 1e-300);
}

enum Signal {
  tone,
  tone_of_few_samples,
  swept,
  noise,
  periodic,
  hit,
  struck,
  shaken_mass,
  signals
};

VectorXd signal_of(int kind, std::uint64_t seed) {
  test::Random random(seed);
  const Index n = 8192;
  VectorXd x = VectorXd::Zero(n);
  const double f = random.uniform(2.3, 210.0), damping = random.uniform(0.002, 0.3);
  const auto each = [&](const auto& value) {
    for (Index t = 0; t < n; ++t) x[t] = value(static_cast<double>(t) / rate);
  };
  const auto pulse = [&] {
    const auto length = static_cast<Index>(random.uniform(3.0, 31.0));
    for (Index t = 0; t < length; ++t)
      x[611 + t] =
          std::sin(std::numbers::pi * static_cast<double>(t + 1) / static_cast<double>(length + 1));
  };
  switch (kind) {
    case tone:
      each([&](double t) { return sine(f, t); });
      break;
    case tone_of_few_samples:
      each([&](double t) { return sine(rate / (3.0 + static_cast<double>(seed % 37)), t); });
      break;
    case swept:
      each([&](double t) { return sine(3.1 + 0.5 * f / 8.2 * t, t); });
      break;
    case periodic:
      for (int line = 3; line < 40; ++line) {
        const double phase = random.uniform(0.0, 1.0);
        for (Index t = 0; t < n; ++t)
          x[t] += sine(line / 1024.0, static_cast<double>(t % 1024) + 1024.0 / line * phase);
      }
      break;
    case hit:
      pulse();
      break;
    case struck:
      pulse();
      x = through(x, f, damping) - 0.6 * through(x, 0.37 * f, 0.3 * damping);
      break;
    default:
      for (double& value : x) value = test::normal(random);
      if (kind == shaken_mass)
        x = through(x, f, damping) + 0.4 * through(x, 1.7 * f, 0.2 * damping);
  }
  const double level = std::array{0.0, 1e-4, 1e-3, 0.01}[seed % 4] * x.cwiseAbs().maxCoeff();
  for (double& value : x) value += level * test::normal(random);
  const double levels = std::array{0.0, 11.0, 127.0, 2047.0, 0.0}[seed % 5];
  if (levels > 0.0) {
    const double step = x.cwiseAbs().maxCoeff() / levels;
    x = (x / step).array().round() * step;
  }
  return x;
}

class Whole : public testing::TestWithParam<int> {};

TEST_P(Whole, SignalsAreNotCutOff) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed)
    EXPECT_EQ(cut_off_of(signal_of(GetParam(), seed), 700).samples, 0) << seed;
}

INSTANTIATE_TEST_SUITE_P(Kinds, Whole, testing::Range(0, static_cast<int>(signals)));

/// Tops as of a valve current on a coarse step: three samples at the extreme, and 13 steps lower
/// three samples further.
TEST(FlatTops, RoundTopsOnACoarseStepAreNotCutOff) {
  const auto cut_off = [](double limit) {
    constexpr double step = 1e-4;
    VectorXd x(5000);
    for (Index t = 0; t < x.size(); ++t)
      x[t] = step * std::min(limit, std::round(60.45 * std::sin(0.172 * static_cast<double>(t))));
    FlatTops tops;
    tops.add(x, x.minCoeff(), x.maxCoeff());
    return tops.cut_off(x.maxCoeff() - x.minCoeff());
  };
  EXPECT_EQ(cut_off(1000.0).samples, 0);
  const auto cut = cut_off(40.0);
  EXPECT_GT(cut.samples, 1000);
  EXPECT_DOUBLE_EQ(cut.above, 40e-4);
  EXPECT_FALSE(std::isfinite(cut.below));
}

/// A tone that is cut off on one side, in pieces of any length: the level and all its samples.
TEST(CutTops, DoNotDependOnThePieces) {
  test::Random random(41);
  VectorXd x(20000);
  for (Index t = 0; t < x.size(); ++t)
    x[t] = std::min(sine(7.31, static_cast<double>(t) / rate), 0.71) + 2e-3 * test::normal(random);
  const auto whole = cut_off_of(x, x.size());
  EXPECT_NEAR(whole.above, 0.71, 0.02);
  EXPECT_FALSE(std::isfinite(whole.below));
  const auto above = (x.array() > 0.70).count();
  EXPECT_NEAR(static_cast<double>(whole.samples) / static_cast<double>(above), 1.0, 0.1);
  for (const Index piece : {37, 512, 4999}) {
    const auto cut = cut_off_of(x, piece);
    EXPECT_NEAR(static_cast<double>(cut.samples) / static_cast<double>(whole.samples), 1.0, 0.05);
    EXPECT_EQ(cut.above, whole.above);
  }
}

}  // namespace
}  // namespace hydrapod::identification
