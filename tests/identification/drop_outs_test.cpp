/// Records with drop-outs: missing samples cost information, not modes. Many seeds are in
/// drop_outs_long_test.cpp.

#include <gtest/gtest.h>

#include "gapped.hpp"
#include "identification/predictor.hpp"

namespace hydrapod::identification {
namespace {

void expect_all_modes(const DropOuts& d) {
  const auto result = gapped_score(d, 2);
  EXPECT_EQ(result.score.found, result.score.wanted);
  EXPECT_EQ(result.score.false_modes, 0);
  EXPECT_LT(result.score.largest_frequency_error(), 0.003);
  // of 20 normal numbers one is beyond 4 once in 800
  EXPECT_LT(result.frequency_in_deviations, 4.0);
  EXPECT_LT(result.damping_in_deviations, 4.0);
  EXPECT_GT(result.missing, 0.015);
}

TEST(DropOuts, SamplesLostAtRandom) { expect_all_modes({.share = 0.02}); }
TEST(DropOuts, ManyShortGaps) { expect_all_modes({.gaps = 200}); }
TEST(DropOuts, BothAtOnce) { expect_all_modes({.share = 0.02, .gaps = 200}); }
TEST(DropOuts, EachChannelLosesItsOwn) {
  expect_all_modes({.share = 0.02, .gaps = 60, .channels_separately = true});
}

constexpr Eigen::Index period = 2000;

/// White noise that repeats 24 times moves the first mass.
data::Record periodic_record() {
  const auto system = five_masses(1);
  constexpr double rate = 200.0;
  data::Record record{.header = test::header_of(1, 5, rate), .samples = {}};
  record.samples.resize(24 * period, 6);
  test::Random random(17);
  Eigen::VectorXd force(period);
  for (double& u : force) u = test::normal(random);
  test::ModalRun run(system, 1.0 / rate);
  for (Eigen::Index t = -6 * period; t < record.samples.rows(); ++t) {
    const Eigen::VectorXd now = force.segment((t + 6 * period) % period, 1);
    if (t >= 0) record.samples.row(t) << now.transpose(), run.output().transpose();
    run.advance(now);
  }
  const double size = record.samples.rightCols(5).cwiseAbs().maxCoeff();
  for (double& y : record.samples.rightCols(5).reshaped()) y += 1e-3 * size * test::normal(random);
  return record;
}

TEST(DropOuts, OneLostSampleOfTheInputHidesNoPeriod) {
  auto record = periodic_record();
  record.samples(31013, 0) = std::numeric_limits<double>::quiet_NaN();
  const auto m = gapped_measurement(record);
  EXPECT_TRUE(m.spectra.options.periodic);
  EXPECT_EQ(m.spectra.options.block_length, period);
  EXPECT_EQ(m.spectra.blocks, 23);
  EXPECT_EQ(m.spectra.blocks_left_out, 1);
}

TEST(DropOuts, InEveryPeriodTheyAreFilled) {
  for (const Eigen::Index channel : {0, 4}) {
    auto record = periodic_record();
    for (Eigen::Index t = 7; t < record.samples.rows(); t += 997)
      record.samples(t, channel) = std::numeric_limits<double>::quiet_NaN();
    const auto m = gapped_measurement(record);
    EXPECT_FALSE(m.spectra.options.periodic);
    EXPECT_EQ(m.spectra.blocks_left_out, 0);
    const auto found = identify_modes(m.responses);
    const auto truth = five_masses(1).modes;
    ASSERT_EQ(found.modes.size(), truth.size());
    for (std::size_t r = 0; r < truth.size(); ++r)
      EXPECT_NEAR(found.modes[r].fit.omega() / std::abs(truth[r].pole), 1.0, 0.01);
  }
}

/// A signal that obeys a recursion exactly is restored exactly.
TEST(Predictor, RestoresWhatIsPredictable) {
  constexpr Eigen::Index rows = 4000;
  Rows z(rows, 2);
  for (Eigen::Index t = 0; t < rows; ++t) {
    const auto x = static_cast<double>(t);
    z(t, 0) = std::sin(0.731 * x) + 0.8 * std::cos(0.213 * x + 0.4);
    z(t, 1) = std::cos(0.731 * x) - 0.6 * std::cos(0.213 * x + 1.3);
  }
  const Rows truth = z;
  Mask missing = Mask::Zero(rows, 2);
  missing.middleRows(1700, 20).setOnes();
  missing.col(1).segment(900, 40).setOnes();
  for (Eigen::Index t = 0; t < rows; ++t)
    for (Eigen::Index c = 0; c < 2; ++c)
      if (missing(t, c)) z(t, c) = std::numeric_limits<double>::quiet_NaN();
  const Predictor predictor(z, missing, 0);
  EXPECT_LT((z - truth).cwiseAbs().maxCoeff(), 1e-2);
}

/// y_t = 0.9 y_(t−1) + e: the mean between two samples that are known is in closed form, and a draw
/// keeps the variance.
TEST(Predictor, FillsWithTheConditionalMean) {
  constexpr Eigen::Index rows = 200000;
  constexpr double a = 0.9;
  test::Random random(11);
  Rows z(rows, 1);
  double y = 0.0;
  for (Eigen::Index t = 0; t < rows; ++t) {
    y = a * y + std::sqrt(1.0 - a * a) * test::normal(random);
    z(t, 0) = y;
  }
  const Rows truth = z;
  Mask missing = Mask::Zero(rows, 1);
  for (Eigen::Index t = 100; t + 100 < rows; t += 200) missing.col(0).segment(t, 3).setOnes();
  PredictorOptions options{.highest_order = 1};
  const Predictor predictor(z, missing, 0, options);
  double worst = 0.0, filled = 0.0, drawn = 0.0, count = 0.0;
  Rows with_draws = z;
  numerics::Gaussian gaussian(5);
  predictor.fill(with_draws, missing, 0, &gaussian);
  for (Eigen::Index t = 100; t + 100 < rows; t += 200) {
    // of a Markov chain: the middle of a gap of three, from 2 samples away on both sides
    const double a2 = a * a;
    const double middle = a2 / (1.0 + a2 * a2) * (truth(t - 1, 0) + truth(t + 3, 0));
    worst = std::max(worst, std::abs(z(t + 1, 0) - middle));
    filled += std::pow(z(t + 1, 0), 2);
    drawn += std::pow(with_draws(t + 1, 0), 2);
    count += 1.0;
  }
  EXPECT_LT(worst, 0.05);  // the recursion is estimated, a to 1 %
  // var of the mean: 2 a⁴/(1 + a⁴) = 0.79
  EXPECT_NEAR(filled / count, 0.79, 4.0 * 0.79 * std::sqrt(2.0 / count));
  EXPECT_NEAR(drawn / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

/// Nothing of the input is known: the modes are those of the record without drop-outs.
TEST(DropOuts, OfOutputsAlone) {
  const auto system = five_masses();
  const DropOuts d{.share = 0.02, .gaps = 100, .duration = 600.0};
  const auto whole = identify_modes(
      gapped_measurement(gapped_record(system, {.duration = d.duration}, 6), true).responses);
  const auto found =
      identify_modes(gapped_measurement(gapped_record(system, d, 6), true).responses);
  ASSERT_EQ(whole.modes.size(), 5U);
  ASSERT_EQ(found.modes.size(), 5U);
  for (std::size_t r = 0; r < 5; ++r) {
    const auto &fit = found.modes[r].fit, &with_all = whole.modes[r].fit;
    EXPECT_NEAR(fit.omega(), with_all.omega(), 1.5 * with_all.omega_deviation) << r;
    EXPECT_NEAR(fit.damping_ratio(), with_all.damping_ratio(), 1.5 * with_all.damping_deviation)
        << r;
  }
}

TEST(DropOuts, LongGapsLeaveBlocksOut) {
  const auto system = five_masses();
  auto record = gapped_record(system, {.share = 0.02}, 3);
  record.samples.middleRows(20000, 4000).setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto measured = gapped_measurement(record);
  EXPECT_GT(measured.spectra.blocks_left_out, 0);
  EXPECT_LT(measured.spectra.blocks_left_out, measured.spectra.blocks / 4);
  EXPECT_EQ(identify_modes(measured.responses).modes.size(), 5U);
}

TEST(DropOuts, TooManyAreRefusedByName) {
  const auto system = five_masses();
  auto record = gapped_record(system, {.duration = 60.0}, 4);
  for (Eigen::Index t = 0; t < record.samples.rows(); t += 3)
    record.samples(t, 5) = std::numeric_limits<double>::quiet_NaN();
  try {
    (void)gapped_measurement(record);
    FAIL() << "a third of y3 is missing";
  } catch (const base::ComputationError& error) {
    EXPECT_NE(std::string(error.what()).find("y3 misses 33 % of its samples"), std::string::npos)
        << error.what();
  }
}

TEST(DropOuts, ADeadChannelIsLeftOut) {
  const auto system = five_masses();
  auto record = gapped_record(system, {.share = 0.01}, 5);
  record.samples.col(4).setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto measured = gapped_measurement(record);
  EXPECT_EQ(measured.responses.outputs.size(), 4U);
  EXPECT_EQ(identify_modes(measured.responses).modes.size(), 5U);
}

}  // namespace
}  // namespace hydrapod::identification
