#pragma once
/// The potential energy of one leg, written down from its geometry with nothing derived: the leg is
/// closed by Newton on its two gimbal angles and its extension, in extended precision, and
/// derivatives are differences of eighth order.

#include <Eigen/Core>
#include <type_traits>

#include "hydrapod/model/machine.hpp"

namespace hydrapod::test {

class LegPotential {
 public:
  using Real = long double;
  using Vector3L = Eigen::Matrix<Real, 3, 1>;
  using Matrix3L = Eigen::Matrix<Real, 3, 3>;
  /// Platform joint in B [m], tilts φ1, φ2 of the rod about t and a2 [rad], piston offsets u1, u2
  /// [m].
  using Coordinates = Eigen::Matrix<Real, 7, 1>;

  /// `a1`: base-fixed axis that the case's axes follow; `around`: state near which it will be
  /// evaluated.
  LegPotential(const model::Leg& leg, const model::Vector3& a1, const model::Vector3& gravity,
               double oil_force, const Coordinates& around);

  /// Oil, guide sleeve, piston ring and weights [J]; the guide ring with a sharp corner.
  [[nodiscard]] Real energy(const Coordinates& x) const;
  [[nodiscard]] Real extension(const Coordinates& x) const;  ///< s [m]
  /// Offset of the rod's axis at the guide sleeve, along t and a2 [m].
  [[nodiscard]] Eigen::Matrix<Real, 2, 1> sleeve_offset(const Coordinates& x) const;

  /// Step of differences [m, rad]; rounding and truncation are some 1e-14 with the seals alone. On
  /// the guide ring four steps must be short beside the offset, whose size is a root.
  static constexpr Real smooth_step = 4e-3L, contact_step = 2e-4L;
  [[nodiscard]] Eigen::Matrix<double, 7, 1> gradient(const Coordinates& x,
                                                     Real step = smooth_step) const;
  [[nodiscard]] Eigen::Matrix<double, 7, 7> hessian(const Coordinates& x,
                                                    Real step = smooth_step) const;

 private:
  struct Shape {
    Matrix3L R;  ///< case axes t, a2, n in B
    Vector3L e;  ///< rod direction in them
    Real s;
  };
  [[nodiscard]] Shape close(const Coordinates& x) const;
  /// Of rod and case between their chords at the guide sleeve [m/N].
  [[nodiscard]] Real bending_compliance(Real s) const;

  const model::Leg& leg_;
  Vector3L a1_, gravity_;
  Real oil_force_;
  Matrix3L start_;  ///< case axes of the straight leg
};

/// ∂f/∂x_k by differences of eighth order.
template <class Function>
auto derivative(const Function& f, const LegPotential::Coordinates& x, int k,
                LegPotential::Real h = LegPotential::smooth_step) -> std::decay_t<decltype(f(x))> {
  using Real = LegPotential::Real;
  const auto at = [&](int steps) {
    LegPotential::Coordinates moved = x;
    moved[k] += steps * h;
    return f(moved);
  };
  using Value = std::decay_t<decltype(f(x))>;  // not auto: Eigen would keep the operands' addresses
  const auto pair = [&](int steps) -> Value { return (at(steps) - at(-steps)) / h; };
  return pair(1) * (4.0L / 5.0L) - pair(2) * (1.0L / 5.0L) + pair(3) * (4.0L / 105.0L) -
         pair(4) * (1.0L / 280.0L);
}

}  // namespace hydrapod::test
