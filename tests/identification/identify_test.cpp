/// Modes of systems known exactly, without a setting.

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/base/units.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "exact/modal_system.hpp"
#include "hydrapod/base/error.hpp"

namespace hydrapod::identification {
namespace {

using base::two_pi;
using Eigen::Index;

FrequencyResponses responses_of(const data::Record& record, int inputs, int block) {
  SpectrumEstimator estimator(record.header, {.block_length = block});
  estimator.add(record.samples);
  ChannelChoice choice;
  choice.inputs.resize(static_cast<size_t>(inputs));
  std::iota(choice.inputs.begin(), choice.inputs.end(), 0);
  choice.outputs.resize(record.header.channels.size() - choice.inputs.size());
  std::iota(choice.outputs.begin(), choice.outputs.end(), inputs);
  return estimate_responses(estimator.result(), choice, Estimator::h1);
}

/// Noise of `share` of each output's RMS.
data::Record noisy_record(const test::ModalSystem& system, test::NoiseExperiment experiment,
                          double share) {
  const auto clean = test::record_of(system, experiment);
  experiment.output_noise =
      share * (clean.samples.rightCols(system.outputs()).colwise().squaredNorm() /
               static_cast<double>(clean.samples.rows()))
                  .cwiseSqrt()
                  .transpose();
  return test::record_of(system, experiment);
}

/// H at given frequencies without error, as from a file.
FrequencyResponses exact_responses(const test::ModalSystem& system,
                                   const std::vector<double>& frequency) {
  FrequencyResponses r;
  const auto header = test::header_of(system.inputs(), system.outputs(), 1.0);
  r.inputs.assign(header.channels.begin(), header.channels.begin() + system.inputs());
  r.outputs.assign(header.channels.begin() + system.inputs(), header.channels.end());
  for (const double f : frequency) {
    r.frequency.push_back(f);
    r.H.push_back(system.response(f));
  }
  return r;
}

void expect_modes(const Identification& found, const test::ModalSystem& system, double frequency,
                  double damping) {
  ASSERT_EQ(found.modes.size(), system.modes.size());
  for (std::size_t r = 0; r < system.modes.size(); ++r) {
    const auto& fit = found.modes[r].fit;
    const auto pole = system.modes[r].pole;
    EXPECT_NEAR(fit.omega() / std::abs(pole), 1.0, frequency) << r;
    EXPECT_NEAR(fit.damping_ratio() / (-pole.real() / std::abs(pole)), 1.0, damping) << r;
  }
}

TEST(Identify, ExactResponsesGiveExactModes) {
  // damping from 0.1 % to 15 %; frequencies unevenly spaced
  test::ModalSystem system;
  test::Random random(2);
  for (const auto& [f, zeta] : {std::pair{2.3, 0.001}, {4.1, 0.02}, {6.9, 0.15}, {10.7, 0.004}}) {
    Eigen::VectorXd shape(3);
    for (double& x : shape) x = test::normal(random);
    system.modes.push_back(test::real_mode(f, zeta, shape));
  }
  std::vector<double> frequency;
  for (int k = 0; k < 500; ++k) frequency.push_back(1.0 + 13.0 * std::pow(k / 499.0, 1.3));
  const auto found = identify_modes(exact_responses(system, frequency));
  expect_modes(found, system, 1e-6, 1e-4);
  for (std::size_t r = 0; r < found.modes.size(); ++r) {
    EXPECT_GT(mac(found.modes[r].fit.shape, system.modes[r].shape), 1.0 - 1e-6);
    EXPECT_GT(found.modes[r].mpc, 0.999);
  }
  for (const double f : {1.7, 4.1, 9.9})
    EXPECT_LT((synthesised(found.model, f) - system.response(f)).norm(),
              1e-5 * system.response(f).norm());
}

TEST(Identify, AChainOfMassesFromANoisyRecord) {
  const auto system = test::chain(5, 1.37, 2113.0, 0.013);
  const auto record = noisy_record(system, {.sample_rate = 60.0, .samples = 1 << 15}, 0.03);
  const auto found = identify_modes(responses_of(record, 5, 1024));
  expect_modes(found, system, 0.003, 0.1);
  ASSERT_EQ(found.warnings.size(), 2U);
  EXPECT_EQ(found.warnings[0].kind, ModeWarning::Kind::few_samples);
  EXPECT_NEAR(found.warnings[0].value, 5.0, 0.05);
  EXPECT_EQ(found.warnings[1].kind, ModeWarning::Kind::short_blocks);
  for (std::size_t r = 0; r < found.modes.size(); ++r) {
    const auto& m = found.modes[r];
    EXPECT_GT(mac(m.fit.shape, system.modes[r].shape), 0.99) << r;
    EXPECT_GT(m.mpc, 0.97) << r;
    EXPECT_LT(std::abs(m.fit.omega() - std::abs(system.modes[r].pole)),
              4.0 * m.fit.omega_deviation);
  }
}

/// A mode above half of the sample rate shows at the rate less its frequency.
TEST(Identify, AModeWithFewerThanThreeSamplesPerPeriodMayBeAnImage) {
  const test::ModalSystem system{{test::real_mode(40.0, 0.01, Eigen::Vector2d(0.8, 0.4)),
                                  test::real_mode(300.0, 0.005, Eigen::Vector2d(0.6, -0.7))}};
  const auto responses = [&](double rate) {
    auto r = exact_responses(system, {});
    r.sample_rate = rate;
    for (int k = 1; k < 1250; ++k) {
      const double f = 0.2 * k;
      r.frequency.push_back(f);
      r.H.push_back(system.sampled_response(f, 1.0 / rate));
    }
    return r;
  };
  const auto found = identify_modes(responses(512.0));
  ASSERT_FALSE(found.modes.empty());
  EXPECT_NEAR(found.modes.back().fit.omega() / (2.0 * std::numbers::pi), 212.0, 1.0);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_EQ(found.warnings[0].kind, ModeWarning::Kind::few_samples);
  EXPECT_NEAR(found.warnings[0].value, 2.42, 0.02);
  EXPECT_NEAR(found.warnings[0].to, 300.0, 1.0);
  EXPECT_EQ(found.warnings[0].count, 1);
  EXPECT_DOUBLE_EQ(found.warnings[0].from, 200.0);  // 512/2.56
  EXPECT_LE(found.modes.back().quality(), 0.3);
  const auto enough = identify_modes(responses(1200.0), {.to = 100.0});
  EXPECT_TRUE(std::ranges::none_of(enough.warnings, [](const ModeWarning& w) {
    return w.kind == ModeWarning::Kind::few_samples;
  }));
}

/// Periods that repeat hide what a machine that is not linear adds: its errors are stated too
/// small.
TEST(Identify, NoModeIsCertainWhereNoiseExplainsLittle) {
  const auto system = test::chain(5, 1.37, 2113.0, 0.013);
  const auto record = noisy_record(system, {.sample_rate = 60.0, .samples = 1 << 15}, 0.03);
  auto responses = responses_of(record, 5, 1024);
  const auto honest = identify_modes(responses);
  for (auto& V : responses.noise) V /= 16.3;
  const auto found = identify_modes(responses);
  EXPECT_NEAR(found.model.misfit, 16.3 * honest.model.misfit, 1.6);
  ASSERT_FALSE(found.modes.empty());
  for (const auto& mode : honest.modes) EXPECT_GT(mode.quality(), 0.9);
  for (const auto& mode : found.modes) EXPECT_LE(mode.quality(), 2.0 / found.model.misfit);
}

/// A sweep of a loop gave a fourth mode with ζ = 4.23 ± 3.69 % and quality 1.00.
TEST(Identify, AModeWhoseDampingIsOpenIsNotCertain) {
  IdentifiedMode mode{.persistence = 1.0, .vector_consistency = 1.0};
  mode.fit.pole = 82.7 * std::complex<double>(-0.0423, std::sqrt(1.0 - 0.0423 * 0.0423));
  EXPECT_EQ(mode.quality(), 1.0);  // no deviation is known
  mode.fit.damping_deviation = 0.25 * 0.0423;
  EXPECT_NEAR(mode.quality(), 1.0, 1e-9);
  mode.fit.damping_deviation = 0.0188;
  EXPECT_NEAR(mode.quality(), 0.0423 / (4.0 * 0.0188), 1e-9);
}

TEST(Identify, BlocksThatAreShortForAResonanceAreNamed) {
  const auto system = test::chain(5, 1.37, 2113.0, 0.013);
  const auto record = noisy_record(system, {.sample_rate = 60.0, .samples = 1 << 15}, 0.01);
  constexpr int block = 640;
  const auto found = identify_modes(responses_of(record, 5, block));
  expect_modes(found, system, 0.003, 0.1);
  std::int64_t narrow = 0;
  for (const auto& mode : system.modes)
    narrow += mode.pole.real() / -std::numbers::pi * block / 60.0 < 2.0;
  ASSERT_GT(narrow, 0);
  ASSERT_LT(narrow, 5);
  using Kind = ModeWarning::Kind;
  const auto at = std::ranges::find(found.warnings, Kind::short_blocks, &ModeWarning::kind);
  ASSERT_NE(at, found.warnings.end());
  EXPECT_EQ(at->count, narrow);
  EXPECT_EQ(at->total, 5);
  EXPECT_NEAR(at->value, block / 60.0, 1e-12);
  const auto& lowest = found.modes.front().fit;
  EXPECT_DOUBLE_EQ(at->from, lowest.omega() / two_pi);
  EXPECT_NEAR(at->to, 2.0 * 0.013 * lowest.omega() / two_pi, 0.1 * at->to);
  EXPECT_TRUE(std::ranges::none_of(
      identify_modes(responses_of(record, 5, 4 * block)).warnings,
      [](const ModeWarning& warning) { return warning.kind == Kind::short_blocks; }));
}

TEST(Identify, CloseModesAreTwo) {
  // 0.5 % apart at 1 % damping: half a bandwidth
  test::ModalSystem system;
  const Eigen::Vector3d a(1.0, 0.4, -0.3), b(-0.2, 0.9, 0.7);
  system.modes.push_back(test::real_mode(8.00, 0.010, a));
  system.modes.push_back(test::real_mode(8.04, 0.012, b));
  const auto record =
      noisy_record(system, {.sample_rate = 50.0, .samples = 1 << 15, .seed = 4}, 0.05);
  const auto found = identify_modes(responses_of(record, 3, 2048));
  expect_modes(found, system, 0.003, 0.1);
  EXPECT_GT(mac(found.modes[0].fit.shape, system.modes[0].shape), 0.98);
  EXPECT_GT(mac(found.modes[1].fit.shape, system.modes[1].shape), 0.98);
}

TEST(Identify, RepeatedModesAreTwo) {
  test::ModalSystem system;
  const Eigen::Vector3d a(1.0, 0.1, -0.3), b(-0.2, 0.9, 0.2);
  system.modes.push_back(test::real_mode(5.3, 0.02, a));
  system.modes.push_back(test::real_mode(5.3, 0.02, b));
  const auto record =
      noisy_record(system, {.sample_rate = 50.0, .samples = 1 << 15, .seed = 4}, 0.05);
  const auto found = identify_modes(responses_of(record, 3, 1024));
  expect_modes(found, system, 0.003, 0.1);
  // any mix of the two is a mode: the plane they span is what is known
  Eigen::MatrixXcd plane(3, 2);
  plane << found.modes[0].fit.shape, found.modes[1].fit.shape;
  const auto Q = plane.colPivHouseholderQr();
  for (const auto& mode : system.modes) {
    const Eigen::VectorXcd x = Q.solve(mode.shape);
    EXPECT_LT((plane * x - mode.shape).norm(), 0.05 * mode.shape.norm());
  }
}

TEST(Identify, OneResponseOrOneInputIsEnough) {
  const auto whole = test::chain(4, 0.83, 1900.0, 0.02);
  for (const bool one_input : {false, true}) {
    auto system = whole;
    for (auto& mode : system.modes) {
      auto& cut = one_input ? mode.participation : mode.shape;
      cut = cut.head(1).eval();
    }
    const auto record =
        noisy_record(system, {.sample_rate = 60.0, .samples = 1 << 15, .seed = 6}, 0.02);
    const auto found =
        identify_modes(responses_of(record, static_cast<int>(system.inputs()), 1024));
    expect_modes(found, system, 0.005, 0.15);
  }
}

TEST(Identify, NoiseAloneHasNoMode) {
  data::Record record{.header = test::header_of(2, 2, 50.0), .samples = data::Samples(1 << 14, 4)};
  test::Random random(12);
  for (Index k = 0; k < record.samples.size(); ++k) record.samples.data()[k] = test::normal(random);
  const auto found = identify_modes(responses_of(record, 2, 512));
  EXPECT_TRUE(found.modes.empty());
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_EQ(found.warnings[0].kind, ModeWarning::Kind::no_mode);
}

TEST(Identify, AReversedChannelOnlyChangesItsSignInTheShape) {
  const auto system = test::chain(3, 1.0, 1500.0, 0.02);
  auto record = noisy_record(system, {.sample_rate = 50.0, .samples = 1 << 14, .seed = 5}, 0.01);
  const auto as_is = identify_modes(responses_of(record, 3, 512));
  record.samples.col(4) *= -1.0;
  const auto reversed = identify_modes(responses_of(record, 3, 512));
  expect_modes(reversed, system, 0.005, 0.15);
  ASSERT_EQ(as_is.modes.size(), reversed.modes.size());
  for (std::size_t r = 0; r < as_is.modes.size(); ++r) {
    Eigen::VectorXcd shape = as_is.modes[r].fit.shape;
    shape[1] *= -1.0;
    EXPECT_GT(mac(shape, reversed.modes[r].fit.shape), 1.0 - 1e-6);
  }
}

TEST(Identify, ABandWithoutModesHasNone) {
  const auto system = test::chain(3, 1.0, 1500.0, 0.02);  // 4.7, 8.7, 11.4 Hz
  const auto record = noisy_record(system, {.sample_rate = 80.0, .samples = 1 << 15}, 0.01);
  const auto found = identify_modes(responses_of(record, 3, 1024), {.from = 20.0, .to = 35.0});
  EXPECT_TRUE(found.modes.empty());
}

TEST(Identify, TooFewFrequenciesAreRefused) {
  const auto system = test::chain(3, 1.0, 1500.0, 0.02);
  EXPECT_THROW(identify_modes(exact_responses(system, {1.0, 2.0, 3.0, 4.0, 5.0})),
               base::ComputationError);
}

/// Two sharp modes 0.06 % apart that add a hundredth, on the flank of a strong repeated one.
TEST(Identify, WeakPairsAreFoundInWhatTheStrongOnesLeaveOver) {
  test::ModalSystem system;
  system.modes.push_back(test::real_mode(7.443, 0.053, Eigen::Vector4d(3.1, 0.0, 0.0, 1.1)));
  system.modes.push_back(test::real_mode(7.443, 0.053, Eigen::Vector4d(0.0, 3.1, -1.1, 0.0)));
  system.modes.push_back(test::real_mode(8.503, 0.0024, Eigen::Vector4d(0.31, 0.0, 0.0, 0.13)));
  system.modes.push_back(test::real_mode(8.509, 0.0024, Eigen::Vector4d(0.0, 0.33, -0.12, 0.0)));
  test::NoiseExperiment experiment{.sample_rate = 60.0, .samples = 1 << 17, .seed = 3};
  const auto record = noisy_record(system, experiment, 0.02);
  const auto found = identify_modes(responses_of(record, 4, 4096), {.to = 15.0});
  ASSERT_EQ(found.modes.size(), 4U);
  for (std::size_t r = 2; r < 4; ++r) {
    const auto& fit = found.modes[r].fit;
    EXPECT_NEAR(fit.omega() / two_pi, 8.506, 0.012);
    EXPECT_NEAR(fit.damping_ratio(), 0.0024, 3.5 * fit.damping_deviation);
    EXPECT_LT(fit.damping_deviation, 6e-4);
  }
}

TEST(Identify, ShapesOfARepeatedModeAreGivenAlongOutputs) {
  test::ModalSystem system;  // any rotation of these two is as good
  system.modes.push_back(test::real_mode(5.17, 0.03, Eigen::Vector4d(2.0, 1.2, -0.3, 0.5)));
  system.modes.push_back(test::real_mode(5.17, 0.03, Eigen::Vector4d(-1.2, 2.0, -0.5, -0.3)));
  test::NoiseExperiment experiment{.sample_rate = 60.0, .samples = 1 << 15, .seed = 4};
  const auto record = noisy_record(system, experiment, 0.05);
  const auto found = identify_modes(responses_of(record, 4, 1024), {.to = 12.0});
  ASSERT_EQ(found.modes.size(), 2U);
  for (int r = 0; r < 2; ++r) {
    const auto& mode = found.modes[static_cast<size_t>(r)];
    EXPECT_EQ(mode.repeated, 2);
    EXPECT_NEAR(mode.displacement[r].real(), 1.0, 1e-9);
    EXPECT_NEAR(std::abs(mode.displacement[1 - r]), 0.0, 1e-9);
    EXPECT_NEAR(mode.displacement[2 + r].real(), 0.0, 0.05);
    EXPECT_NEAR(mode.displacement[3 - r].real(), r == 0 ? 0.25 : -0.25, 0.05);
    EXPECT_NEAR(mode.mpc, 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace hydrapod::identification
