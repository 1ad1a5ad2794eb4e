/// The time-domain cross-check on systems known exactly.

#include "hydrapod/identification/cross_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "exact/modal_system.hpp"
#include "hydrapod/base/error.hpp"

namespace hydrapod::identification {
namespace {

double ratio(std::complex<double> pole) { return -pole.real() / std::abs(pole); }

/// The chain of four masses, frequencies 4.15 … 12.8 Hz.
test::ModalSystem system_under_test() { return test::chain(4, 1.07, 1913.0, 0.017); }

CrossSpectra noisy_spectra_of(const test::ModalSystem& system, double noise) {
  test::NoiseExperiment experiment{.sample_rate = 60.0, .samples = 1 << 16, .seed = 3};
  const auto clean = test::record_of(system, experiment);
  experiment.output_noise = Eigen::VectorXd::Constant(
      4, noise * std::sqrt(clean.samples.rightCols(4).squaredNorm() / (4.0 * (1 << 16))));
  const auto record = test::record_of(system, experiment);
  SpectrumEstimator estimator(record.header, {.block_length = 2048});
  estimator.add(record.samples);
  return estimator.result();
}

TEST(Realisation, AnExactSequenceGivesExactPoles) {
  const auto system = system_under_test();
  MarkovSequence sequence{.values = {}, .interval = 0.02};
  for (int k = 1; k <= 80; ++k) {
    Eigen::MatrixXcd Y = Eigen::MatrixXcd::Zero(4, 4);
    for (const auto& m : system.modes)
      Y += 2.0 * std::exp(m.pole * (k * 0.02)) * m.shape * m.participation.transpose();
    sequence.values.emplace_back(Y.real());
  }
  const auto chart = realised_poles(sequence, {8, 8, 1});
  ASSERT_EQ(chart.size(), 1u);
  ASSERT_EQ(chart[0].poles.size(), 4u);
  for (std::size_t r = 0; r < 4; ++r) {
    EXPECT_LT(std::abs(chart[0].poles[r].pole - system.modes[r].pole), 1e-8) << r;
    EXPECT_GT(mac(chart[0].poles[r].shape, system.modes[r].shape), 1.0 - 1e-9) << r;
    EXPECT_GT(mac(chart[0].poles[r].participation, system.modes[r].participation), 1.0 - 1e-9);
  }
}

TEST(Realisation, ImpulseResponsesOfARecordHaveItsModes) {
  const auto system = system_under_test();
  const auto responses = estimate_responses(
      noisy_spectra_of(system, 0.03),
      {.inputs = {0, 1, 2, 3}, .outputs = {4, 5, 6, 7}, .instruments = {}}, Estimator::h1);
  const auto clusters = select_poles(realised_poles(impulse_response(responses)));
  for (const auto& mode : system.modes) {
    bool found = false;
    for (const auto& c : clusters)
      found = found || (std::abs(c.representative.omega() / std::abs(mode.pole) - 1.0) < 0.005 &&
                        std::abs(c.representative.damping_ratio() / ratio(mode.pole) - 1.0) < 0.2 &&
                        mac(c.representative.shape, mode.shape) > 0.98);
    EXPECT_TRUE(found) << std::abs(mode.pole) / 6.2832 << " Hz";
  }
}

TEST(Realisation, OutputsAloneHaveTheModes) {
  const auto system = system_under_test();
  const auto found = identify_modes(half_spectra(noisy_spectra_of(system, 0.03), {4, 5, 6, 7}));
  ASSERT_EQ(found.modes.size(), 4u);
  const auto checks = cross_check(found, found.responses);
  for (std::size_t r = 0; r < 4; ++r) {
    const auto& fit = found.modes[r].fit;
    EXPECT_NEAR(fit.omega() / std::abs(system.modes[r].pole), 1.0, 0.003) << r;
    EXPECT_NEAR(fit.damping_ratio() / ratio(system.modes[r].pole), 1.0, 0.15) << r;
    EXPECT_GT(mac(fit.shape, system.modes[r].shape), 0.99) << r;
    ASSERT_TRUE(checks[r]) << r;
    EXPECT_TRUE(checks[r]->agrees) << r;
  }
}

TEST(Realisation, UnevenFrequenciesAreRefused) {
  FrequencyResponses r;
  for (const double f : {1.0, 2.0, 4.0, 8.0}) {
    r.frequency.push_back(f);
    r.H.emplace_back(Eigen::MatrixXcd::Ones(1, 1));
  }
  EXPECT_THROW(impulse_response(r), base::ComputationError);
}

}  // namespace
}  // namespace hydrapod::identification
