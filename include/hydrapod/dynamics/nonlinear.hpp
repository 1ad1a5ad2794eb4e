#pragma once
/// The exact nonlinear mechanics: large motions of platform and bent legs in minimal coordinates.
///
/// Configuration y: position of the platform's mass centre C in B [m], orientation of P in B as a
/// quaternion (w, x, y, z) of any length but zero, then per leg φ1, φ2 [rad] (, u1, u2 [m]).
/// Velocities v: velocity of C in B [m/s], angular velocity ω of the platform in base axes [rad/s],
/// then the rates of the flexible coordinates. ẏ = v with q̇ = ½ (0, ω) q. Modes of the payload put
/// their coordinates ξ behind all others of y, and their rates behind all others of v; ξ = 0 is
/// where they stand under the weight at the reference pose (docs/theory/payload.md).
///
/// A leg closes in closed form (docs/theory/leg.md, "The bent leg"), so there are no constraints.
/// The equations of motion are those of docs/theory/nonlinear.md: bodies of revolution are a mass
/// and a unit vector, whose accelerations are bilinear in the velocities; each leg's flexible
/// coordinates are eliminated, and what is left is a 6×6 system for the platform. Nothing
/// allocates.
///
/// Axes. A leg's frame hangs on its axis a1 (FlexibleAxes::gimbal) or on the base axis that
/// frame_axis() chooses at the reference pose (transverse), and keeps it. With gimbal axes the rod
/// turns in the case about an axis fixed in the case, parallel to a1 at the reference pose with the
/// leg straight (or bent as static equilibrium bends it there), then about one normal to it and to
/// the rod: two real hinges.
///
/// Rods and cases that bend (model::LegBending) do so quasi-statically, as in bent_leg. The
/// compression of the rod, which makes it softer, and what the mass of the bow is are those of the
/// static equilibrium at the reference pose and are kept.
///
/// All motion is against the base. One that moves itself (`base.mount`) is added by
/// moving_base.hpp.
///
/// A base on springs under the nonlinear mechanics.
///
/// NonlinearModel stays in base coordinates: v is motion against the base. The base adds its own
/// small motion q_b = (x, y, z, rx, ry, rz) against the ground at the origin of B along its axes,
/// in the directions that have a spring. Kinetic energy, with rates v_b of q_b:
///
///     T = T_rel(v) + v_bᵀ P v + ½ v_bᵀ M_b v_b
///     M v̇ + h + Pᵀ a_b = F            M_b a_b + P v̇ + C_b v_b + K_b q_b = Tᵀ w
///
/// P v is the momentum of platform and legs about the origin of B in their motion against it, M_b
/// the inertia about it of base, platform and legs locked together, w a wrench on the platform and
/// T what brings it to the origin. P and M_b are taken where the machine rests at the reference
/// pose and kept: exact for small motions about it, and energy is kept in large ones too. Gravity
/// on a base that tilts is left out (as in the linear models), its weight is carried by what the
/// springs are compressed where q_b = 0.
///
/// Damping: 2 ζ √(k M_b,kk) beside each spring, ζ being model::modal_ratio as for seals, and
/// Rayleigh's β k.
///
/// A base with next to no inertia would vibrate far above everything that matters and cost an
/// integrator its steps. Where the base, platform and ground held, would vibrate faster than
/// `fastest` times the machine's highest rigid frequency, its inertia in that motion is raised
/// until it does not. What this adds to the energy of a mode at ω is of the order (ω/ω_base)² times
/// the legs' stiffness over the mount's.

#include <array>
#include <cstddef>
#include <memory>

#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::dynamics {

/// What acts on the mechanism besides gravity, seals and friction in joints.
struct Loads {
  /// Force on each piston along its case [N], positive when it pushes the leg out.
  Vector6 axial{Vector6::Zero()};
  /// Force and moment about C on the platform, base axes [N, N m].
  Vector6 wrench{Vector6::Zero()};
  /// What seals press with against the rod beside their springs and dampers, along t and a2 [N]: at
  /// the guide sleeve against d_s, at the piston against u. Used with `seals_press` only.
  std::array<Vector2, model::leg_count> sleeve{}, ring{};
  /// A part of them that turns with the leg's frame, and not with the case, has no moment about the
  /// axis: what their moment is too small by [N m]. Used with `seals_press` only.
  Vector6 frame_moment{Vector6::Zero()};
  bool seals_press{};
  /// Torques [N m] of what sticks in the legs' joints, against the rates of LegJoints. Used with
  /// `joints_stick` only.
  std::array<Vector2, model::leg_count> base_joint{}, platform_joint{};
  bool joints_stick{};
};

/// One leg in motion.
struct LegMotion {
  bool exists{true};  ///< false: no extension closes this leg; nothing else is then meant
  double length{}, length_rate{};          ///< l [m], l̇ [m/s]
  double s{}, s_rate{};                    ///< piston from the base joint along the case
  Vector4 flexible{Vector4::Zero()};       ///< φ1, φ2 [rad], u1, u2 [m]
  Vector2 sleeve_offset{Vector2::Zero()};  ///< of the rod at the seal [m] along t and a2
};

/// Inertial coupling of a moving base and the mechanism on it; see moving_base.hpp.
inline constexpr int most_velocities =
    degrees_of_freedom(ModelKind::full) + model::most_payload_modes;
using BaseMomentum = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, most_velocities>;
using BaseResponse = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, most_velocities, 6>;
struct BaseCoupling {
  BaseMomentum momentum{};           ///< P, 6 × velocities()
  Matrix6 inertia{Matrix6::Zero()};  ///< M_b of platform and legs about the origin of B
};

struct Energies {
  double platform{};  ///< kinetic [J], with that of the payload's modes
  double legs{};      ///< kinetic
  double gravity{};   ///< potential
  double sleeves{};   ///< elastic: guide sleeves, with their guide rings
  double rings{};     ///< elastic: piston rings
  double bending{};   ///< elastic: rods and cases
  double payload{};   ///< elastic: modes of the payload
  [[nodiscard]] double total() const {
    return platform + legs + gravity + sleeves + rings + payload + bending;
  }
};

/// Where everything is and how it moves; made by NonlinearModel::motion(), fed to accelerations().
struct Motion {
  spatial::Pose X_BP{};
  Vector3 p_BC{Vector3::Zero()};
  Vector6 twist{Vector6::Zero()};  ///< velocity of C; ω
  std::array<LegMotion, model::leg_count> legs{};
  /// ξ of the payload's modes and its rates [m, m/s]; zero beyond their number.
  Vector6 payload{Vector6::Zero()}, payload_rate{Vector6::Zero()};
  /// The legs once more, side by side as the equations take them: a LegsInMotion, which only the
  /// sources know.
  alignas(double) std::array<std::byte, 5824> side_by_side;
  [[nodiscard]] bool exists() const;  ///< whether every leg closes
};

struct LegSurroundings;  // private to the sources, as is
struct LegConstants;

class NonlinearModel {
 public:
  /// Throws std::invalid_argument when ModelKind::full is asked of legs without a piston ring, or a
  /// leg lies along its gimbal axis at the reference pose.
  NonlinearModel(const model::Machine& machine, ModelKind kind, const spatial::Pose& X_reference);
  NonlinearModel(const model::Machine& machine, ModelKind kind);  ///< at the neutral pose

  [[nodiscard]] ModelKind kind() const { return kind_; }
  [[nodiscard]] const model::Machine& machine() const { return machine_; }
  /// First axis of the frame of leg `i` in B.
  [[nodiscard]] const Vector3& axis(int i) const { return axes_[i]; }
  /// First hinge of the rod of leg `i` in its case, axes of the case; with gimbal axes only.
  [[nodiscard]] const Vector3& piston_axis(int i) const { return piston_axes_[i]; }
  [[nodiscard]] int flexible() const { return flexible_per_leg(kind_); }
  /// Modes of the payload: the last of y and of v.
  [[nodiscard]] int payload_count() const {
    return static_cast<int>(machine_.payload_modes.size());
  }
  [[nodiscard]] int positions() const { return velocities() + 1; }
  [[nodiscard]] int velocities() const { return degrees_of_freedom(kind_) + payload_count(); }

  /// y at a pose, legs bent by `flexible` of `legs` (in the frames of this model), modes of the
  /// payload at rest under the weight.
  void configuration(const spatial::Pose& X_BP, const std::array<LegState, model::leg_count>& legs,
                     double* y) const;
  /// Static equilibrium at a pose, in the frames of this model.
  [[nodiscard]] StaticEquilibrium equilibrium(const spatial::Pose& X_BP) const;

  /// Kinematics at (y, v). `exists()` of the result says whether the legs close.
  void motion(const double* y, const double* v, Motion& motion) const;
  /// ẏ from (y, v).
  void rates(const double* y, const double* v, double* y_rate) const;
  /// v̇. Seals, gravity and joint friction of the machine act as well.
  void accelerations(const Motion& motion, const Loads& loads, double* v_rate) const;
  /// The same, and into `per_base` (velocities() × 6) the v̇ that an acceleration of the base adds,
  /// −M⁻¹ Pᵀ, P being `momentum`.
  void accelerations(const Motion& motion, const Loads& loads, const BaseMomentum& momentum,
                     double* v_rate, BaseResponse& per_base) const;
  /// Momentum of platform and legs, linear [kg m/s] and angular about the origin of B [kg m²/s].
  [[nodiscard]] Vector6 momentum(const Motion& motion) const;
  /// P and M_b at the configuration `y`; the base itself is not in them.
  [[nodiscard]] BaseCoupling base_coupling(const double* y) const;
  /// M with 2T = vᵀ M v, velocities() × velocities().
  [[nodiscard]] Eigen::MatrixXd mass_matrix(const Motion& motion) const;

  [[nodiscard]] Energies energies(const Motion& motion) const;
  /// What seals' dampers and joints take out [W], 0 or more.
  [[nodiscard]] double dissipation(const Motion& motion) const;

 private:
  void turn_piston_axes(const spatial::Pose& X_reference);
  [[nodiscard]] LegSurroundings surroundings(const Motion& motion, const Loads& loads) const;

  model::Machine machine_;
  ModelKind kind_;
  bool spinning_;                                 ///< gimbal axes: axial inertias count
  bool joint_friction_;                           ///< in any leg
  Vector3 weight_at_rest_{Vector3::Zero()};       ///< gravity in P at the reference pose [m/s²]
  std::array<Vector3, model::leg_count> axes_{};  ///< first axis of each leg's frame, in B
  /// First hinge of the rod in the case, in L; gimbal axes only.
  std::array<Vector3, model::leg_count> piston_axes_{};
  std::shared_ptr<const LegConstants> constants_;
};

/// Rates [rad/s] at which the legs' frames turn about n against their cases, which do not spin
/// (FlexibleAxes::transverse); zero with gimbal axes.
Vector6 frame_spins(const NonlinearModel& model, const Motion& motion);

/// The joints of the legs, and how they turn across the axes of the legs.
struct LegJoints {
  /// Columns t, a2 and n of the case in B.
  std::array<Matrix3, model::leg_count> case_axes{};
  /// Columns ∂e/∂φ2, e × ∂e/∂φ2 and e of the rod in B; t, a2 and n where the leg is straight.
  std::array<Matrix3, model::leg_count> rod_axes{};
  /// Of the case against the base [rad/s]: ṅ along t and a2.
  std::array<Vector2, model::leg_count> base{};
  /// Of the platform against the rod [rad/s]: ω along the first two of `rod_axes`.
  std::array<Vector2, model::leg_count> platform{};
  /// At which these directions turn about n and e against case and rod, which do not spin; zero
  /// with gimbal axes [rad/s].
  Vector6 base_spin{Vector6::Zero()}, platform_spin{Vector6::Zero()};
};
LegJoints leg_joints(const NonlinearModel& model, const Motion& motion);

struct MovingBase {
  static constexpr double fastest = 20.0;  ///< times the highest rigid frequency on a still base

  std::array<int, 6> directions{};  ///< that are compliant, the first `count`
  int count{};
  BaseCoupling coupling{};                 ///< P; M_b with the base's own inertia
  Vector6 stiffness{Vector6::Zero()};      ///< K_b [N/m, N m/rad], 0 where the base is rigid
  Vector6 damping{Vector6::Zero()};        ///< C_b [N s/m, N m s/rad]
  Matrix6 added_inertia{Matrix6::Zero()};  ///< the part of M_b that only keeps it slow

  /// ½ v_bᵀ M_b v_b + v_bᵀ P v [J].
  [[nodiscard]] double kinetic_energy(const Vector6& rates, const double* v) const;
  /// ½ q_bᵀ K_b q_b [J].
  [[nodiscard]] double elastic_energy(const Vector6& motion) const;
  /// a_b, zero where the base is rigid. `v_rate`: v̇ on a base that stands still,
  /// `per_base`: v̇ per a_b (NonlinearModel::accelerations), `wrench` on the platform about `p_BC`.
  [[nodiscard]] Vector6 acceleration(const Vector6& motion, const Vector6& rates,
                                     const double* v_rate, const BaseResponse& per_base,
                                     const Vector6& wrench, const Vector3& p_BC) const;
};

/// The base of `model`'s machine, which must have a `base_mount`, with the mechanism at rest at
/// `y`.
MovingBase moving_base(const NonlinearModel& model, const double* y);

/// Motion (or velocity, or acceleration) of a point at r from the origin of B, and rotation, that
/// such a one of the base gives it.
Vector6 carried(const Vector6& base, const Vector3& r);

}  // namespace hydrapod::dynamics
