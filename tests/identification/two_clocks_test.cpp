/// Inputs and outputs by two recorders whose clocks differ by some millionths: it is said, and
/// taken out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "measured_records.hpp"
#include "support/identification_score.hpp"

namespace hydrapod::identification {
namespace {

using test::normal;

test::ModalSystem frame() {
  test::ModalSystem system;
  system.modes = {test::real_mode(7.13, 0.0117, Eigen::Vector3d(0.81, -0.52, 0.37)),
                  test::real_mode(15.9, 0.0083, Eigen::Vector3d(0.34, 0.77, -0.91)),
                  test::real_mode(23.6, 0.0142, Eigen::Vector3d(-0.66, 0.49, 0.58)),
                  test::real_mode(36.4, 0.0091, Eigen::Vector3d(0.47, 0.63, 0.74))};
  return system;
}

constexpr double clock_rate = 160.0;

/// Random force up to 55 Hz and its displacements, which repeat after a time longer than the
/// record. Outputs are recorded at t (1 − ε): samples 32 times as close, and straight lines between
/// them, which are off by less than (2π 55/(32 · 160))²/8 = 6e-4.
data::Record by_two_clocks(double ratio, std::uint64_t seed) {
  const auto system = frame();
  test::Random random(seed);
  constexpr int period = 1 << 16, closer = 32;
  const auto samples = static_cast<Eigen::Index>(240.0 * clock_rate);
  data::Record record{.header = test::header_of(1, 3, clock_rate), .samples = {}};
  record.samples.setZero(samples, 4);
  std::vector<std::complex<double>> lines(period * closer / 2 + 1), force(lines.size());
  for (std::size_t k = 1; static_cast<double>(k) * clock_rate / period < 55.0; ++k)
    force[k] = {normal(random), normal(random)};
  numerics::RealFft fft(period * closer);
  std::vector<double> close(static_cast<std::size_t>(period) * closer);
  for (Eigen::Index c = 0; c < 4; ++c) {
    for (std::size_t k = 1; k < lines.size() && force[k] != 0.0; ++k)
      lines[k] =
          force[k] *
          (c == 0 ? 1.0 : system.response(static_cast<double>(k) * clock_rate / period)(c - 1, 0));
    fft.inverse(lines, close);
    for (Eigen::Index k = 0; k < samples; ++k) {
      // begins in the middle, so that an early output has samples
      const double at = closer * (1000.0 + static_cast<double>(k) * (c == 0 ? 1.0 : 1.0 - ratio));
      const auto before = static_cast<std::size_t>(at);
      const double share = at - static_cast<double>(before);
      record.samples(k, c) = (1.0 - share) * close[before] + share * close[before + 1];
    }
  }
  for (Eigen::Index c = 1; c < 4; ++c) {
    const double rms = record.samples.col(c).norm() / std::sqrt(static_cast<double>(samples));
    for (double& y : record.samples.col(c)) y += 0.02 * rms * normal(random);
  }
  return record;
}

std::vector<data::ResponseWarning> clocks_in(const Measurement& m) {
  std::vector<data::ResponseWarning> found;
  for (const auto& warning : m.responses.warnings)
    if (warning.kind == data::ResponseWarning::Kind::two_clocks) found.push_back(warning);
  return found;
}

TEST(TwoClocks, AreSaidAndTakenOut) {
  const auto truth = test::true_modes(frame());
  for (const double ratio : {2e-5, -5e-5, 1e-4, 2e-4}) {
    test::ClassScore score;
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const auto m = measured({by_two_clocks(ratio, seed)});
      const auto said = clocks_in(m);
      ASSERT_EQ(said.size(), 1U) << ratio;
      EXPECT_NEAR(said[0].value, ratio, 1e-6) << seed;
      EXPECT_EQ(said[0].count, 3) << seed;
      score.add(truth, test::found_modes(identify_modes(m.responses)));
    }
    EXPECT_EQ(score.found, 8) << ratio;
    EXPECT_EQ(score.false_modes, 0) << ratio;
    EXPECT_LT(score.largest_damping_error(), 0.03) << ratio;
    EXPECT_LT(score.largest_frequency_error(), 4e-4) << ratio;
  }
}

TEST(TwoClocks, AreNotSaidWhereThereIsOne) {
  for (std::uint64_t seed = 11; seed <= 13; ++seed)
    EXPECT_TRUE(clocks_in(measured({by_two_clocks(0.0, seed)})).empty()) << seed;
}

/// Samples that are kept are compared beside the spectra, others in the same reading.
TEST(TwoClocks, AreTheSameOnAThreadOfTheirOwn) {
  const auto record = by_two_clocks(-7e-5, 6);
  const auto beside = measured({record}), together = measured({record}, {.most_kept = 0});
  ASSERT_EQ(clocks_in(beside).size(), 1U);
  ASSERT_EQ(clocks_in(together).size(), 1U);
  EXPECT_EQ(clocks_in(beside)[0].value, clocks_in(together)[0].value);
  EXPECT_EQ(beside.responses.H, together.responses.H);
}

/// An output that the recorder of the force took too.
TEST(TwoClocks, AnOutputKeepsTheClockOfTheInput) {
  auto record = by_two_clocks(1e-4, 5);
  record.samples.col(2) = by_two_clocks(0.0, 5).samples.col(2);
  const auto said = clocks_in(measured({record}));
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].count, 2);
  EXPECT_EQ(said[0].channel, "y1");
}

}  // namespace
}  // namespace hydrapod::identification
