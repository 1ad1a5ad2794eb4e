#pragma once
/// Quantiles of the distributions that intervals are made of (Boost.Math).
///
/// The median of a list.
///
/// Normally distributed random numbers, the same on every machine with the same libm.
///
/// The standard fixes std::mt19937_64 to the bit but leaves its distributions open, so Marsaglia's
/// polar method is written out.

#include <cstdint>
#include <random>
#include <vector>

namespace hydrapod::numerics {

/// Half width of a 95 % interval of a normal distribution, in standard deviations.
inline constexpr double normal_half_width = 1.959963984540054;

/// The same of Student's distribution; `degrees` ≤ 0: of the normal distribution.
double student_half_width(int degrees);

/// x with P(χ² ≤ x) = `probability`, `degrees` ≥ 1.
double chi_squared_quantile(double probability, int degrees);

/// x with P(F ≤ x) = `probability`, F with `numerator` and `denominator` > 0 degrees of freedom.
double fisher_quantile(double probability, double numerator, double denominator);

/// The middle one of the sorted values, of two the larger. There must be one.
double upper_median(std::vector<double> values);

class Gaussian {
 public:
  /// Different `stream`s of one seed are independent.
  explicit Gaussian(std::uint64_t seed, std::uint64_t stream = 0);
  /// Mean 0, variance 1.
  double operator()();
  /// In [0, 1), 53 random bits.
  double uniform();

 private:
  std::mt19937_64 engine_;
  double spare_{};
  bool has_spare_{};
};

}  // namespace hydrapod::numerics
