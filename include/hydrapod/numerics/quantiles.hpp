#pragma once
/// Quantiles of the distributions that intervals are made of (Boost.Math).

namespace hydrapod::numerics {

/// Half width of a 95 % interval of a normal distribution, in standard deviations.
inline constexpr double normal_half_width = 1.959963984540054;

/// The same of Student's distribution; `degrees` ≤ 0: of the normal distribution.
double student_half_width(int degrees);

/// x with P(χ² ≤ x) = `probability`, `degrees` ≥ 1.
double chi_squared_quantile(double probability, int degrees);

/// x with P(F ≤ x) = `probability`, F with `numerator` and `denominator` > 0 degrees of freedom.
double fisher_quantile(double probability, double numerator, double denominator);

}  // namespace hydrapod::numerics
