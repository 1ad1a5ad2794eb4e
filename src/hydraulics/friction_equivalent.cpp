#include <cmath>
#include <numbers>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

Equivalent friction_equivalent(Friction friction, double amplitude, double omega) {
  friction.viscous = 0.0;
  constexpr int points_of_period = 4096;  // the law turns within a few of them where strokes are long
  const double step = 2.0 * std::numbers::pi / points_of_period;
  double z = 0.0, cosine = 0.0, sine = 0.0;
  constexpr int until_periodic = 2;  // bristles forget within the first stroke, or never slide
  for (int k = -until_periodic * points_of_period; k < points_of_period; ++k) {
    const double theta = step * (k + 0.5);
    const double v = -amplitude * omega * std::sin(theta);
    double force = 0.0;
    if (friction.has_bristles()) {
      // ż = v − σ0 |v| z / g, exactly over a step of constant velocity.
      const double g = sliding_force(friction, v);
      const double ends = std::copysign(g / friction.bristle_stiffness, v);
      const double kept = std::exp(-friction.bristle_stiffness * std::abs(v) / g * step / omega);
      const double before = z;
      z = ends + (z - ends) * kept;
      const double middle = 0.5 * (before + z);
      force = bristle_friction(friction, v, middle).force;
    } else {
      force = smooth_friction(friction, v);
    }
    if (k < 0) continue;
    cosine += force * std::cos(theta) * step;
    sine += force * std::sin(theta) * step;
  }
  return {cosine / (std::numbers::pi * amplitude), -sine / (std::numbers::pi * amplitude * omega)};
}

}  // namespace hydrapod::hydraulics
