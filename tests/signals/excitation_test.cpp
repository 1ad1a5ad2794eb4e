/// Signals that excite: levels, spectra, independence, orthogonality.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/processing.hpp"
#include "hydrapod/signals/signals.hpp"

namespace hydrapod::test {
namespace {

using namespace signals;
using base::two_pi;
constexpr double rate = 500.0;

Vector6 ugly_levels() {
  Vector6 rms;
  rms << 1.1e-3, 0.7e-3, 2.3e-3, 0.013, 0.0081, 0.031;
  return rms;
}

/// At the levels above, from the first sample on.
Signal at_once(const Form& form) { return {.size = ugly_levels(), .form = form, .fade = 0.0}; }

data::Samples samples_of(const std::vector<Signal>& signals, Eigen::Index count,
                         std::uint64_t seed = 7) {
  Generator generator(signals, rate, seed);
  data::Samples all(count, 6);
  for (Eigen::Index k = 0; k < count; ++k) all.row(k) = generator.next().value.transpose();
  return all;
}

Vector6 rms_of(const data::Samples& samples) {
  return (samples.colwise().squaredNorm() / static_cast<double>(samples.rows())).cwiseSqrt();
}

void expect_levels(const data::Samples& samples, const Vector6& levels, double tolerance) {
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(rms_of(samples)[i], levels[i], tolerance * levels[i]) << i;
}

/// Correlation coefficients of 15 pairs within five standard errors of independent samples, of
/// which there are `independent`.
void expect_uncorrelated(const data::Samples& samples, double independent) {
  const Vector6 rms = rms_of(samples);
  for (int i = 0; i < 6; ++i)
    for (int j = i + 1; j < 6; ++j)
      EXPECT_LT(std::abs(samples.col(i).dot(samples.col(j))) /
                    (static_cast<double>(samples.rows()) * rms[i] * rms[j]),
                5.0 / std::sqrt(independent));
}

/// Coefficients of the lines `cycles` of one period, U with u = Re Σ U e^{2πi·cycles·k/n}.
Eigen::VectorXcd lines_of(const Eigen::VectorXd& period, const std::vector<long>& cycles) {
  Eigen::VectorXcd lines(static_cast<Eigen::Index>(cycles.size()));
  const auto n = static_cast<double>(period.size());
  for (std::size_t l = 0; l < cycles.size(); ++l) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index k = 0; k < period.size(); ++k)
      sum += period[k] *
             std::polar(1.0, -two_pi * static_cast<double>(cycles[l]) * static_cast<double>(k) / n);
    lines[static_cast<Eigen::Index>(l)] = 2.0 * sum / n;
  }
  return lines;
}

TEST(White, HasItsLevelsIsFlatAndIndependent) {
  const auto samples = samples_of({at_once(White{})}, 200'000);
  expect_levels(samples, ugly_levels(), 0.01);  // 5 standard errors are 0.8 %
  expect_uncorrelated(samples, 200'000.0);
  data::WelchSpectrum welch(6, rate, 256);
  welch.add(samples);
  const auto spectrum = welch.result();
  const double error = std::sqrt(1.1 / static_cast<double>(spectrum.segments));
  for (int i = 0; i < 6; ++i) {
    const double flat = ugly_levels()[i] * ugly_levels()[i] / (rate / 2.0);
    for (Eigen::Index k = 4; k < 124; ++k)
      EXPECT_NEAR(spectrum.density(k, i) / flat, 1.0, 5.5 * error);
  }
}

TEST(Noise, HasItsLevelsInItsBandOnly) {
  const auto samples = samples_of({at_once(Noise{5.0, 40.0})}, 400'000);
  // a band of 35 Hz for 800 s: 56 000 independent values, standard error of the level 0.3 %
  expect_levels(samples, ugly_levels(), 0.015);
  expect_uncorrelated(samples, 56'000.0);
  data::WelchSpectrum welch(6, rate, 2048);
  welch.add(samples);
  const auto spectrum = welch.result();
  const double error = std::sqrt(1.1 / static_cast<double>(spectrum.segments));
  for (int i = 0; i < 6; ++i) {
    const double flat = ugly_levels()[i] * ugly_levels()[i] / 35.0;
    for (Eigen::Index k = 0; k < spectrum.frequency.size(); ++k) {
      const double f = spectrum.frequency[k], relative = spectrum.density(k, i) / flat;
      if (f > 6.5 && f < 38.5) {
        EXPECT_NEAR(relative, 1.0, 6.0 * error + 0.01) << f;
      }
      // the lowest lines hold what is left of the segments' means
      if ((f > 0.6 && f < 3.0) || f > 43.0) {
        EXPECT_LT(relative, 1e-6) << f;
      }
    }
  }
}

TEST(Noise, FallsWithItsSlope) {
  const auto samples = samples_of({at_once(Noise{2.0, 100.0, -6.0})}, 400'000);
  data::WelchSpectrum welch(6, rate, 1024);
  welch.add(samples);
  const auto spectrum = welch.result();
  const auto level = [&](double f) {  // mean over ten lines
    const auto at = static_cast<Eigen::Index>(f / spectrum.frequency[1]);
    return spectrum.density.col(2).segment(at - 5, 10).mean();
  };
  EXPECT_NEAR(10.0 * std::log10(level(80.0) / level(20.0)), -12.0, 0.5);
  EXPECT_NEAR(10.0 * std::log10(level(40.0) / level(10.0)), -12.0, 0.6);
}

TEST(MultisineSignal, HasItsLevelsAndNothingBesideItsLines) {
  const auto period = samples_of({at_once(Multisine{1.0, 30.0, 4.0})}, 2000);
  expect_levels(period, ugly_levels(), 1e-12);
  std::vector<long> all;
  for (long k = 0; k < 1000; ++k) all.push_back(k);
  for (int i = 0; i < 6; ++i) {
    const auto lines = lines_of(period.col(i), all);
    const double size = ugly_levels()[i] * std::sqrt(2.0 / 117.0);  // 117 lines from 1 to 30 Hz
    for (long k = 0; k < 1000; ++k)
      EXPECT_NEAR(std::abs(lines[k]), k >= 4 && k <= 120 ? size : 0.0, 1e-12 * size * 100.0) << k;
  }
}

/// Decibels of the amplitude, per octave.
TEST(MultisineSignal, FallsByItsSlope) {
  const auto period =
      samples_of({at_once(Multisine{.from = 1.0, .to = 30.0, .period = 4.0, .slope = -4.5})}, 2000);
  expect_levels(period, ugly_levels(), 1e-12);
  const auto lines = lines_of(period.col(3), {6, 12, 24, 96});
  for (const auto [low, high, octaves] :
       {std::array{0, 1, 1}, std::array{1, 2, 1}, std::array{0, 3, 4}})
    EXPECT_NEAR(20.0 * std::log10(std::abs(lines[high]) / std::abs(lines[low])), -4.5 * octaves,
                1e-9);
}

/// A transform of a prime length takes too long, so the lines are summed: to the same signal.
TEST(MultisineSignal, OfAPrimeNumberOfSamplesIsTheSameSum) {
  const auto period = samples_of({at_once(Multisine{1.0, 5.0, 1009.0 / rate})}, 1009);
  expect_levels(period, ugly_levels(), 1e-12);
  std::vector<long> all;
  for (long k = 0; k < 504; ++k) all.push_back(k);
  const auto lines = lines_of(period.col(3), all);
  const double size = ugly_levels()[3] * std::sqrt(2.0 / 8.0);  // lines 3 to 10
  for (long k = 0; k < 504; ++k)
    EXPECT_NEAR(std::abs(lines[k]), k >= 3 && k <= 10 ? size : 0.0, 1e-12 * size) << k;
}

TEST(MultisineSignal, RepeatsExactly) {
  const Signal signal = at_once(Multisine{1.0, 30.0, 1.234});
  const auto two = samples_of({signal}, 2 * 617);
  EXPECT_EQ((two.topRows(617) - two.bottomRows(617)).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(period_samples({signal}, rate), 617);
}

/// Inputs of six experiments at each line, rows over their levels: condition number 1.
void expect_orthogonal(Multisine multisine) {
  std::vector<long> cycles;
  for (double k = multisine.from * multisine.period; k <= multisine.to * multisine.period; ++k)
    cycles.push_back(std::lround(k));
  std::vector<Eigen::MatrixXcd> U(cycles.size(), Eigen::MatrixXcd(6, 6));
  for (int experiment = 0; experiment < 6; ++experiment) {
    multisine.experiment = experiment + 1;
    const auto period = samples_of({at_once(multisine)}, std::lround(multisine.period * rate));
    for (int i = 0; i < 6; ++i) {
      const auto at_lines = lines_of(period.col(i), cycles);
      for (std::size_t k = 0; k < U.size(); ++k)
        U[k](i, experiment) = at_lines[static_cast<Eigen::Index>(k)] / ugly_levels()[i];
    }
  }
  double worst = 1.0;
  for (const auto& matrix : U) {
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(matrix);
    worst = std::max(worst, svd.singularValues()[0] / svd.singularValues()[5]);
  }
  EXPECT_NEAR(worst, 1.0, 1e-6);
}

TEST(MultisineSignal, SixExperimentsAreOrthogonalAtEveryLine) {
  expect_orthogonal({1.0, 30.0, 2.0});
  expect_orthogonal({2.0, 60.0, 1.0, -3.0, true});
}

double crest_factor(const Eigen::VectorXd& period) {
  return period.cwiseAbs().maxCoeff() /
         std::sqrt(period.squaredNorm() / static_cast<double>(period.size()));
}

TEST(MultisineSignal, LowCrestPhasesHaveLowPeaksInAllSixExperiments) {
  for (int experiment = 1; experiment <= 6; ++experiment) {
    const auto low = samples_of({at_once(Multisine{1.0, 30.0, 4.0, 0.0, true, experiment})}, 2000);
    const auto random =
        samples_of({at_once(Multisine{1.0, 30.0, 4.0, 0.0, false, experiment})}, 2000);
    expect_levels(low, ugly_levels(), 1e-12);
    for (int i = 0; i < 6; ++i) {
      EXPECT_LT(crest_factor(low.col(i)), 1.8);
      EXPECT_GT(crest_factor(random.col(i)), 2.2);
    }
  }
}

TEST(BinarySequenceSignal, IsTwoValuedAndAsWhiteAsItCanBe) {
  // clocks every 4 samples; 2^n − 1 clocks for every length of register
  for (int bits = 3; bits <= 16; ++bits) {
    const long clocks = (1L << bits) - 1;
    const Signal spec = at_once(Binary{0.443 * rate / 4.0, static_cast<double>(4 * clocks) / rate});
    ASSERT_EQ(period_samples({spec}, rate), 4 * clocks) << bits;
    const auto period = samples_of({spec}, 4 * clocks);
    Eigen::VectorXd signs(clocks);
    for (long k = 0; k < clocks; ++k) {
      signs[k] = period(4 * k, 0) / ugly_levels()[0];
      ASSERT_EQ(std::abs(signs[k]), 1.0);
      ASSERT_EQ(period(4 * k + 3, 0), period(4 * k, 0));
    }
    EXPECT_EQ(std::abs(signs.sum()), 1.0);
    // a maximum-length sequence correlates with itself, shifted, by exactly −1
    for (const long shift : {1L, 2L, clocks / 2, clocks - 1}) {
      double sum = 0.0;
      for (long k = 0; k < clocks; ++k) sum += signs[k] * signs[(k + shift) % clocks];
      EXPECT_EQ(sum, -1.0) << bits << ' ' << shift;
    }
    if (bits < 5) continue;  // directions are a sixth of the sequence apart
    for (int i = 1; i < 6; ++i)
      EXPECT_NEAR(period.col(0).dot(period.col(i)) / (ugly_levels()[0] * ugly_levels()[i]), -4.0,
                  1e-9 * static_cast<double>(clocks));
  }
}

TEST(SweptSineSignal, DirectionsTakeTurnsAtTheirLevels) {
  for (const bool logarithmic : {true, false}) {
    const Sweep sweep{1.0, 50.0, 8.0, logarithmic, 1, true};
    const auto samples = samples_of({{ugly_levels(), sweep, 0.4}}, 6 * 4000);
    for (int turn = 0; turn < 6; ++turn) {
      const data::Samples part = samples.middleRows(4000 * turn, 4000);
      for (int i = 0; i < 6; ++i)
        EXPECT_NEAR(rms_of(part)[i], i == turn ? ugly_levels()[i] : 0.0, 1e-12);
    }
  }
}

TEST(ChirpSignal, RepeatsWithoutABreak) {
  Vector6 levels = Vector6::Zero();
  levels[4] = 0.02;
  const auto samples = samples_of({{levels, Chirp{1.0, 60.0, 1.5, 3, true}, 0.0}}, 750 * 4);
  EXPECT_NEAR(rms_of(samples)[4], 0.02, 1e-12);
  EXPECT_EQ((samples.topRows(750) - samples.bottomRows(750)).cwiseAbs().maxCoeff(), 0.0);
  double largest_step = 0.0;
  for (Eigen::Index k = 0; k + 1 < samples.rows(); ++k)
    largest_step = std::max(largest_step, std::abs(samples(k + 1, 4) - samples(k, 4)));
  const double amplitude = 0.02 * std::numbers::sqrt2;
  EXPECT_LT(largest_step, 1.05 * amplitude * two_pi * 60.0 / rate);  // of a sine of 60 Hz
}

TEST(ExcitationOfSeveral, IsTheirSumAndTheSameAgain) {
  const Signal noise = at_once(Noise{0.0, 30.0}), white = at_once(White{});
  const Signal sines = at_once(Multisine{1.0, 20.0, 2.0});
  Generator all({noise, white, sines}, rate, 3), again({noise, white, sines}, rate, 3),
      other({noise, white, sines}, rate, 4);
  std::vector<Vector6> first;
  bool differs = false;
  for (int k = 0; k < 3000; ++k) {
    first.push_back(all.next().value);
    ASSERT_EQ(first.back(), again.next().value);
    differs = differs || first.back() != other.next().value;
  }
  EXPECT_TRUE(differs);
  all.restart();
  for (int k = 0; k < 3000; ++k) ASSERT_EQ(all.next().value, first[static_cast<std::size_t>(k)]);
  EXPECT_FALSE(period_samples({white, sines}, rate));
  EXPECT_EQ(period_samples({sines, at_once(Multisine{1.0, 20.0, 3.0})}, rate), 3000);
}

/// After the last direction the first one has its turn again.
TEST(ExcitationInTurns, RepeatsAfterAllDirections) {
  Signal sweep = at_once(Sweep{.from = 3.0, .to = 17.0, .duration = 1.3, .turns = 2});
  EXPECT_EQ(period_samples({sweep}, rate), 2 * 6 * 650);
  sweep.size[1] = sweep.size[4] = 0.0;
  EXPECT_EQ(period_samples({sweep}, rate), 2 * 4 * 650);
  sweep.form = Chirp{.from = 3.0, .to = 17.0, .period = 0.9, .turns = 3};
  EXPECT_EQ(period_samples({sweep}, rate), 3 * 4 * 450);
}

TEST(Excitation, SaysWhatIsWrong) {
  const auto message = [](const Signal& signal) -> std::string {
    try {
      Generator generator({signal}, rate, 1);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  Vector6 endless = Vector6::Zero();
  endless[4] = INFINITY;
  EXPECT_EQ(message({.size = endless, .form = White{}}),
            "size of ry is inf, expected a finite number");
  EXPECT_EQ(message(at_once(Multisine{1.0, 300.0, 2.0})),
            "multisine: the band is 1 … 300 Hz, expected 0 ≤ from ≤ to < 250 Hz, half the sample "
            "rate");
  EXPECT_EQ(message(at_once(Multisine{1.1, 1.2, 2.0})),
            "multisine: period is 2, expected one so long that a multiple of 1/period lies in the "
            "band");
  EXPECT_EQ(message(at_once(Sweep{1.0, 20.0, 0.0})),
            "sweep: duration is 0, expected two to ten million samples, in seconds");
}

}  // namespace
}  // namespace hydrapod::test
