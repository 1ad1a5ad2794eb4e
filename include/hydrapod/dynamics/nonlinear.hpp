#pragma once
/// The exact nonlinear mechanics: large motions of platform and bent legs in minimal coordinates.
///
/// Configuration y: position of the platform's mass centre C in B [m], orientation of P in B as a
/// quaternion (w, x, y, z) of any length but zero, then per leg φ1, φ2 [rad] (, u1, u2 [m]).
/// Velocities v: velocity of C in B [m/s], angular velocity ω of the platform in base axes [rad/s],
/// then the rates of the flexible coordinates. ẏ = v with q̇ = ½ (0, ω) q.
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

#include <array>

#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::dynamics {

/// What acts on the mechanism besides gravity, seals and friction in joints.
struct Loads {
  /// Force on each piston along its case [N], positive when it pushes the leg out.
  Vector6 axial{Vector6::Zero()};
  /// Force and moment about C on the platform, base axes [N, N m].
  Vector6 wrench{Vector6::Zero()};
};

/// One leg in motion.
struct LegMotion {
  Vector3 a{Vector3::Zero()};                   ///< platform joint in B [m]
  Vector3 v_a{Vector3::Zero()};                 ///< its velocity [m/s]
  double length{}, length_rate{};               ///< l [m], l̇ [m/s]
  double s{}, s_rate{};                         ///< piston from the base joint along the case
  Matrix3 R_BL{Matrix3::Identity()};            ///< frame of the case: t, a2, n
  Vector3 e{Vector3::UnitZ()};                  ///< rod's direction, in the case frame
  Vector2 sleeve_offset{Vector2::Zero()};       ///< d_s [m]
  Vector2 sleeve_offset_rate{Vector2::Zero()};  ///< as the case sees it [m/s]
  Vector2 ring_offset_rate{Vector2::Zero()};    ///< u̇ as the case sees it [m/s]
  bool exists{true};                            ///< false: no extension closes this leg
};

struct Energies {
  double platform{};  ///< kinetic [J]
  double legs{};      ///< kinetic
  double gravity{};   ///< potential
  double sleeves{};   ///< elastic: guide sleeves
  double rings{};     ///< elastic: piston rings
  [[nodiscard]] double total() const { return platform + legs + gravity + sleeves + rings; }
};

/// Where everything is and how it moves; made by NonlinearModel::motion(), fed to accelerations().
struct Motion {
  spatial::Pose X_BP{};
  Vector3 p_BC{Vector3::Zero()};
  Vector6 twist{Vector6::Zero()};  ///< velocity of C; ω
  std::array<LegMotion, model::leg_count> legs{};

  /// Inner terms of the equations of motion, per leg.
  struct LegTerms {
    Vector3 g, g_rate;    ///< rod's mass centre in the case frame, its velocity in B
    Vector3 e_1, e_2;     ///< ∂e/∂φ
    Vector3 e_rate;       ///< ė in B
    Vector2 d_1, d_2;     ///< ∂d_s/∂φ
    Vector2 d_s;          ///< ∂d_s/∂s
    double cosine, sine;  ///< a1 in the case frame is (cosine, 0, sine)
    Vector2 gimbal_rate;  ///< rotation rates of the case about a1 and a2
    Vector4 flexible, flexible_rate;
    Vector3 e_curvature;  ///< ë at constant rates, in the case frame
    Vector3 e_rate_case;  ///< ė seen by the case frame
    double case_spin, rod_spin;
    Vector3 spin_row;           ///< p of the rod's spin
    double spin_row_curvature;  ///< ṗ·ė
  };
  std::array<LegTerms, model::leg_count> terms{};
  [[nodiscard]] bool exists() const;  ///< whether every leg closes
};

class NonlinearModel {
 public:
  /// Throws std::invalid_argument when ModelKind::full is asked of legs without a piston ring, or a
  /// leg lies along its gimbal axis at the reference pose.
  NonlinearModel(const model::Machine& machine, ModelKind kind, const spatial::Pose& X_reference);
  NonlinearModel(const model::Machine& machine, ModelKind kind);  ///< at the neutral pose

  [[nodiscard]] ModelKind kind() const { return kind_; }
  [[nodiscard]] const model::Machine& machine() const { return machine_; }
  [[nodiscard]] int flexible() const { return flexible_per_leg(kind_); }
  [[nodiscard]] int positions() const { return degrees_of_freedom(kind_) + 1; }
  [[nodiscard]] int velocities() const { return degrees_of_freedom(kind_); }

  /// y at a pose, legs bent by `flexible` of `legs` (in the frames of this model).
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
  /// M with 2T = vᵀ M v, velocities() × velocities().
  [[nodiscard]] Eigen::MatrixXd mass_matrix(const Motion& motion) const;

  [[nodiscard]] Energies energies(const Motion& motion) const;
  /// What seals' dampers and joints take out [W], 0 or more.
  [[nodiscard]] double dissipation(const Motion& motion) const;

 private:
  model::Machine machine_;
  ModelKind kind_;
  std::array<Vector3, model::leg_count> axes_{};         ///< first axis of each leg's frame, in B
  std::array<Vector3, model::leg_count> piston_axes_{};  ///< first hinge at the piston, in the case
};

}  // namespace hydrapod::dynamics
