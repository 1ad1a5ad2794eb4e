#include <cmath>
#include <numbers>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

namespace {

constexpr double pi = std::numbers::pi;
constexpr int points = 1024;  // of half a period: the law turns within a few where strokes are long

/// Half a period of x = A cos ωt from x = A on, with v < 0: the sums of F cos θ and F sin θ, and
/// the bend of the bristles at its end.
struct Stroke {
  double cosine{}, sine{}, z{};

  Stroke(const Friction& friction, double amplitude, double omega, double z_0) : z(z_0) {
    const double step = pi / points;
    for (int k = 0; k < points; ++k) {
      const double theta = step * (k + 0.5);
      const double v = -amplitude * omega * std::sin(theta);
      const double force = friction.has_bristles() ? bristles(friction, v, step / omega)
                                                   : smooth_friction(friction, v);
      cosine += force * std::cos(theta) * step;
      sine += force * std::sin(theta) * step;
    }
  }

 private:
  /// ż = v − σ0 |v| z/g over a step of constant velocity, exactly; the force in the middle of it.
  double bristles(const Friction& friction, double v, double time) {
    const double g = sliding_force(friction, v);
    const double end = std::copysign(g / friction.bristle_stiffness, v);
    const double half = std::exp(-0.5 * friction.bristle_stiffness * std::abs(v) / g * time);
    const double middle = end + (z - end) * half;
    z = end + (middle - end) * half;
    return bristle_friction(friction, v, middle).force;
  }
};

}  // namespace

/// The way back mirrors the way there. The bend after a stroke depends on that before linearly, so
/// that the one which comes back mirrored follows from two strokes.
Equivalent friction_equivalent(Friction friction, double amplitude, double omega) {
  friction.viscous = 0.0;
  double z_0 = 0.0;
  if (friction.has_bristles()) {
    const double unit = friction.breakaway / friction.bristle_stiffness;
    const double of_zero = Stroke(friction, amplitude, omega, 0.0).z;
    const double of_unit = Stroke(friction, amplitude, omega, unit).z;
    z_0 = -of_zero / (1.0 + (of_unit - of_zero) / unit);
  }
  const Stroke stroke(friction, amplitude, omega, z_0);
  return {2.0 * stroke.cosine / (pi * amplitude), -2.0 * stroke.sine / (pi * amplitude * omega)};
}

}  // namespace hydrapod::hydraulics
