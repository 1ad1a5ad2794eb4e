#pragma once
/// Friction of a leg's joint that sticks before it slides, against turning in two directions
/// (docs/theory/nonlinear.md, "Joints that stick").
///
///     ż = w − σ0 |w| z / T_c,     T = σ0 z + σ1 ż
///
/// w [rad/s] is the rate at which the joint turns across the leg's axis, z [rad] the bend of the
/// bristles, T [N m] the torque against w. Along one direction it is LuGre's law of the seals
/// without Stribeck's part; turned by an angle, w and z give T turned by it.

#include "hydrapod/dynamics/nonlinear.hpp"

namespace hydrapod::simulation {

struct JointBristles {
  using Vector2 = dynamics::Vector2;
  double coulomb{};    ///< T_c [N m]; infinite: they only stick
  double stiffness{};  ///< σ0 [N m/rad]
  double damping{};    ///< σ1 [N m s/rad]

  [[nodiscard]] bool stick() const { return coulomb > 0.0 && stiffness > 0.0; }

  struct Bent {
    Vector2 rate{}, torque{};  ///< ż, T
  };
  [[nodiscard]] Bent bend(const Vector2& w, const Vector2& z) const {
    const Vector2 rate = w - (stiffness * w.norm() / coulomb) * z;
    return {rate, stiffness * z + damping * rate};
  }
  /// ½ σ0 |z|² [J].
  [[nodiscard]] double energy(const Vector2& z) const { return 0.5 * stiffness * z.squaredNorm(); }
};

inline JointBristles joint_bristles(const model::JointFriction& given) {
  return {given.coulomb, given.bristle_stiffness.value_or(0.0), given.bristle_damping};
}

}  // namespace hydrapod::simulation
