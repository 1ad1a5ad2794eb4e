#pragma once
/// The equations of motion of the legs in their charts, flexible coordinates eliminated. Private to
/// NonlinearModel; derivation: docs/theory/nonlinear.md.
///
/// Chart c = (α, β, s | φ (, u)): rotations of the case about a1 and a2, extension, flexible
/// coordinates. A body of revolution is a mass and a unit vector: case ½ I_b |ṅ|², rod ½ m_g |ġ|² +
/// ½ I_r |ė|². So inertia forces are masses times accelerations of points, projected on ∂g, ∂e, ∂n.

#include <Eigen/Geometry>

#include "legs_in_motion.hpp"

namespace hydrapod::dynamics {

/// The legs as the platform feels them. With the chart's accelerations (α̈, β̈, s̈) = J (v̇; ω̇) + κ,
/// the generalised forces that the legs bring against (α, β, s) are S J (v̇; ω̇) + r.
template <int n>
struct LegEquations {
  using Flexible = Eigen::Matrix<Lanes, n, 1>;
  using Square = Eigen::Matrix<Lanes, n, n>;
  using Coupling = Eigen::Matrix<Lanes, 3, n>;

  Matrix3L A_inverse;  ///< chart rates (α̇, β̇, ṡ) per joint velocity in L
  Matrix3L M_cc;       ///< mass of (α, β, s)
  Coupling X;          ///< coupling of (α, β, s) with the flexible coordinates, joint held
  Square M_ff;         ///< mass of the flexible coordinates, joint held
  Square M_ff_inverse;
  Vector3L r_c;           ///< residual forces on (α, β, s) at κ
  Flexible r_f;           ///< on the flexible coordinates, joint held
  Vector3L joint_moment;  ///< friction of the platform joint: moment on the platform, in B

  /// S.
  [[nodiscard]] Matrix3L eliminated_mass() const {
    if constexpr (n == 0)
      return M_cc;
    else
      return M_cc - X * (M_ff_inverse * X.transpose());
  }
  /// r.
  [[nodiscard]] Vector3L eliminated_residual() const {
    if constexpr (n == 0)
      return r_c;
    else
      return r_c - X * (M_ff_inverse * r_f);
  }
  /// Accelerations of the flexible coordinates; `chart`: J (v̇; ω̇).
  [[nodiscard]] Flexible flexible_acceleration(const Vector3L& chart) const {
    return -(M_ff_inverse * (r_f + X.transpose() * chart));
  }
};

/// What the legs need to know of the rest of the machine.
struct LegSurroundings {
  const LegConstants& legs;
  bool spinning;        ///< gimbal axes
  bool joint_friction;  ///< in any leg
  Vector3 gravity;      ///< in B
  Vector3 omega;        ///< of the platform, in B
  Vector3L joint_bias;  ///< acceleration of the joints at zero (v̇; ω̇), in B
  Lanes axial_force;    ///< on the pistons along s
  bool seals_press{};   ///< the next ones count: Loads::sleeve, Loads::ring, Loads::frame_moment
  Vector2L sleeve_force{}, ring_force{};
  Lanes frame_moment{};
  bool joints_stick{};  ///< the next ones count: Loads::base_joint, Loads::platform_joint
  Vector2L base_torque{}, platform_torque{};
};

/// Mass part only: A_inverse, M_cc, X, M_ff, M_ff_inverse.
template <int n>
void leg_mass(const LegsInMotion& at, const LegSurroundings& around, LegEquations<n>& equations);

/// Everything.
template <int n>
void leg_equations(const LegsInMotion& at, const LegSurroundings& around,
                   LegEquations<n>& equations);

/// Axial rotation of case and rod.
struct AxialSpin {
  Lanes of_case, of_rod;  ///< σ of case and rod [rad/s]
  Vector3L row;           ///< p: σ_rod = ω·e + p·ė_bending
  Lanes row_rate;         ///< ṗ·ė_bending + p·e_curvature
};
AxialSpin axial_spin(const LegsInMotion& at, const Vector3L& piston_axis);

/// Rates at which the joints turn across the leg's axis, base and platform, and the friction torque
/// per rate [N m s/rad] there.
struct JointTurning {
  Vector3L base_rate;      ///< ṅ, L
  Vector3L platform_rate;  ///< angular velocity of the platform against the rod, across it, L
  Lanes base_slope, platform_slope;
};
JointTurning joint_turning(const LegsInMotion& at, const LegConstants& legs, const Vector3& omega);

/// Directions across the rod along which LegJoints::platform is told, L.
struct AcrossRod {
  Vector3L first, second;
  explicit AcrossRod(const LegsInMotion& at) : first(at.e_2), second(at.e.cross(at.e_2)) {}
};

/// What the guide rings add to k_s: force per offset [N/m], and their energy [J].
Lanes guide_secant(const LegsInMotion& at, const LegConstants& legs);
Lanes guide_energy(const LegsInMotion& at, const LegConstants& legs);

/// Twice the kinetic energy that the bows add [J], and their momentum, linear and about the base
/// joints, L.
Lanes bow_energy(const LegsInMotion& at, const LegConstants& legs);
struct BowMomentum {
  Vector3L linear, angular;
};
BowMomentum bow_momentum(const LegsInMotion& at, const LegConstants& legs);

/// A vector of B that is the same for all legs, in the frames of the cases.
Vector3L in_cases(const LegsInMotion& at, const Vector3& v);

}  // namespace hydrapod::dynamics
