/// Modes from outputs alone: a few records of the classes of foreign_output_only_long_test.cpp.

#include "output_only.hpp"

#include <gtest/gtest.h>

namespace hydrapod::test {
namespace {

constexpr double far = 4.0;  // standard deviations: once in 16 000

void expect_all_modes(const ModalSystem& system, const identification::Identification& found) {
  ASSERT_EQ(found.modes.size(), system.modes.size());
  for (std::size_t r = 0; r < found.modes.size(); ++r) {
    const auto& fit = found.modes[r].fit;
    const auto pole = system.modes[r].pole;
    EXPECT_NEAR(fit.omega(), std::abs(pole), far * fit.omega_deviation) << r;
    EXPECT_NEAR(fit.damping_ratio(), -pole.real() / std::abs(pole), far * fit.damping_deviation)
        << r;
    EXPECT_LT(fit.omega_deviation, 0.005 * fit.omega()) << r;
    EXPECT_LT(fit.damping_deviation, 0.4 * fit.damping_ratio()) << r;
    EXPECT_GT(identification::mac(fit.shape, system.modes[r].shape), 0.98) << r;
  }
}

TEST(OutputOnly, ModesOfUnequalMassesHaveIntervals) {
  auto data = unequal_chain();
  data.experiment.seed = 5;
  const auto found = identified_outputs(outputs_of(data.system, data.experiment), data.block);
  expect_all_modes(data.system, found);
  EXPECT_TRUE(found.responses.harmonics.empty());
  EXPECT_FALSE(found.chart.empty());
}

TEST(OutputOnly, HarmonicsAreToldFromModes) {
  auto data = chain_with_tones();
  data.experiment.seed = 3;
  const auto record = outputs_of(data.system, data.experiment);
  const auto found = identified_outputs(record, data.block);
  expect_all_modes(data.system, found);
  const auto& harmonics = found.responses.harmonics;
  ASSERT_EQ(harmonics.size(), 2u);
  const double line = data.experiment.sample_rate / data.block;
  Eigen::VectorXd rms =
      (record.samples.colwise().squaredNorm() / static_cast<double>(record.samples.rows()))
          .cwiseSqrt();
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& tone = data.experiment.tones[k];
    EXPECT_NEAR(harmonics[k].frequency, tone.frequency, 0.3 * line) << k;
    for (Eigen::Index o = 0; o < 3; ++o)  // the tones are part of the RMS, and noise is under them
      EXPECT_NEAR(harmonics[k].amplitude[o], tone.amplitude[o] * rms[o],
                  0.1 * tone.amplitude[o] * rms[o] + 0.005 * rms[o])
          << k << " " << o;
  }
}

/// Where the sharp mode stands out little, the others cannot be fitted without it: without that
/// none was found in any of these records.
TEST(OutputOnly, ASharpModeThatIsBarelyKnownKeepsTheOthers) {
  auto data = sharp_chain();
  for (const std::uint64_t seed : {1024, 1041, 1060}) {
    data.experiment.seed = seed;
    const auto found = identified_outputs(outputs_of(data.system, data.experiment), data.block);
    ASSERT_EQ(found.modes.size(), 3U) << seed;
    for (std::size_t r = 0; r < 3; ++r) {
      const auto& fit = found.modes[r].fit;
      const auto pole = data.system.modes[r].pole;
      EXPECT_NEAR(fit.omega(), std::abs(pole), far * fit.omega_deviation) << seed;
      EXPECT_NEAR(fit.damping_ratio(), -pole.real() / std::abs(pole), far * fit.damping_deviation)
          << seed;
    }
  }
}

/// Too sharp for its blocks: a harmonic, and the others stay.
TEST(OutputOnly, AModeThatIsTooSharpIsNamedAmongTheHarmonics) {
  auto data = sharp_chain();
  data.experiment.seed = 1055;
  const auto found = identified_outputs(outputs_of(data.system, data.experiment), data.block);
  EXPECT_EQ(found.modes.size(), 2U);
  ASSERT_EQ(found.responses.harmonics.size(), 1U);
  EXPECT_NEAR(found.responses.harmonics[0].frequency, 4.151, 0.02);
}

TEST(OutputOnly, ASharpResonanceIsNoHarmonic) {
  ModalSystem system;
  Eigen::VectorXd shape(3);
  shape << 0.7, -1.1, 0.4;
  system.modes.push_back(real_mode(6.31, 0.0014, shape));
  shape << 0.9, 0.8, -0.5;
  system.modes.push_back(real_mode(9.87, 0.0093, shape));
  const auto record = outputs_of(system, {.samples = 90000, .noise = 0.02, .seed = 11});
  expect_all_modes(system, identified_outputs(record, 8192));
}

}  // namespace
}  // namespace hydrapod::test
