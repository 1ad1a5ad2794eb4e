#pragma once
/// Harmonic balance of a guide ring by a sum over the period.

#include <cmath>
#include <numbers>

namespace hydrapod::test {

/// Part at ω of the ring's force on a rod that swings by `amplitude` about the middle, over the
/// amplitude [N/m]: the ramp k_c h(|d| − gap), rounded over gap/10.
inline double ring_stiffness(double amplitude, double gap, double k_c) {
  const double w = 0.1 * gap;
  const auto h = [&](double x) {
    const double t = x / w;
    return t <= -1.0 ? 0.0 : t >= 1.0 ? x : w * std::pow(t + 1.0, 3) * (3.0 - t) / 16.0;
  };
  constexpr int points = 20000;
  double sum = 0.0;
  for (int k = 0; k < points; ++k) {
    const double c = std::cos(2.0 * std::numbers::pi * (k + 0.5) / points);
    sum += std::copysign(k_c * h(amplitude * std::abs(c) - gap), c) * c;
  }
  return 2.0 * sum / (points * amplitude);
}

}  // namespace hydrapod::test
