/// Channels of a slow logger that repeats each of its values.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "hammer.hpp"
#include "identification/held_values.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;
using Eigen::Index;
using Eigen::VectorXd;

std::vector<data::ResponseWarning> slow_of(const FrequencyResponses& r) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : r.warnings)
    if (warning.kind == Kind::slow_channel) found.push_back(warning);
  return found;
}

data::Record shaken_for_long(std::uint64_t seed) {
  return test::record_of(beam(), {.sample_rate = hammer_rate,
                                  .samples = 82000,
                                  .output_noise = Eigen::Vector3d(1e-5, 2e-5, 1e-5),
                                  .seed = seed});
}

void hold(Index channel, Index samples, data::Record& record) {
  auto x = record.samples.col(channel);
  for (Index t = 0; t < x.size(); ++t) x[t] = x[t - t % samples];
}

void expect_beam(const FrequencyResponses& responses) {
  const auto truth = beam();
  const auto found = identify_modes(responses);
  ASSERT_EQ(found.modes.size(), truth.modes.size());
  for (std::size_t r = 0; r < truth.modes.size(); ++r) {
    const auto& fit = found.modes[r].fit;
    const auto pole = truth.modes[r].pole;
    EXPECT_LT(std::abs(fit.omega() - std::abs(pole)), 4.0 * fit.omega_deviation) << r;
    EXPECT_LT(std::abs(fit.damping_ratio() + pole.real() / std::abs(pole)),
              4.0 * fit.damping_deviation)
        << r;
    EXPECT_GT(mac(fit.shape, truth.modes[r].shape), 0.995) << r;
  }
}

/// A mode above half of their rate is found too: the force tells what was folded.
TEST(SlowLogger, OfAllOutputsIsSaidAndTakenOut) {
  for (const Index samples : {4, 10}) {
    SCOPED_TRACE(samples);
    auto record = shaken_for_long(3);
    for (const Index c : {1, 2, 3}) hold(c, samples, record);
    const auto r = measured({record}).responses;
    const auto slow = slow_of(r);
    ASSERT_EQ(slow.size(), 3U);
    EXPECT_EQ(slow[1].channel, "y2");
    EXPECT_EQ(slow[1].value, static_cast<double>(samples));
    EXPECT_DOUBLE_EQ(slow[1].highest, 0.5 * hammer_rate / static_cast<double>(samples));
    EXPECT_EQ(slow[1].share, 0.0);
    expect_beam(r);
  }
}

TEST(SlowLogger, OfOneOutputIsTakenOutAndAMuchSlowerOneIsLeftOut) {
  auto record = shaken_for_long(5);
  hold(2, 3, record);
  expect_beam(measured({record}).responses);
  hold(1, 23, record);
  const auto r = measured({record}).responses;
  ASSERT_EQ(r.outputs.size(), 2U);
  EXPECT_EQ(r.outputs[0].name, "y2");
  const auto slow = slow_of(r);
  ASSERT_EQ(slow.size(), 2U);
  EXPECT_EQ(slow[0].count, 1);
  EXPECT_EQ(slow[1].count, 0);
}

/// What was folded onto the force cannot be told from what was there.
TEST(SlowLogger, OfTheForceTooIsNotTrusted) {
  auto record = shaken_for_long(7);
  for (const Index c : {0, 1, 2, 3}) hold(c, 10, record);
  const auto r = measured({record}).responses;
  const auto slow = slow_of(r);
  ASSERT_EQ(slow.size(), 4U);
  EXPECT_EQ(slow[3].channel, "u1");
  EXPECT_GT(slow[3].share, 0.8);
  EXPECT_LT(r.frequency.back(), slow[3].highest);
  for (const auto& mode : identify_modes(r).modes) EXPECT_LT(mode.quality(), 0.2);
}

/// Without anything above half of the logger's rate, nothing is folded.
TEST(SlowLogger, OfAllChannelsIsNoHarmWhereItsInputEndsBelow) {
  const auto truth = beam();
  test::Random random(19);
  data::Record record{.header = test::header_of(1, 3, hammer_rate), .samples = {}};
  record.samples.resize(82000, 4);
  test::ModalRun run(truth, 1.0 / hammer_rate);
  std::array<double, 6> low{};  // first-order low passes at 47 Hz, one after the other
  for (Index t = 0; t < record.samples.rows(); ++t) {
    double x = 10.0 * test::normal(random);
    for (double& y : low) x = y += 0.144 * (x - y);
    record.samples.row(t) << x, run.output().transpose();
    run.advance(VectorXd::Constant(1, x));
  }
  for (const Index c : {0, 1, 2, 3}) hold(c, 4, record);
  const auto r = measured({record}).responses;
  const auto slow = slow_of(r);
  ASSERT_EQ(slow.size(), 4U);
  EXPECT_LT(slow[3].share, 0.05);
  const auto found = identify_modes(r);
  ASSERT_GE(found.modes.size(), 2U);
  EXPECT_NEAR(found.modes[0].fit.omega() / std::abs(truth.modes[0].pole), 1.0, 1e-3);
  EXPECT_NEAR(found.modes[1].fit.omega() / std::abs(truth.modes[1].pole), 1.0, 1e-3);
  EXPECT_GT(found.modes[0].quality(), 0.8);
}

double hold_of(const VectorXd& x) {
  ValueHold values;
  for (Index at = 0; at < x.size(); at += 611)
    values.add(x.segment(at, std::min<Index>(611, x.size() - at)));
  return values.samples();
}

TEST(ValueHold, IsWhatEachValueLasts) {
  test::Random random(23);
  VectorXd x(30000);
  for (const double samples : {1.0, 2.0, 7.0, 10.24, 61.0}) {
    double value = 0.0;
    std::int64_t last = -1;
    for (Index t = 0; t < x.size(); ++t) {
      const auto count = static_cast<std::int64_t>(std::floor(static_cast<double>(t) / samples));
      if (count != last) value = test::normal(random);
      last = count;
      x[t] = value;
    }
    EXPECT_NEAR(hold_of(x), samples, 0.02 * samples) << samples;
  }
}

/// Coarse steps, ramps of them, what stands still at times, and sequences of two levels.
TEST(ValueHold, IsNotWhatStandsStillOtherwise) {
  test::Random random(29);
  VectorXd slow(30000), ramp(30000), bursts(30000), levels(30000);
  double y = 0.0, level = 1.0;
  for (Index t = 0; t < slow.size(); ++t) {
    y += 0.02 * (test::normal(random) - y);
    slow[t] = std::round(20.0 * y);
    ramp[t] = static_cast<double>((t / 13) % 97);
    bursts[t] = t % 400 < 170 ? test::normal(random) : 0.0;
    if (t % 17 == 0 && test::normal(random) > 0.0) level = -level;
    levels[t] = level;
  }
  for (const auto* x : {&slow, &ramp, &bursts, &levels}) EXPECT_EQ(hold_of(*x), 1.0);
}

}  // namespace
}  // namespace hydrapod::identification
