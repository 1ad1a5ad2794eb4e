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
  Lines lines;
  fft.forward(block, lines);
  ASSERT_EQ(lines.re.rows(), fft.lines());
  ASSERT_EQ(lines.re.cols(), 7);
  for (int c = 0; c < 7; ++c) {
    const auto expected = defined(noise(GetParam(), 10 + static_cast<std::uint64_t>(c)));
    for (int k = 0; k < fft.lines(); ++k)
      EXPECT_LT(
          std::abs(Complex(lines.re(k, c), lines.im(k, c)) - expected[static_cast<size_t>(k)]),
          tolerance())
          << c << ' ' << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Any, Length,
                         testing::Values(2, 4, 8, 16, 32, 64, 6, 10, 26, 90, 256, 512));

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
}

}  // namespace
}  // namespace hydrapod::numerics
