#pragma once
/// Mean and variance of the finite samples of a channel. Private to the module.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hydrapod::identification {

/// Values from the first one on, so that an offset costs no digits.
struct SampleSums {
  double origin{}, sum{}, squares{};
  std::int64_t count{};

  /// A negative weight takes samples out again.
  void add(double x, std::int64_t weight = 1) {
    if (!std::isfinite(x)) return;
    if (count == 0) origin = x;
    const double from_origin = x - origin, n = static_cast<double>(weight);
    count += weight;
    sum += n * from_origin;
    squares += n * from_origin * from_origin;
  }
  [[nodiscard]] double mean() const { return origin + sum / static_cast<double>(count); }
  [[nodiscard]] double variance() const {
    const auto n = static_cast<double>(std::max<std::int64_t>(1, count));
    return std::max(0.0, squares / n - std::pow(sum / n, 2));
  }
  [[nodiscard]] double rms() const { return std::sqrt(variance()); }
};

}  // namespace hydrapod::identification
