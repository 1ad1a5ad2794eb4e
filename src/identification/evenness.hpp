#pragma once
/// How nearly constant the modulus of a Gaussian process is by chance. Private to the module.

#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"

namespace hydrapod::identification {

/// ln of the bound of the chance that J independent exponential numbers have a relative variance
/// below x: the share that a ball of radius √(x/J) has in the simplex Σ p = 1.
inline double log_chance_of_evenness(double J, double x) {
  const double n = J - 1.0, r = std::sqrt(x / J);
  const double ball =
      0.5 * n * std::log(0.5 * base::two_pi) + n * std::log(r) - std::lgamma(0.5 * n + 1.0);
  const double simplex = 0.5 * std::log(J) - std::lgamma(J);
  return std::min(0.0, ball - simplex);
}

}  // namespace hydrapod::identification
