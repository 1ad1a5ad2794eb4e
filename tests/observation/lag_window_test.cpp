/// The window's transform against quadrature of the sampled autocorrelation.

#include "hydrapod/observation/targets.hpp"

#include <gtest/gtest.h>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::observation {
namespace {

using Complex = std::complex<double>;
using identification::Window;

class OfWindow : public testing::TestWithParam<Window> {};

TEST_P(OfWindow, IsThatOfItsAutocorrelation) {
  constexpr int n = 8192;
  constexpr double rate = 4711.0, step = 1.0 / rate;
  const auto rho = identification::lag_taper(identification::window_samples(GetParam(), n));
  const auto window = lag_window(rho, rate);
  ASSERT_TRUE(window);
  EXPECT_DOUBLE_EQ(window->duration, n / rate);
  // the last is hardly any distance from a line
  for (const Complex pole :
       {Complex(-0.37, 41.0), Complex(-17.0, 53.0), Complex(-1.9, 0.0), Complex(-0.003, 40.31)})
    for (const Complex s : {Complex(0.0, 40.3), Complex(0.0, 77.0), Complex(0.61, 3.0)}) {
      // Simpson's rule; ρ is 0 at its end
      Complex sum = 0.0;
      for (int t = 0; t < n; ++t)
        sum += (t == 0 ? 1.0 : t % 2 == 1 ? 4.0 : 2.0) * rho[t] * std::exp((pole - s) * (t * step));
      sum *= step / 3.0;
      EXPECT_LT(std::abs(window->transform(pole, s) - sum), 1e-7 * std::abs(sum)) << pole << s;
    }
  // a pole at the line itself
  const Complex s(0.0, 19.0);
  EXPECT_NEAR(std::abs(window->transform(s, s) - window->transform(s * (1.0 + 1e-9), s)), 0.0,
              1e-6 * std::abs(window->transform(s, s)));
}

INSTANTIATE_TEST_SUITE_P(LagWindow, OfWindow,
                         testing::Values(Window::hann, Window::rectangular, Window::hamming,
                                         Window::blackman_harris, Window::flat_top,
                                         Window::blackman));

/// Two poles whose residues sum to zero, as those of a displacement do: the average of the
/// acceleration is the transform of its impulse response times ρ, which begins with a pulse.
TEST(LagWindow, OfAccelerationsIsThatOfTheirImpulseResponse) {
  constexpr int n = 16384;
  constexpr double rate = 9601.0, step = 1.0 / rate;
  const auto rho = identification::lag_taper(identification::window_samples(Window::hann, n));
  const auto window = lag_window(rho, rate, 2);
  ASSERT_TRUE(window);
  const Complex a(-1.3, 37.0), b = std::conj(a), residue = 1.0 / (a - b);
  const Complex s(0.0, 33.1);
  Complex sum = 0.0;
  for (int t = 0; t < n; ++t) {
    const double weight = (t == 0 ? 1.0 : t % 2 == 1 ? 4.0 : 2.0) * step / 3.0;
    const Complex h =
        residue * (a * a * std::exp(a * (t * step)) - b * b * std::exp(b * (t * step)));
    sum += weight * rho[t] * h * std::exp(-s * (t * step));
  }
  const Complex shown = residue * (window->of_pole(a, s) - window->of_pole(b, s));
  EXPECT_LT(std::abs(s * s * shown - (1.0 + sum)), 1e-7 * std::abs(sum));
}

TEST(LagWindow, IsNoneWhereItIsNoSumOfCosines) {
  Eigen::VectorXd odd =
      identification::lag_taper(identification::window_samples(Window::hann, 512));
  EXPECT_TRUE(lag_window(odd, 100.0));
  odd[37] += 1e-3;
  EXPECT_FALSE(lag_window(odd, 100.0));
  EXPECT_FALSE(lag_window(Eigen::VectorXd::Ones(3), 100.0));
  EXPECT_FALSE(lag_window(Eigen::VectorXd(), 100.0));
}

}  // namespace
}  // namespace hydrapod::observation
