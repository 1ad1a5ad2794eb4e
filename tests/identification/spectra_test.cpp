/// Cross spectra against what is known of the signals.

#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/responses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>

#include "exact/modal_system.hpp"
#include "spectra_of.hpp"

namespace hydrapod::identification {
namespace {

using base::two_pi;
using Eigen::Index;

data::Record noise_record(int samples, int channels, std::uint64_t seed) {
  data::Record record{.header = test::header_of(channels, 0, 37.0), .samples = {}};
  record.samples.resize(samples, channels);
  test::Random random(seed);
  for (Index k = 0; k < record.samples.size(); ++k) record.samples.data()[k] = test::normal(random);
  return record;
}

TEST(Spectra, ASineHasItsPowerAndPhaseAtItsLine) {
  // 3 sin(ωt) and 2 sin(ωt − 0.7), on a line of the block
  const int n = 128;
  data::Record record{.header = test::header_of(2, 0, 64.0), .samples = data::Samples(20 * n, 2)};
  for (int t = 0; t < record.samples.rows(); ++t) {
    const double angle = two_pi * 9.0 * t / n;
    record.samples.row(t) << 3.0 * std::sin(angle), 2.0 * std::sin(angle - 0.7);
  }
  for (const Window window : {Window::hann, Window::rectangular, Window::hamming,
                              Window::blackman_harris, Window::flat_top, Window::blackman}) {
    const auto s = spectra_of(record, {.block_length = n, .window = window});
    // the window's lines share the power of the sine: their sum times Δf is the mean square
    double power = 0.0;
    for (Index k = 1; k < s.lines(); ++k) power += s.at(k)(0, 0).real() * 0.5;
    EXPECT_NEAR(power, 4.5, 1e-6) << window_text(window);
    const auto cross = s.at(9)(0, 1);  // E[Z_0 Z_1*]
    EXPECT_NEAR(std::arg(cross), 0.7, 1e-6) << window_text(window);
    EXPECT_NEAR(std::abs(cross), 1.5 * s.at(9)(1, 1).real(), 1e-6) << window_text(window);
  }
}

TEST(Spectra, WindowsRiseToOneFromWhatIsPublishedOfTheirEnds) {
  // Harris 1978; SciPy's flattop prints −0.000421051
  for (const auto& [window, end] : {std::pair{Window::hann, 0.0},
                                    {Window::rectangular, 1.0},
                                    {Window::hamming, 0.08},
                                    {Window::blackman_harris, 6e-5},
                                    {Window::flat_top, -0.000421051},
                                    {Window::blackman, 0.0},
                                    {Window::tukey, 0.0}}) {
    const auto w = window_samples(window, 254);
    EXPECT_NEAR(w[0], end, 1e-8) << window_text(window);
    EXPECT_NEAR(w[127], 1.0, 2e-8) << window_text(window);
    EXPECT_NEAR(w[83], w[254 - 83], 1e-12) << window_text(window);
  }
}

/// α = ½: half of it is flat, and the flanks are those of a Hann window of half the length.
TEST(Spectra, TukeysWindowIsFlatInTheMiddle) {
  const auto w = window_samples(Window::tukey, 248), flanks = window_samples(Window::hann, 124);
  for (int t = 0; t < 62; ++t) ASSERT_NEAR(w[t], flanks[t], 1e-15) << t;
  for (int t = 62; t <= 186; ++t) ASSERT_EQ(w[t], 1.0) << t;
  for (int t = 187; t < 248; ++t) ASSERT_NEAR(w[t], flanks[t - 124], 1e-15) << t;
}

TEST(Spectra, DensityOfWhiteNoiseIsTwiceItsVarianceOverTheSampleRate) {
  const auto record = noise_record(1 << 15, 3, 7);
  const auto s = spectra_of(record, {.block_length = 64});
  double mean = 0.0;
  for (Index k = 2; k < 31; ++k) mean += s.at(k)(1, 1).real() / 29.0;
  const double error = std::sqrt(1.0 / (s.statistics.effective_averages * 29.0 / 1.9));
  EXPECT_NEAR(mean * 37.0 / 2.0, 1.0, 3.0 * error);
}

TEST(Spectra, ScatterOfLinesIsWhatTheStatisticsSay) {
  // 400 estimates of the coherence of independent channels: its mean is 1/K
  for (const double overlap : {0.0, 0.5, 0.75}) {
    double mean = 0.0, neighbours = 0.0;
    AverageStatistics statistics;
    const int seeds = 40;
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto record = noise_record(2048, 2, static_cast<std::uint64_t>(seed));
      const auto s = spectra_of(record, {.block_length = 64, .overlap = overlap});
      statistics = s.statistics;
      for (Index k = 3; k < 29; ++k) {
        const auto a = s.at(k), b = s.at(k + 1);
        mean += std::norm(a(0, 1)) / (4.0 / 37.0 / 37.0) / (26.0 * seeds);
        neighbours += (a(0, 1) * std::conj(b(0, 1))).real() / (4.0 / 37.0 / 37.0) / (26.0 * seeds);
      }
    }
    const double expected = 1.0 / statistics.effective_averages;
    EXPECT_NEAR(mean / expected, 1.0, 0.12) << overlap;  // 3 deviations of about 500 lines
    EXPECT_NEAR(neighbours / expected, statistics.line_covariance[1], 0.12) << overlap;
  }
}

/// Of blocks side by side c'(0, d) is that of sin²: 1, 0, −1/2; c(0, d) of sin⁴: 1, −2/3, 1/6.
TEST(Spectra, LeakageOfAHannWindowIsThatOfItsSlope) {
  constexpr int n = 512;
  const auto s = average_statistics(window_samples(Window::hann, n), n, 31);
  ASSERT_GE(s.leakage_covariance.size(), 3U);
  EXPECT_NEAR(s.leakage_covariance[0], 1.0, 1e-12);
  EXPECT_NEAR(s.leakage_covariance[1], 0.0, 1e-12);
  EXPECT_NEAR(s.leakage_covariance[2], -1.0 / 12.0, 1e-12);
  // w w' = (sin θ/4 − sin 2θ/8) 2π/n, θ = 2πt/n
  EXPECT_NEAR(s.leakage_relation[0], 0.0, 1e-12);
  EXPECT_NEAR(s.leakage_relation[1], -1.0 / 3.0, 1e-12);
  EXPECT_NEAR(s.leakage_relation[2], -1.0 / 12.0, 1e-12);
  const double differences = std::sin(two_pi / n) * n / two_pi;  // central ones of the cosine
  EXPECT_NEAR(s.leakage_rate, std::pow(0.5 * two_pi / n * differences, 2) * 4.0 / 3.0, 1e-15);
}

/// A resonance without noise, three lines wide: errors by dH/dω are those of the statistics.
TEST(Spectra, ErrorsOfAResonanceWithoutNoiseAreLeakage) {
  const test::ModalSystem system{{test::real_mode(7.31, 0.021, Eigen::VectorXd::Ones(1))}};
  constexpr double rate = 200.0;
  const auto slope = [&](double f) {
    constexpr double step = 1e-5;
    return (system.sampled_response(f + step, 1.0 / rate)(0, 0) -
            system.sampled_response(f - step, 1.0 / rate)(0, 0)) /
           (2.0 * step * two_pi);
  };
  constexpr int seeds = 60, block = 2048;
  std::vector<Eigen::VectorXcd> all;
  Eigen::VectorXcd mean;
  FrequencyResponses r;
  AverageStatistics statistics;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto record = test::record_of(
        system,
        {.sample_rate = rate, .samples = 20 * block, .seed = static_cast<std::uint64_t>(seed)});
    const auto s = spectra_of(record, {.block_length = block});
    statistics = s.statistics;
    r = estimate_responses(s, {.inputs = {0}, .outputs = {1}, .instruments = {}}, Estimator::h1);
    std::vector<std::complex<double>> by_slope;
    for (std::size_t k = 0; k < r.lines(); ++k)
      if (r.frequency[k] > 6.1 && r.frequency[k] < 8.7)
        by_slope.push_back(r.H[k](0, 0) / slope(r.frequency[k]));
    all.emplace_back(Eigen::VectorXcd::Map(by_slope.data(), static_cast<Index>(by_slope.size())));
    mean = seed == 1 ? all[0] : (mean + all.back()).eval();
  }
  mean /= seeds;
  const auto together = [&](Index apart, bool relation = false) {
    double sum = 0.0;
    for (const auto& one : all) {
      const Eigen::VectorXcd g = one - mean, other = relation ? g.conjugate().eval() : g;
      const Index n = g.size() - apart;
      sum += other.head(n).dot(g.tail(n)).real() / static_cast<double>(n) / (seeds - 1.0);
    }
    return sum;
  };
  const auto& a = statistics.leakage_covariance;
  // 1560 values, of which the largest lags have 0.03 of scatter
  EXPECT_NEAR(together(0) / (r.leakage.rate * a[0] * r.degrees / r.averages), 1.0, 0.15);
  EXPECT_NEAR(together(1) / together(0), a[1] / a[0], 0.06);
  EXPECT_NEAR(together(2) / together(0), a[2] / a[0], 0.06);
  EXPECT_LT(a[1], -0.1);
  for (const Index apart : {0, 1, 2})
    EXPECT_NEAR(together(apart, true) / together(0),
                statistics.leakage_relation[static_cast<std::size_t>(apart)] / a[0], 0.06)
        << apart;
}

TEST(Spectra, PiecesOfAnySizeGiveTheSame) {
  const auto record = noise_record(3000, 5, 11);
  const SpectrumOptions options{.block_length = 256, .overlap = 0.3};
  const auto whole = spectra_of(record, options);
  SpectrumEstimator estimator(record.header, options);
  for (Index at = 0, piece = 1; at < 3000; at += piece, piece = piece * 3 % 101 + 1)
    estimator.add(record.samples.middleRows(at, std::min<Index>(piece, 3000 - at)));
  const auto pieces = estimator.result();
  EXPECT_EQ(whole.blocks, pieces.blocks);
  EXPECT_EQ(whole.re, pieces.re);
  EXPECT_EQ(whole.im, pieces.im);
}

TEST(Spectra, NumberOfThreadsDoesNotMatter) {
  const auto record = noise_record(60000, 7, 12);
  const ChannelChoice choice{.inputs = {0, 1, 2}, .outputs = {3, 4, 5, 6}, .instruments = {}};
  const auto of = [&](int threads) {
    return spectra_of(record, {.block_length = 2048, .threads = threads});
  };
  const auto one = of(1), three = of(3);
  EXPECT_EQ(one.re, three.re);
  EXPECT_EQ(one.im, three.im);
  const auto a = estimate_responses(one, choice, Estimator::h1),
             b = estimate_responses(three, choice, Estimator::h1);
  ASSERT_EQ(a.lines(), b.lines());
  EXPECT_EQ(a.H, b.H);
  EXPECT_EQ(a.noise, b.noise);
  EXPECT_EQ(a.condition, b.condition);
}

TEST(Spectra, ManyBlocksAreTheSumOfEach) {
  // more blocks than are taken at a time, some with a missing sample, and an odd number of channels
  auto record = noise_record(64 * 40, 3, 13);
  record.samples(64 * 7 + 5, 2) = record.samples(64 * 22, 0) =
      std::numeric_limits<double>::quiet_NaN();
  const SpectrumOptions options{.block_length = 64, .overlap = 0.0};
  const auto all = spectra_of(record, options);
  EXPECT_EQ(all.blocks, 38);
  EXPECT_EQ(all.blocks_left_out, 2);
  Eigen::MatrixXd re = Eigen::MatrixXd::Zero(33, 6), im = re;
  for (Index b = 0; b < 40; ++b) {
    if (b == 7 || b == 22) continue;
    const auto own = spectra_of(
        {.header = record.header, .samples = record.samples.middleRows(64 * b, 64)}, options);
    re += own.re / 38.0;
    im += own.im / 38.0;
  }
  // lines 0 and 1 hold what is left of a record's mean
  EXPECT_LT((all.re - re).bottomRows(31).norm(), 1e-14 * re.norm());
  EXPECT_LT((all.im - im).bottomRows(31).norm(), 1e-14 * re.norm());
}

TEST(Spectra, MeansOfRecordsAreTakenOut) {
  // two records that stand high; their blocks have means of their own
  const int n = 64, blocks = 37;
  for (const Window window : {Window::hann, Window::rectangular, Window::flat_top}) {
    const SpectrumOptions options{.block_length = n, .overlap = 0.0, .window = window};
    const auto first = noise_record(n * blocks, 2, 21);
    SpectrumEstimator estimator(first.header, options);
    const Eigen::VectorXd w = window_samples(window, n);
    Eigen::MatrixXcd expected[4];
    for (auto& S : expected) S = Eigen::MatrixXcd::Zero(2, 2);
    for (const double offset : {731.0, -52.0}) {
      data::Samples x = first.samples.array() + offset;
      if (offset < 0.0) x.col(0) *= 3.0;
      estimator.begin_record();
      estimator.add(x);
      const Eigen::MatrixXd left = x.rowwise() - x.colwise().mean();
      for (Index b = 0; b < blocks; ++b)
        for (int k = 0; k < 4; ++k) {
          Eigen::Vector2cd z = Eigen::Vector2cd::Zero();
          for (Index t = 0; t < n; ++t)
            z += w[t] * std::polar(1.0, -two_pi * static_cast<double>(k * t) / n) *
                 left.row(n * b + t).transpose();
          expected[k] +=
              (k == 0 ? 1.0 : 2.0) / (37.0 * w.squaredNorm()) / (2.0 * blocks) * z * z.adjoint();
        }
    }
    const auto s = estimator.result();
    for (int k = 0; k < 4; ++k)
      EXPECT_LT((s.at(k) - expected[k]).norm(), 1e-10 * expected[k].norm())
          << window_text(window) << k;
  }
}

TEST(Spectra, BlocksWithMissingSamplesAreLeftOut) {
  auto record = noise_record(1024, 2, 5);
  record.samples(300, 1) = std::numeric_limits<double>::quiet_NaN();
  const auto s = spectra_of(record, {.block_length = 128, .overlap = 0.0});
  EXPECT_EQ(s.blocks, 7);
  EXPECT_EQ(s.blocks_left_out, 1);
  EXPECT_EQ(s.health[1].missing, 1);
  EXPECT_TRUE(s.re.allFinite());
}

TEST(Spectra, NoBlockReachesOverTheBorderOfTwoRecords) {
  const auto record = noise_record(300, 1, 5);
  SpectrumEstimator estimator(record.header, {.block_length = 128, .overlap = 0.0});
  for (int repeat = 0; repeat < 3; ++repeat) {
    estimator.begin_record(44);
    estimator.add(record.samples);
  }
  const auto s = estimator.result();
  EXPECT_EQ(s.blocks, 6);  // 256 of 300 − 44 each
  EXPECT_EQ(s.records, 3);
}

TEST(Spectra, SamplesAtALimitAreCounted) {
  auto record = noise_record(20000, 2, 9);
  record.samples.col(0) = record.samples.col(0).cwiseMin(1.0).eval();
  const auto s = spectra_of(record, {.block_length = 512});
  EXPECT_GT(s.health[0].at_limit, 20);
  EXPECT_EQ(s.health[1].at_limit, 0);  // once at the highest value, once next to it: no limit
  EXPECT_EQ(s.health[0].highest, 1.0);
}

TEST(Spectra, CoarseStepsAreNoLimit) {
  auto record = noise_record(20000, 2, 9);  // within ±4: six to nine steps
  record.samples = (record.samples.array() / 0.7).round() * 0.7;
  record.samples.col(1) = record.samples.col(1).cwiseMax(-0.7).eval();
  const auto s = spectra_of(record, {.block_length = 512});
  EXPECT_LT(s.health[0].at_limit, 10);
  EXPECT_GT(s.health[1].at_limit, 5000);
}

/// Noise of variance 1 through three low-pass filters with their corner at this share of the sample
/// rate; 0: white.
Eigen::VectorXd slow_noise(double corner, std::uint64_t seed) {
  Eigen::VectorXd x = noise_record(1 << 16, 1, seed).samples.col(0);
  const double step = corner > 0.0 ? 1.0 - std::exp(-two_pi * corner) : 1.0;
  for (int pass = 0; pass < 3; ++pass) {
    double y = 0.0;
    for (double& sample : x) sample = y += step * (sample - y);
  }
  return x * (std::sqrt(static_cast<double>(x.size())) / x.norm());
}

/// 0: no steps.
Eigen::VectorXd in_steps(const Eigen::VectorXd& x, double step) {
  return step > 0.0 ? Eigen::VectorXd((x.array() / step).round() * step) : x;
}

ChannelHealth health_of(const Eigen::VectorXd& x) {
  data::Record record{.header = test::header_of(1, 0, 37.0), .samples = x};
  return spectra_of(record, {.block_length = 512}).health[0];
}

TEST(Spectra, StepsOfTheResolutionAreNoLimit) {
  for (const double corner : {0.0, 0.05, 0.005, 0.0015})
    for (const double levels : {1.0, 2.0, 5.0, 20.0, 100.0})
      for (std::uint64_t seed = 1; seed <= 3; ++seed)
        EXPECT_LT(health_of(in_steps(slow_noise(corner, seed), 1.0 / levels)).at_limit, 10)
            << corner << " " << levels << " " << seed;
}

TEST(Spectra, StepsOfAShortRecordAreNoLimit) {
  const Eigen::VectorXd x = in_steps(slow_noise(0.05, 7), 0.5);
  for (Index at = 0; at + 256 <= x.size(); at += 256)
    EXPECT_LT(health_of(x.segment(at, 256)).at_limit, 10) << at;
}

TEST(Spectra, RoundedTopsAreNoLimit) {
  Eigen::VectorXd sine(1 << 16), sweep(1 << 16);
  for (const double amplitude : {5.7, 10.3, 20.45, 300.3}) {
    for (Index k = 0; k < sine.size(); ++k) {
      const auto t = static_cast<double>(k);
      sine[k] = amplitude * std::sin(two_pi * 0.01337 * t + 0.3);
      sweep[k] = amplitude * std::sin(two_pi * (1e-4 + 7.1e-7 * t) * t + 0.3);
    }
    EXPECT_LT(health_of(in_steps(sine, 1.0)).at_limit, 10) << amplitude;
    EXPECT_LT(health_of(in_steps(sweep, 1.0)).at_limit, 10) << amplitude;
  }
}

TEST(Spectra, WhatWasCutOffIsCounted) {
  const auto expect_all = [](const Eigen::VectorXd& x, const std::string& what) {
    const auto at_end = (x.array() == x.maxCoeff()).count() + (x.array() == x.minCoeff()).count();
    EXPECT_EQ(health_of(x).at_limit, at_end) << what;
  };
  Eigen::VectorXd sine(30011);
  for (Index k = 0; k < sine.size(); ++k)
    sine[k] = std::sin(two_pi * 0.01337 * static_cast<double>(k) + 0.3);
  for (const double step : {0.0, 1e-4, 0.01, 0.05})
    for (const double limit : {0.75, 0.85, 0.9})
      expect_all(in_steps(sine, step).cwiseMin(limit).cwiseMax(-limit),
                 "sine, steps of " + std::to_string(step) + " up to " + std::to_string(limit));
  for (const double corner : {0.0, 0.05, 0.005})
    for (const double step : {0.0, 0.01, 0.05, 0.2})
      for (const double limit : {1.0, 2.0})
        expect_all(in_steps(slow_noise(corner, 4), step).cwiseMin(limit).cwiseMax(-limit),
                   "noise of " + std::to_string(corner) + ", steps of " + std::to_string(step) +
                       " up to " + std::to_string(limit));
  // converters of 12 bits, one that stands off its middle
  const double bit = 10.0 / 2048.0;
  const Eigen::VectorXd input = 3.7 * slow_noise(0.05, 6);
  const auto converted = [&](double offset) {
    return in_steps(input.array() + offset, bit).cwiseMin(10.0 - bit).cwiseMax(-10.0).eval();
  };
  expect_all(converted(0.0), "saturated at both ends");
  const Eigen::VectorXd one = converted(4.4);
  EXPECT_EQ(health_of(one).at_limit, (one.array() == one.maxCoeff()).count());
}

TEST(Spectra, AChannelThatStandsStillIsAtNoLimit) {
  const auto health = health_of(Eigen::VectorXd::Constant(4099, -0.37));
  EXPECT_TRUE(health.constant());
  EXPECT_EQ(health.at_limit, 0);
}

TEST(Spectra, PeriodsTellSignalFromNoise) {
  // a periodic signal of 200 samples, and the same with noise of variance 0.09
  data::Record record{.header = test::header_of(2, 0, 100.0), .samples = data::Samples(4000, 2)};
  test::Random random(21);
  for (int t = 0; t < 4000; ++t) {
    const double x = std::sin(two_pi * 7 * t / 200.0) + 0.5 * std::cos(two_pi * 12 * t / 200.0);
    record.samples.row(t) << x, x + 0.3 * test::normal(random);
  }
  EXPECT_EQ(period_of(record.samples.col(0)), 200);
  EXPECT_EQ(period_of(record.samples.col(1)), 0);
  EXPECT_EQ(period_of(noise_record(4000, 1, 3).samples.col(0)), 0);
  const auto s = spectra_of(record, {.block_length = 200, .periodic = true});
  EXPECT_EQ(s.blocks, 20);
  EXPECT_NEAR(s.at(7)(0, 0).real() * 0.5, 0.5, 1e-12);  // mean square of a sine
  double noise = 0.0;
  for (Index k = 1; k < 100; ++k) noise += s.noise_at(k)(1, 1).real() / 99.0;
  EXPECT_NEAR(noise * 100.0 / 2.0, 0.09, 0.09 * 3.0 / std::sqrt(99.0 * 19.0));
}

TEST(Spectra, MissingSamplesHideNoPeriod) {
  Eigen::VectorXd x = noise_record(211, 1, 8).samples.col(0).replicate(19, 1);
  Eigen::VectorXd noise = noise_record(4000, 1, 3).samples.col(0);
  for (const Index k : {0, 1, 2, 1300, 3001}) {
    x[k] = std::numeric_limits<double>::quiet_NaN();
    noise[k] = std::numeric_limits<double>::infinity();
  }
  EXPECT_EQ(period_of(x), 211);
  EXPECT_EQ(period_of(noise), 0);
  EXPECT_EQ(period_of(Eigen::VectorXd::Constant(500, std::nan(""))), 0);
}

/// A transform of the record's own length takes minutes where that has a large prime factor.
TEST(Spectra, APrimeNumberOfSamplesTakesNoLonger) {
  constexpr int twice_a_prime = 2 * 57347, even = 114688;
  const auto seconds = [](const Eigen::VectorXd& x, std::int64_t expected) {
    const auto begin = std::clock();
    EXPECT_EQ(period_of(x), expected);
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  const Eigen::VectorXd noise = noise_record(twice_a_prime, 1, 3).samples.col(0);
  EXPECT_LT(seconds(noise, 0), 10.0 * seconds(noise.head(even), 0));
  const Eigen::VectorXd repeated = noise.head(1000).replicate(115, 1);
  seconds(repeated.head(twice_a_prime), 1000);
}

TEST(Spectra, OptionsThatMakeNoSenseAreRefused) {
  const auto header = test::header_of(1, 0, 1.0);
  EXPECT_THROW(SpectrumEstimator(header, {.block_length = 7}), std::invalid_argument);
  EXPECT_THROW(SpectrumEstimator(header, {.block_length = 0}), std::invalid_argument);
  EXPECT_THROW(SpectrumEstimator(header, {.block_length = 64, .overlap = 1.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::identification
