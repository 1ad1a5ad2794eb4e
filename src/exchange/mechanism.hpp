#pragma once
/// The mechanism at rest as bodies, joints and springs, from which multibody files are written.
///
/// Per leg: case (origin at the base joint, axes t, a2, n), two hinges at the base joint, a slide
/// along n, with ModelKind::full two slides along t and a2, two hinges at the piston, rod (origin
/// at the piston, z along the rod). The rod's end is held to the platform joint. Every joint is at
/// 0 at rest, where the legs are bent by gravity.
///
/// The first hinge is about a1 (FlexibleAxes::gimbal) or t, the second about a2, at both ends.
///
/// Guide sleeve. The lateral offset of the rod in the plane of the sleeve is
///     d = u + (L_g − s) e⊥ / e_n,   V = ½ k_s |d|²
/// with e the rod's direction in the case. To second order about rest, in q = (s, θ1, θ2, u1, u2):
///     V ≈ ½ k_s |d_0 + J q|² + ½ qᵀ k_s (Σ d_0k ∇²d_k) q
/// The first term is a spring along each row of J; the eigenvectors of the second are more springs,
/// some with negative stiffness. Straight legs have d_0 = 0: the seal is a spring in each hinge,
/// k_s (L_g − s)² about a2.
///
/// Damping ratios of modes have no place in a mechanism. They become dampers beside the springs:
/// c = 2 ζ k / ω, with ω of the spring against its own mass in the leg (seals) and the lowest
/// frequency of the rigid-leg model (oil). Rayleigh's β gives c = β k.

#include <string>

#include "hydrapod/exchange/exchange.hpp"

namespace hydrapod::exchange {

using spatial::Matrix3;

struct Spring {
  double stiffness{};   ///< [N/m] or [N m/rad]
  double damping{};     ///< [N s/m] or [N m s/rad]
  double rest_force{};  ///< at q = 0, along −q: V = rest_force q + ½ k q²
};

/// Along a combination of (s, θ1, θ2, u1, u2).
struct CoupledSpring {
  Eigen::Matrix<double, 5, 1> along{Eigen::Matrix<double, 5, 1>::Zero()};
  Spring spring{};
};

struct LegMechanism {
  Matrix3 R_BL{Matrix3::Identity()};      ///< case: columns t, a2, n
  Matrix3 R_LR{Matrix3::Identity()};      ///< rod in the case
  Vector3 p_LR{Vector3::Zero()};          ///< piston in the case [m]
  Vector3 base_axis{Vector3::UnitX()};    ///< first hinge, axes of the case; the second is y
  Vector3 piston_axis{Vector3::UnitX()};  ///< first hinge, axes of the rod; the second is y
  double rod_end{};                       ///< l_mn [m] along the rod
  Spring oil{};
  std::array<Spring, 2> tilt{};    ///< of the hinges at the piston, straight legs only
  std::array<Spring, 2> offset{};  ///< of the slides u1, u2
  std::vector<CoupledSpring> coupled{};
  /// Stiffness of the seals against θ1, θ2 alone at rest, for programs without coupled springs.
  std::array<double, 2> tilt_alone{};
  double sleeve_damping{};
  double axial_added{}, cross_inertia{};         ///< m_a [kg], I_c [kg m²]
  double case_radius{}, rod_radius{}, sleeve{};  ///< [m], for pictures; sleeve: L_g
};

struct Mechanism {
  std::string name{};
  dynamics::ModelKind kind{};
  Pose X_BP{};
  std::array<LegMechanism, model::leg_count> legs{};
  double highest{};           ///< ω of the highest mode [rad/s]
  double highest_platform{};  ///< the same of the model with rigid legs
  double plate{};             ///< thickness of the platform in pictures [m]
  Parity parity{};
};

/// Throws base::ComputationError where the machine does not stand at `X_BP`.
Mechanism mechanism(const Machine& machine, const Pose& X_BP, dynamics::ModelKind kind);

/// What a format takes of a machine.
struct HeldMechanism {
  Machine machine{};
  Mechanism parts{};
  bool coupled{};      ///< the format has springs along combinations of joints, joints with inertia
  bool filled{};       ///< parts without mass or inertia have got a little
  bool lose_offset{};  ///< of the piston in its ring
};
HeldMechanism held_mechanism(Machine machine, const Pose& X_BP, dynamics::ModelKind kind,
                             MultibodyFormat format);

/// Springs of the slide and the two hinges at the piston for programs without coupled springs: each
/// joint alone, and what the bent seals push with at rest, without which the legs would bend on.
struct SingleSprings {
  Spring slide{};
  std::array<Spring, 2> tilt{};
};
SingleSprings single_springs(const LegMechanism& leg);

/// Inertia about the mass centre: principal axes (right-handed) and moments.
struct Principal {
  Matrix3 axes{Matrix3::Identity()};
  Vector3 moments{Vector3::Zero()};
};
Principal principal(const Matrix3& inertia);

/// 17 digits.
std::string number_text(double x);
std::string vector_text(const Vector3& v);
/// w x y z.
std::string quaternion_text(const Matrix3& R);
/// Roll, pitch, yaw: R = Rz Ry Rx.
std::string rpy_text(const Matrix3& R);
/// As an XML attribute or text.
std::string xml_text(const std::string& text);

std::string mjcf_text(const Machine& machine, const Mechanism& mechanism);
std::string sdf_text(const Machine& machine, const Mechanism& mechanism);
std::string urdf_text(const Machine& machine, const Mechanism& mechanism);
std::string closures_json(const Machine& machine, const Mechanism& mechanism);

}  // namespace hydrapod::exchange
