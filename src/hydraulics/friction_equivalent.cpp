#include <array>
#include <cmath>
#include <numbers>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

namespace {

constexpr double pi = std::numbers::pi;
/// A point θ of half a period and what belongs to it.
struct Node {
  double cosine{}, sine{};
  double weight{};  ///< dθ
  double way_to{},
      way_on{};  ///< of x/A from the end of the interval before, and to that of its own
};

/// The midpoint rule in u of θ = π (u − sin(2πu)/2π), u from 0 to 1: exact for smooth laws, and
/// close to the reversals, where the law turns if strokes are long.
std::array<Node, 256> half_period() {
  std::array<Node, 256> nodes;
  const auto theta_at = [](double u) { return pi * u - 0.5 * std::sin(2.0 * pi * u); };
  const double step = 1.0 / static_cast<double>(nodes.size());
  double before = 1.0, u = 0.5 * step;
  for (auto& node : nodes) {
    const double theta = theta_at(u), after = std::cos(theta_at(u + 0.5 * step));
    node = {.cosine = std::cos(theta),
            .sine = std::sin(theta),
            .weight = 2.0 * pi * std::pow(std::sin(pi * u), 2) * step};
    node.way_to = before - node.cosine;
    node.way_on = node.cosine - after;
    before = after;
    u += step;
  }
  return nodes;
}

/// Half a period of x = A cos ωt from x = A on, with v < 0: the sums of F cos θ and F sin θ, the
/// bend of the bristles at its end, and the share of the first bend that is left in it.
struct Stroke {
  double cosine{}, sine{}, z{}, left{1.0};

  Stroke(const Friction& friction, double amplitude, double omega, double z_0) : z(z_0) {
    static const auto nodes = half_period();
    const bool has_bristles = friction.has_bristles();
    for (const auto& node : nodes) {
      const double v = -amplitude * omega * node.sine;
      if (has_bristles) bend(friction, v, amplitude * node.way_to);
      const double force =
          has_bristles ? bristle_friction(friction, v, z).force : smooth_friction(friction, v);
      if (has_bristles) bend(friction, v, amplitude * node.way_on);
      cosine += force * node.cosine * node.weight;
      sine += force * node.sine * node.weight;
    }
  }

 private:
  /// ż = v − σ0 |v| z/g over a way of constant g, exactly, also where z is far below g/σ0.
  void bend(const Friction& friction, double v, double way) {
    const double g = sliding_force(friction, v);
    const double loss = std::expm1(-friction.bristle_stiffness * way / g);
    z += (z - std::copysign(g / friction.bristle_stiffness, v)) * loss;
    left *= 1.0 + loss;
  }
};

}  // namespace

/// The way back mirrors the way there. The bend after a stroke depends on that before linearly, so
/// that the one which comes back mirrored follows from a stroke without any.
Equivalent friction_equivalent(Friction friction, double amplitude, double omega) {
  friction.viscous = 0.0;
  double z_0 = 0.0;
  if (friction.has_bristles()) {
    const Stroke from_zero(friction, amplitude, omega, 0.0);
    z_0 = -from_zero.z / (1.0 + from_zero.left);
  }
  const Stroke stroke(friction, amplitude, omega, z_0);
  return {2.0 * stroke.cosine / (pi * amplitude), -2.0 * stroke.sine / (pi * amplitude * omega)};
}

}  // namespace hydrapod::hydraulics
