#pragma once
/// Oil in a chamber: how its pressure follows from the flow into it.
///
///     ṗ = β(p) / V · (Q − V̇)
///     1/β(p) = [(1 − α)/β + α x/(n p)] / [(1 − α) + α x] + 0.001 exp(−(p − p_c)/p_w) / p_w
///     x = (p_0 / p)^(1/n),   p_w = p_c / 10
///
/// The first part is oil of modulus β with the share α of air at atmospheric pressure p_0 (exponent
/// n), at the pressure that the chamber has now. The second is vapour: at the cavitation pressure
/// p_c it fills 0.1 % of the chamber, which can then be torn open to twenty times its volume before
/// the pressure is zero. It gives back what it took, and is lost in rounding from p_c + 40 p_w on.

#include <algorithm>
#include <cmath>

#include "hydrapod/hydraulics/oil_spring.hpp"

namespace hydrapod::hydraulics {

/// A liquid with everything resolved; made by servo_axis().
struct Oil {
  double bulk_modulus{};         ///< β [Pa] without air
  double air_fraction{};         ///< α
  double air_exponent{1.4};      ///< n
  double cavitation_pressure{};  ///< p_c [Pa]
};

/// Compressibility 1/β(p) [1/Pa] at the absolute pressure `p` [Pa].
inline double compressibility(const Oil& oil, double p) {
  constexpr double widths = 40.0;  // from here on vapour is lost in rounding
  constexpr double share = 1e-3;  // of the chamber, at the cavitation pressure
  const double width = oil.cavitation_pressure / 10.0;
  double sum = 1.0 / oil.bulk_modulus;
  if (oil.air_fraction > 0.0) {
    // Below the cavitation pressure the air is taken to stay as it is there.
    const double at = std::max(p, oil.cavitation_pressure);
    const double x = oil.air_fraction * std::pow(atmospheric_pressure / at, 1.0 / oil.air_exponent);
    const double liquid = 1.0 - oil.air_fraction;
    sum = (liquid / oil.bulk_modulus + x / (oil.air_exponent * at)) / (liquid + x);
  }
  const double above = (p - oil.cavitation_pressure) / width;
  return above > widths ? sum : sum + share * std::exp(-above) / width;
}

}  // namespace hydrapod::hydraulics
