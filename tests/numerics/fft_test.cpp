/// Transforms against the sum that defines them.

#include "hydrapod/numerics/fft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "support/random.hpp"

namespace hydrapod::numerics {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> defined(const std::vector<double>& x) {
  const auto n = static_cast<int>(x.size());
  std::vector<Complex> lines;
  for (int k = 0; k <= n / 2; ++k) {
    Complex sum = 0.0;
    for (int t = 0; t < n; ++t)
      sum += x[static_cast<size_t>(t)] * std::polar(1.0, -2.0 * std::numbers::pi * (k * t % n) / n);
    lines.push_back(sum);
  }
  return lines;
}

std::vector<double> noise(int n, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<double> x(static_cast<size_t>(n));
  for (double& v : x) v = random.uniform(-1.0, 1.0);
  return x;
}

class Length : public testing::TestWithParam<int> {
 protected:
  /// Rounding of a fast transform grows with log n, that of the sum with n.
  [[nodiscard]] double tolerance() const { return 4e-16 * GetParam() * std::sqrt(GetParam()); }
};

TEST_P(Length, ForwardIsTheSum) {
  const auto x = noise(GetParam(), 3);
  RealFft fft(GetParam());
  std::vector<Complex> lines(static_cast<size_t>(fft.lines()));
  fft.forward(x, lines);
  const auto expected = defined(x);
  for (size_t k = 0; k < lines.size(); ++k)
    EXPECT_LT(std::abs(lines[k] - expected[k]), tolerance()) << k;
}

TEST_P(Length, InverseUndoesForward) {
  const auto x = noise(GetParam(), 4);
  RealFft fft(GetParam());
  std::vector<Complex> lines(static_cast<size_t>(fft.lines()));
  std::vector<double> back(x.size());
  fft.forward(x, lines);
  fft.inverse(lines, back);
  for (size_t t = 0; t < x.size(); ++t) EXPECT_NEAR(back[t], x[t], 1e-14);
}

TEST_P(Length, ManyChannelsAreEachTheirOwnTransform) {
  RealFft fft(GetParam());
  RealFft::Block block(GetParam(), 7);  // no multiple of the lanes
  for (int c = 0; c < 7; ++c) {
    const auto x = noise(GetParam(), 10 + static_cast<std::uint64_t>(c));
    block.col(c) = Eigen::VectorXd::Map(x.data(), GetParam());
  }
  Eigen::RowVectorXd mean(7);
  Eigen::VectorXd window(GetParam());
  for (int c = 0; c < 7; ++c) mean[c] = 0.1 * c - 0.2;
  for (int t = 0; t < GetParam(); ++t) window[t] = 1.0 + 0.3 * std::cos(1.7 * t);
  constexpr int apart = 9;  // room for two channels more
  std::vector<EightLines> lines(static_cast<size_t>(apart * fft.line_groups()));
  for (auto& eight : lines) eight.re.fill(7.0);
  fft.forward(block, mean, window, lines.data(), apart);
  for (int c = 0; c < 7; ++c) {
    auto x = noise(GetParam(), 10 + static_cast<std::uint64_t>(c));
    for (int t = 0; t < GetParam(); ++t)
      x[static_cast<size_t>(t)] = (x[static_cast<size_t>(t)] - mean[c]) * window[t];
    auto expected = defined(x);
    expected.resize(8 * static_cast<size_t>(fft.line_groups()));  // nothing beyond n/2
    for (size_t k = 0; k < expected.size(); ++k) {
      const auto& eight = lines[k / 8 * apart + static_cast<size_t>(c)];
      EXPECT_LT(std::abs(Complex(eight.re[k % 8], eight.im[k % 8]) - expected[k]), tolerance())
          << c << ' ' << k;
    }
  }
  for (size_t g = 0; g < lines.size(); g += apart) EXPECT_EQ(lines[g + 7].re[0], 7.0);
}

/// Whatever else is in the registers: bit for bit.
TEST_P(Length, AStripsLinesAreItsOwn) {
  RealFft fft(GetParam());
  RealFft::Block block(GetParam(), 12);
  for (int c = 0; c < 12; ++c) {
    const auto x = noise(GetParam(), 30 + static_cast<std::uint64_t>(c));
    block.col(c) = Eigen::VectorXd::Map(x.data(), GetParam());
  }
  const Eigen::RowVectorXd mean = block.colwise().mean();
  const Eigen::VectorXd window = Eigen::VectorXd::LinSpaced(GetParam(), 0.1, 1.0);
  const auto size = 12 * static_cast<size_t>(fft.line_groups());
  std::vector<EightLines> together(size), alone(size);
  fft.forward(block, mean, window, together.data(), 12);
  for (int c = 0; c < 12; c += 4) {
    const Strip strip{block.data() + c, 12, mean.data() + c, 4, alone.data() + c};
    fft.forward(std::span(&strip, 1), window, 12);
  }
  for (size_t k = 0; k < size; ++k) {
    EXPECT_EQ(together[k].re, alone[k].re);
    EXPECT_EQ(together[k].im, alone[k].im);
  }
}

INSTANTIATE_TEST_SUITE_P(Any, Length,
                         testing::Values(2, 4, 8, 16, 32, 64, 6, 10, 14, 26, 90, 256, 512, 1024,
                                         2048));

TEST(Fft, PowersOfSeriesAreThoseOfTheSum) {
  for (const int n : {2, 8, 32, 256, 512}) {
    test::Random random(9);
    Eigen::MatrixXcd series(std::max(1, n / 4 - 1), 11);  // no multiple of the lanes
    for (auto& x : series.reshaped()) x = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
    const auto powers = SeriesFft(n).powers(series);
    for (Eigen::Index c = 0; c < series.cols(); ++c) {
      std::vector<Complex> padded(static_cast<size_t>(n));
      Eigen::VectorXcd::Map(padded.data(), series.rows()) = series.col(c);
      const auto lines = complex_fft(padded);
      for (Eigen::Index k = 0; k < n; ++k)
        EXPECT_NEAR(powers(k, c), std::norm(lines[static_cast<size_t>(k)]), 1e-13 * n);
    }
  }
}

TEST(Fft, ComplexIsTheSum) {
  const int n = 15;
  test::Random random(8);
  std::vector<Complex> x(n);
  for (auto& v : x) v = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
  const auto lines = complex_fft(x);
  for (int k = 0; k < n; ++k) {
    Complex sum = 0.0;
    for (int t = 0; t < n; ++t)
      sum += x[static_cast<size_t>(t)] * std::polar(1.0, -2.0 * std::numbers::pi * k * t / n);
    EXPECT_LT(std::abs(lines[static_cast<size_t>(k)] - sum), 1e-13);
  }
  const auto back = inverse_complex_fft(lines);
  for (size_t t = 0; t < x.size(); ++t)
    EXPECT_LT(std::abs(back[t] - static_cast<double>(n) * x[t]), 1e-13 * n);
}

TEST(Fft, OddAndEmptyLengthsAreRefused) {
  EXPECT_THROW(RealFft(7), std::invalid_argument);
  EXPECT_THROW(RealFft(0), std::invalid_argument);
  EXPECT_THROW(complex_fft({}), std::invalid_argument);
  EXPECT_THROW(SeriesFft(12), std::invalid_argument);
  EXPECT_THROW(SeriesFft(1), std::invalid_argument);
  EXPECT_THROW((void)SeriesFft(4).powers(Eigen::MatrixXcd::Zero(5, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace hydrapod::numerics
