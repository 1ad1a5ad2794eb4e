#pragma once
/// Cross-sections of rods and tubes.

#include <cmath>
#include <numbers>
#include <optional>

namespace hydrapod::dynamics {

struct Section {
  double area{};           ///< A [m²]
  double second_moment{};  ///< I [m⁴]
};

/// Solid without a wall.
inline Section round_section(double diameter, std::optional<double> wall) {
  using std::numbers::pi;
  const double inside = wall ? diameter - 2.0 * *wall : 0.0;
  return {pi / 4.0 * (diameter * diameter - inside * inside),
          pi / 64.0 * (std::pow(diameter, 4) - std::pow(inside, 4))};
}

}  // namespace hydrapod::dynamics
