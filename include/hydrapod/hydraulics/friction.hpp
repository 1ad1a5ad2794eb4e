#pragma once
/// Friction of a cylinder's seals along its axis, in two ways.
///
/// Smooth (Stribeck):   F = [F_c + (F_s − F_c) exp(−(v/v_s)²)] tanh(v/v_0) + b v
/// Bristles (LuGre; Canudas de Wit et al., IEEE TAC 1995):
///     ż = v − σ0 |v| z / g(v),   g = F_c + (F_s − F_c) exp(−(v/v_s)²)
///     F = σ0 z + σ1 ż + b v
///
/// F [N] is the force against the motion v [m/s]. The smooth law creeps under a load below F_s with
/// a velocity of about v_0; bristles stick.

#include <cmath>

namespace hydrapod::hydraulics {

/// Friction with everything resolved; made by servo_axis().
struct Friction {
  double coulomb{};              ///< F_c [N]
  double breakaway{};            ///< F_s [N]
  double stribeck_velocity{1};   ///< v_s [m/s]
  double smoothing_velocity{1};  ///< v_0 [m/s]
  double viscous{};              ///< b [N s/m]
  double bristle_stiffness{};    ///< σ0 [N/m]; 0: the smooth law
  double bristle_damping{};      ///< σ1 [N s/m]

  [[nodiscard]] bool has_bristles() const { return bristle_stiffness > 0.0; }
};

/// g(v) [N]: what sliding takes at the velocity `v`.
inline double sliding_force(const Friction& friction, double v) {
  if (friction.breakaway == friction.coulomb) return friction.coulomb;
  const double ratio = v / friction.stribeck_velocity;
  return friction.coulomb + (friction.breakaway - friction.coulomb) * std::exp(-ratio * ratio);
}

/// F [N] of the smooth law.
inline double smooth_friction(const Friction& friction, double v) {
  if (friction.breakaway == 0.0) return friction.viscous * v;
  return sliding_force(friction, v) * std::tanh(v / friction.smoothing_velocity) +
         friction.viscous * v;
}

/// ż [m/s] and F [N] of bristles bent by `z` [m].
struct BristleFriction {
  double rate{}, force{};
};
inline BristleFriction bristle_friction(const Friction& friction, double v, double z) {
  const double sliding = sliding_force(friction, v);
  const double rate =
      sliding > 0.0 ? v - friction.bristle_stiffness * std::abs(v) * z / sliding : 0.0;
  return {rate,
          friction.bristle_stiffness * z + friction.bristle_damping * rate + friction.viscous * v};
}

}  // namespace hydrapod::hydraulics
