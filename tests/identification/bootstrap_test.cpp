/// Intervals against the scatter over draws of the averages, and the cross-check.

#include "hydrapod/identification/identify.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/cross_check.hpp"

namespace hydrapod::identification {
namespace {

const ChannelChoice three_by_three{.inputs = {0, 1, 2}, .outputs = {3, 4, 5}, .instruments = {}};

test::ModalSystem system_under_test() { return test::chain(3, 1.13, 1733.0, 0.021); }

data::Record noisy_record() {
  return test::record_of(system_under_test(), {.sample_rate = 50.0,
                                               .samples = 1 << 16,
                                               .output_noise = Eigen::Vector3d::Constant(2e-3),
                                               .seed = 11});
}

constexpr int block = 1024;

CrossSpectra spectra_of_blocks(const data::Record& record, Eigen::Index first, Eigen::Index count) {
  SpectrumEstimator estimator(record.header, {.block_length = block});
  estimator.add(record.samples.middleRows(first, count));
  return estimator.result();
}

std::vector<CrossSpectra> groups_of(const data::Record& record, Eigen::Index groups) {
  std::vector<CrossSpectra> all;
  const Eigen::Index length = record.samples.rows() / groups;
  for (Eigen::Index g = 0; g < groups; ++g)
    all.push_back(spectra_of_blocks(record, g * length, length));
  return all;
}

TEST(Bootstrap, AveragedGroupsAreTheSpectraOfTheirBlocks) {
  auto record = noisy_record();
  record.samples = record.samples.topRows(8 * block).eval();
  // without overlap no block reaches over the border of a group
  const auto spectra = [&](Eigen::Index first, Eigen::Index count) {
    SpectrumEstimator estimator(record.header, {.block_length = block, .overlap = 0.0});
    estimator.add(record.samples.middleRows(first, count));
    return estimator.result();
  };
  const std::vector<CrossSpectra> groups{spectra(0, 3 * block), spectra(3 * block, 5 * block)};
  const auto sum = averaged_spectra(groups, {0, 1});
  const auto whole = spectra(0, 8 * block);
  EXPECT_EQ(sum.blocks, whole.blocks);
  // but each group loses its own mean, which lines 0 and 1 show
  const Eigen::Index others = whole.lines() - 2;
  EXPECT_LT((sum.re - whole.re).bottomRows(others).norm(), 1e-12 * whole.re.norm());
  EXPECT_LT((sum.im - whole.im).bottomRows(others).norm(), 1e-12 * whole.im.norm());
  EXPECT_DOUBLE_EQ(sum.statistics.effective_averages, whole.statistics.effective_averages);
}

TEST(Bootstrap, ScatterIsWhatTheIntervalsSay) {
  const auto record = noisy_record();
  const auto found = identify_modes(estimate_responses(
      spectra_of_blocks(record, 0, record.samples.rows()), three_by_three, Estimator::h1));
  ASSERT_EQ(found.modes.size(), 3U);
  const auto scatter = bootstrap_modes(groups_of(record, 16), three_by_three, Estimator::h1, found,
                                       {.resamples = 60});
  EXPECT_EQ(scatter.resamples, 60);
  // a standard deviation from 16 groups is itself known to 1/√30, and one from 60 draws to 1/√118:
  // 20 % together, of which three times
  constexpr double known_to = 0.6;
  for (Eigen::Index r = 0; r < 3; ++r) {
    const auto& fit = found.modes[static_cast<std::size_t>(r)].fit;
    EXPECT_NEAR(scatter.omega_deviation[r] / fit.omega_deviation, 1.0, known_to) << r;
    EXPECT_NEAR(scatter.damping_deviation[r] / fit.damping_deviation, 1.0, known_to) << r;
  }
}

TEST(Bootstrap, TheSameSeedGivesTheSameScatter) {
  const auto record = noisy_record();
  const auto found = identify_modes(estimate_responses(
      spectra_of_blocks(record, 0, record.samples.rows()), three_by_three, Estimator::h1));
  const auto groups = groups_of(record, 8);
  const auto run = [&](std::uint64_t seed) {
    return bootstrap_modes(groups, three_by_three, Estimator::h1, found,
                           {.resamples = 4, .seed = seed})
        .omega_deviation;
  };
  EXPECT_EQ(run(3), run(3));
  EXPECT_NE(run(3), run(4));
}

TEST(Bootstrap, ResamplesUntilAskedToStop) {
  const auto record = noisy_record();
  const auto found = identify_modes(estimate_responses(
      spectra_of_blocks(record, 0, record.samples.rows()), three_by_three, Estimator::h1));
  std::vector<double> shares;
  const auto scatter = bootstrap_modes(groups_of(record, 8), three_by_three, Estimator::h1, found,
                                       {.resamples = 10}, [&](double share) {
                                         shares.push_back(share);
                                         return share >= 0.3;
                                       });
  EXPECT_EQ(shares, (std::vector{0.1, 0.2, 0.3}));
  EXPECT_EQ(scatter.resamples, 3);
}

TEST(Bootstrap, TooFewGroupsAreRefused) {
  const auto record = noisy_record();
  Identification found;
  found.modes.resize(1);
  EXPECT_THROW(bootstrap_modes(groups_of(record, 3), three_by_three, Estimator::h1, found),
               std::invalid_argument);
}

TEST(CrossCheck, OfAChainIsTheSame) {
  const auto record = noisy_record();
  const auto responses = estimate_responses(spectra_of_blocks(record, 0, record.samples.rows()),
                                            three_by_three, Estimator::h1);
  auto found = identify_modes(responses);
  ASSERT_EQ(found.modes.size(), 3U);
  const auto system = system_under_test();
  auto cross_checks = cross_check(found, responses);
  for (std::size_t r = 0; r < 3; ++r) {
    ASSERT_TRUE(cross_checks[r].has_value()) << r;
    EXPECT_TRUE(cross_checks[r]->agrees);
    EXPECT_NEAR(cross_checks[r]->omega / std::abs(system.modes[r].pole), 1.0, 0.005);
    EXPECT_NEAR(cross_checks[r]->damping_ratio, 0.021, 0.004);
    EXPECT_GT(cross_checks[r]->mac, 0.98);
  }
  // a mode that is not in the responses has no cross-check, or one that disagrees
  found.modes[1].fit.pole *= 1.2;
  found.modes[2].fit.pole = {-0.3 * std::abs(found.modes[2].fit.pole),
                             found.modes[2].fit.pole.imag()};
  cross_checks = cross_check(found, responses);
  EXPECT_TRUE(!cross_checks[1].has_value() || !cross_checks[1]->agrees);
  EXPECT_TRUE(!cross_checks[2].has_value() || !cross_checks[2]->agrees);
}

/// A sample beyond all bounds leaves a group without the power of its inputs.
TEST(Bootstrap, GroupsOfWhichOneHasNoPowerOfTheInputsAreAveraged) {
  CrossSpectra one;
  one.options.block_length = 8;
  one.window = Eigen::VectorXd::Ones(8);
  one.re = Eigen::MatrixXd::Constant(3, 1, 1.7);
  one.im = Eigen::MatrixXd::Zero(3, 1);
  one.blocks = 2;
  one.input_power = Eigen::VectorXd::Ones(8);
  CrossSpectra other = one;
  other.re *= 3.0;
  other.input_power.resize(0);
  for (const auto& picks : {std::vector<std::size_t>{0, 1}, std::vector<std::size_t>{1, 0}}) {
    const auto mean = averaged_spectra({one, other}, picks);
    EXPECT_EQ(mean.input_power.size(), 0);
    EXPECT_NEAR(mean.re(2, 0), 3.4, 1e-15);
  }
  EXPECT_EQ(averaged_spectra({one, one}, {0, 1}).input_power, one.input_power);
}

}  // namespace
}  // namespace hydrapod::identification
