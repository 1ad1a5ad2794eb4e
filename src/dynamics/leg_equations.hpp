#pragma once
/// The equations of motion of one leg in its chart, flexible coordinates eliminated. Private to
/// NonlinearModel; derivation: docs/theory/nonlinear.md.
///
/// Chart c = (α, β, s | φ (, u)): rotations of the case about a1 and a2, extension, flexible
/// coordinates. A body of revolution is a mass and a unit vector: case I_b ½|ṅ|², rod ½ m_g|ġ|² +
/// ½ I_r|ė|². So inertia forces are masses times accelerations of points, projected on ∂g, ∂e, ∂n.

#include <Eigen/Geometry>

#include "hydrapod/dynamics/nonlinear.hpp"

namespace hydrapod::dynamics {

/// A leg as the platform feels it. The chart's first three accelerations are J (v̇; ω̇) + what
/// LegDrive::bias says; the generalised force the leg brings against them is S J (v̇; ω̇) + r.
template <int n>
struct LegEquations {
  using Flexible = Eigen::Matrix<double, n, 1>;
  using Square = Eigen::Matrix<double, n, n>;
  using Coupling = Eigen::Matrix<double, 3, n>;

  Matrix3 A_inverse;  ///< chart rates (α̇, β̇, ṡ) per joint velocity in L
  Matrix3 M_cc;       ///< mass of (α, β, s)
  Coupling X;         ///< coupling of (α, β, s) with the flexible coordinates, joint held
  Square M_ff;        ///< mass of the flexible coordinates, joint held
  Square M_ff_inverse;
  Vector3 r_c;           ///< residual forces on (α, β, s) at κ
  Flexible r_f;          ///< on the flexible coordinates, joint held
  Vector3 joint_moment;  ///< friction of the platform joint: moment on the platform, in B

  /// Mass and residual as the platform feels them, flexible coordinates eliminated.
  [[nodiscard]] Matrix3 eliminated_mass() const {
    if constexpr (n == 0)
      return M_cc;
    else
      return M_cc - X * (M_ff_inverse * X.transpose());
  }
  [[nodiscard]] Vector3 eliminated_residual() const {
    if constexpr (n == 0)
      return r_c;
    else
      return r_c - X * (M_ff_inverse * r_f);
  }
  /// Accelerations of the flexible coordinates; `chart`: J (v̇; ω̇).
  [[nodiscard]] Flexible flexible_acceleration(const Vector3& chart) const {
    return -M_ff_inverse * (r_f + X.transpose() * chart);
  }
};

/// What a leg needs to know of the rest of the machine.
struct LegSurroundings {
  const model::Leg& leg;
  Vector3 gravity;      ///< in B
  Vector3 piston_axis;  ///< first hinge of the rod, in L
  bool spinning;        ///< gimbal axes
  Vector3 omega;        ///< of the platform, in B
  Vector3 joint_bias;   ///< acceleration of the joint at zero (v̇; ω̇), in B
  double axial_force;   ///< on the piston along s
};

/// Mass part only: A_inverse, M_cc, X, M_ff, M_ff_inverse.
template <int n>
void leg_mass(const LegMotion& at, const LegSurroundings& around, LegEquations<n>& equations);

/// Everything.
template <int n>
void leg_equations(const LegMotion& at, const LegSurroundings& around, LegEquations<n>& equations);

/// Axial rotation of case and rod.
struct AxialSpin {
  double of_case{}, of_rod{};    ///< σ of case and rod [rad/s]
  Vector3 row{Vector3::Zero()};  ///< p: σ_rod = ω·e + p·ė_bending
  double row_rate{};             ///< ṗ·ė_bending + p·e_curvature
};
AxialSpin axial_spin(const LegMotion& at, const Vector3& piston_axis);

/// Friction torque [N m] per rotation rate [rad/s], at the rate `rate`.
double joint_friction_slope(const model::JointFriction& friction, double rate);

}  // namespace hydrapod::dynamics
