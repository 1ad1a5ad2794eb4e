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

/// Forces of which a low-pass leaves most below the lowest mode: its real pole is not in the model,
/// and took a third of the damping of that mode.
TEST(OutputOnly, ForcesThatFallWithFrequencyLeaveTheDamping) {
  using Eigen::Vector;
  ModalSystem system{{real_mode(7.03, 0.0131, Vector<double, 5>(0.83, -0.41, 0.57, 0.93, -0.72)),
                      real_mode(12.17, 0.0083, Vector<double, 5>(-0.37, 0.91, 0.62, -0.48, -0.85)),
                      real_mode(20.3, 0.0079, Vector<double, 5>(0.69, 0.52, -0.97, 0.44, 0.33)),
                      real_mode(33.1, 0.0082, Vector<double, 5>(0.46, -0.77, -0.36, -0.88, 0.59))}};
  for (auto& mode : system.modes) mode.shape *= mode.pole * mode.pole;  // accelerations
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const auto record = outputs_of(
        system,
        {.sample_rate = 151.0, .samples = 60000, .noise = 0.02, .colour = 2.9, .seed = seed});
    const auto found = identified_outputs(record, 2048);
    ASSERT_EQ(found.modes.size(), 4U) << seed;
    const auto& fit = found.modes[0].fit;
    EXPECT_NEAR(fit.damping_ratio(), 0.0131, far * fit.damping_deviation) << seed;
    EXPECT_GT(found.from, 3.5) << seed;
  }
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
