/// Spectra, overviews and resampling against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/processing.hpp"
#include "support/random.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;

TEST(Welch, SumOfTheDensityIsTheVarianceOfASine) {
  constexpr double rate = 512.0, amplitude = 0.37;
  data::WelchSpectrum welch(1, rate, 1024);
  data::Samples samples(8192, 1);
  for (Eigen::Index k = 0; k < samples.rows(); ++k)
    samples(k, 0) = 5.0 + amplitude * std::sin(two_pi * 60.0 * static_cast<double>(k) / rate);
  welch.add(samples);
  const data::Spectrum spectrum = welch.result();
  EXPECT_EQ(spectrum.segments, 15);
  EXPECT_EQ(spectrum.frequency[2], 1.0);
  EXPECT_NEAR(spectrum.density.col(0).sum() * 0.5, amplitude * amplitude / 2.0, 1e-12);
  Eigen::Index strongest = 0;
  spectrum.density.col(0).maxCoeff(&strongest);
  EXPECT_EQ(spectrum.frequency[strongest], 60.0);
}

TEST(Welch, WhiteNoiseIsFlatAtItsVariance) {
  constexpr double rate = 100.0;
  Random random(4711);
  data::WelchSpectrum welch(1, rate, 256);
  data::Samples block(64, 1);
  for (int i = 0; i < 4000; ++i) {
    for (double& value : block.reshaped()) value = random.uniform(-1.0, 1.0);
    welch.add(block);
  }
  const data::Spectrum spectrum = welch.result();
  const double expected = (1.0 / 3.0) / (rate / 2.0);
  const double error = std::sqrt(1.1 / static_cast<double>(spectrum.segments));
  // 120 lines in the middle; five standard errors are passed by one in two million
  for (Eigen::Index k = 4; k < 124; ++k)
    EXPECT_NEAR(spectrum.density(k, 0), expected, 5.0 * error * expected);
}

/// The line at half the sample rate has no other half on the negative axis.
TEST(Welch, NothingIsCountedTwiceAtHalfTheSampleRate) {
  constexpr double amplitude = 0.43;
  data::WelchSpectrum welch(1, 64.0, 128);
  data::Samples samples(1024, 1);
  for (Eigen::Index k = 0; k < samples.rows(); ++k)
    samples(k, 0) = k % 2 == 0 ? amplitude : -amplitude;
  welch.add(samples);
  EXPECT_NEAR(welch.result().density.col(0).sum() * 0.5, amplitude * amplitude, 1e-12);
}

TEST(Overview, NumbersAreThoseOfTheirDefinitions) {
  data::RecordHeader header;
  header.channels = {{"a"}};
  header.sample_rate = 4.0;
  data::OverviewBuilder builder(header, 8);
  data::Samples samples(8, 1);
  const double infinite = std::numeric_limits<double>::infinity(), nan = std::nan("");
  samples.col(0) << 11.5, 9.5, infinite, 12.5, nan, 4.5, 10.5, nan;
  builder.add(samples);
  const auto all = builder.result();
  EXPECT_EQ(all.samples, 8);
  EXPECT_EQ(all.duration, 2.0);
  const auto& a = all.channels[0];
  EXPECT_EQ(a.samples, 5);
  EXPECT_EQ(a.missing, 2);
  EXPECT_EQ(a.infinite, 1);
  EXPECT_NEAR(a.mean, 9.7, 1e-14);
  EXPECT_NEAR(a.rms, std::sqrt((1.8 * 1.8 + 0.2 * 0.2 + 2.8 * 2.8 + 5.2 * 5.2 + 0.8 * 0.8) / 5.0),
              1e-14);
  EXPECT_EQ(a.lowest, 4.5);
  EXPECT_EQ(a.highest, 12.5);
  EXPECT_NEAR(a.peak, 5.2, 1e-14);  // below the mean it goes farther than above
  EXPECT_EQ(a.at_limit, 0);
  EXPECT_EQ(a.longest_hold, 1);
  EXPECT_FALSE(a.constant);
}

TEST(Overview, CountsWhatStandsStillAndWhatIsMissing) {
  data::RecordHeader header;
  header.channels = {{"a"}, {"b"}};
  header.sample_rate = 10.0;
  data::OverviewBuilder builder(header, 8);
  data::Samples samples(12, 2);
  const double nan = std::nan("");
  samples.col(0) << 0, 1, 2, 2, 2, 2, 1, 0, nan, -1, -1, 0;
  samples.col(1).setConstant(3.0);
  builder.add(samples.topRows(5));
  builder.add(samples.bottomRows(7));
  const auto all = builder.result();
  EXPECT_EQ(all.channels[0].samples, 11);
  EXPECT_EQ(all.channels[0].missing, 1);
  EXPECT_EQ(all.channels[0].at_limit, 4);  // the two at −1 are too few
  EXPECT_EQ(all.channels[0].longest_hold, 4);
  EXPECT_EQ(all.channels[0].highest, 2.0);
  EXPECT_EQ(all.channels[0].lowest, -1.0);
  EXPECT_NEAR(all.channels[0].mean, 8.0 / 11.0, 1e-15);
  EXPECT_TRUE(all.channels[1].constant);
  EXPECT_EQ(all.channels[1].rms, 0.0);
}

/// Largest value, away from the ends, of a sine of `frequency` resampled.
double resampled_level(double from, double to, double frequency) {
  data::Samples out;
  std::vector<double> values;
  data::Resampler resampler(1, from, to, [&](const auto& block) {
    values.insert(values.end(), block.data(), block.data() + block.rows());
  });
  const auto n = static_cast<Eigen::Index>(40.0 * std::max(from, from / to * 200.0));
  data::Samples in(n, 1);
  for (Eigen::Index k = 0; k < n; ++k)
    in(k, 0) = std::sin(two_pi * frequency * static_cast<double>(k) / from);
  resampler.add(in);
  resampler.finish();
  double largest = 0.0;
  const std::size_t margin = 200;
  for (std::size_t i = margin; i + margin < values.size(); ++i)
    largest = std::max(largest, std::abs(values[i]));
  return largest;
}

TEST(Resample, PassesWhatItMustAndStopsAliases) {
  constexpr double from = 100.0, to = 30.0;                 // Nyquist frequency 15 Hz
  EXPECT_NEAR(resampled_level(from, to, 1.37), 1.0, 1e-4);  // peaks fall between samples
  EXPECT_NEAR(resampled_level(from, to, 13.4), 1.0, 1e-3);
  for (const double above : {15.1, 20.3, 28.7, 44.1})
    EXPECT_LT(resampled_level(from, to, above), 1e-5);
}

TEST(Resample, BackAndForthIsTheSameSignal) {
  Random random(99);
  data::Samples in(3000, 2);
  // a band-limited signal: sines below 0.4 of the lower Nyquist frequency
  in.setZero();
  for (int line = 0; line < 20; ++line) {
    const double frequency = random.uniform(0.1, 8.0), phase = random.uniform(0.0, two_pi);
    for (Eigen::Index k = 0; k < in.rows(); ++k) {
      in(k, 0) += std::sin(two_pi * frequency * 0.01 * static_cast<double>(k) + phase);
      in(k, 1) += std::cos(two_pi * frequency * 0.01 * static_cast<double>(k) - phase);
    }
  }
  const auto through = [](const data::Samples& samples, double from, double to) {
    data::Samples all(0, samples.cols());
    data::Resampler resampler(2, from, to, [&](const auto& block) {
      all.conservativeResize(all.rows() + block.rows(), all.cols());
      all.bottomRows(block.rows()) = block;
    });
    for (Eigen::Index at = 0; at < samples.rows(); at += 71)
      resampler.add(samples.middleRows(at, std::min<Eigen::Index>(71, samples.rows() - at)));
    resampler.finish();
    return all;
  };
  const data::Samples there = through(in, 100.0, 48.3), back = through(there, 48.3, 100.0);
  ASSERT_GE(back.rows(), 2900);
  for (Eigen::Index k = 400; k < 2600; ++k)
    for (Eigen::Index c = 0; c < 2; ++c) EXPECT_NEAR(back(k, c), in(k, c), 20.0 * 2e-5);
}

}  // namespace
}  // namespace hydrapod::test
