#pragma once
/// The mechanism of model::Machine in MuJoCo, built from the description alone.
///
/// Platform: a free body; a base with a mount is another, on which the legs stand. Each leg: two
/// hinges at the base joint, the case, a slide along the case, (full) two lateral slides, (guide,
/// full) two hinges at the piston, the rod. The rod's end is held to the platform joint by a
/// `connect` constraint: 18 constraint rows, 6, 18 or 30 degrees of freedom. At the start every leg
/// is straight.
///
/// FlexibleAxes::gimbal: the hinges at the base are about a1 and a2, those at the piston parallel
/// to them, or to `piston_axes` (first axis of each leg, in its case; the second stays a2).
/// FlexibleAxes::transverse: any two axes normal to the leg, and bodies whose axial inertia is
/// 1e-13 kg m², the least that MuJoCo takes.
///
/// Coordinates q̇ are MuJoCo's: platform origin in B, platform rotation in platform axes, the same
/// of a base with a mount, then leg by leg θ1, θ2, s (, u1, u2) (, φ1, φ2).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <array>
#include <memory>

#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::test {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using spatial::Matrix3;
using spatial::Vector3;

using PistonAxes = std::array<Vector3, model::leg_count>;

class MujocoHexapod {
 public:
  MujocoHexapod(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                const PistonAxes* piston_axes = nullptr);

  [[nodiscard]] int nv() const { return model_->nv; }
  [[nodiscard]] int dof() const { return dynamics::degrees_of_freedom(kind_) + of_base(); }
  [[nodiscard]] int of_base() const { return machine_.base_mount ? 6 : 0; }
  [[nodiscard]] int per_leg() const { return 3 + dynamics::flexible_per_leg(kind_); }
  [[nodiscard]] ModelKind kind() const { return kind_; }
  [[nodiscard]] const model::Machine& machine() const { return machine_; }

  /// Places of leg `i` in q̇.
  [[nodiscard]] int theta_of(int i) const { return 6 + of_base() + i * per_leg(); }
  [[nodiscard]] int extension_of(int i) const { return theta_of(i) + 2; }
  [[nodiscard]] int flexible_of(int i) const { return theta_of(i) + 3; }

  /// The configuration as displacement in q̇ from `from` (MuJoCo's qpos).
  void move(const VectorXd& from, const VectorXd& displacement);
  [[nodiscard]] VectorXd qpos() const;
  /// Of the slide along the case of leg `i`, from the start [m].
  [[nodiscard]] double extension(int i) const;

  /// One mj_step(), after which everything is put back where it was.
  void step_and_return();
  /// Sets q̇; gravity_force() then holds the velocity products as well.
  void set_velocity(const VectorXd& velocity);
  /// J̇ q̇: what the constraints' second derivative is without accelerations [m/s²], 18.
  [[nodiscard]] VectorXd constraint_bias();

  /// A body's motion in B: its frame's origin and its angular velocity, with time derivatives.
  struct BodyMotion {
    Vector3 position{}, velocity{}, acceleration{}, omega{}, alpha{};
  };
  /// Motions at q̈ = `acceleration`.
  struct LegBodies {
    BodyMotion cylinder_case{}, rod{};  ///< origins: base joint, piston
  };
  std::array<LegBodies, model::leg_count> leg_bodies(const VectorXd& acceleration);

  /// Linear and angular momentum about the origin of B of everything that moves.
  [[nodiscard]] spatial::Vector6 momentum();
  /// Inertia about the origin of B of everything, locked where it is.
  [[nodiscard]] spatial::Matrix6 locked_inertia() const;
  [[nodiscard]] MatrixXd mass() const;                 ///< nv × nv
  [[nodiscard]] MatrixXd constraint_jacobian() const;  ///< 18 × nv
  [[nodiscard]] VectorXd constraint_error() const;     ///< 18 [m]
  /// nv × dof: motions that the constraints allow, per motion of the platform and of the legs'
  /// flexible coordinates.
  [[nodiscard]] MatrixXd allowed_motions() const;
  /// nv × nv at the start: oil springs, seals and piston rings, each by MuJoCo's point Jacobians,
  /// and the mount.
  [[nodiscard]] MatrixXd stiffness_without_preload() const;
  /// nv × nv anywhere: the legs' dampers. Lateral ones see what the case sees; for
  /// FlexibleAxes::transverse that is a case which does not spin about its axis.
  [[nodiscard]] MatrixXd damping() const;

  [[nodiscard]] Matrix3 case_axes(int i) const;  ///< R_BL; third column along the case
  [[nodiscard]] Vector3 rod_direction(int i) const;
  [[nodiscard]] Vector3 piston(int i) const;  ///< [m] in B, where rod and case meet
  /// Offset of the piston from the case's axis, in B [m].
  [[nodiscard]] Vector3 piston_offset(int i) const;

  /// Generalised force of gravity and, with q̇ ≠ 0, of the velocity products.
  [[nodiscard]] VectorXd gravity_force() const;
  /// Adds the generalised force of a pair ±`force` between rod (+) and case (−) of leg `i` at
  /// `point`.
  void add_pair(int i, const Vector3& force, const Vector3& point, VectorXd& generalised) const;

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  [[nodiscard]] int case_body(int i) const { return (machine_.base_mount ? 3 : 2) + 2 * i; }
  [[nodiscard]] int rod_body(int i) const { return case_body(i) + 1; }
  [[nodiscard]] BodyMotion body_motion(int body) const;
  [[nodiscard]] MatrixXd point_jacobian(const Vector3& point, int body) const;
  [[nodiscard]] MatrixXd rates_seen_by_case(int i, const Vector3& point) const;
  void update();

  model::Machine machine_;
  ModelKind kind_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

}  // namespace hydrapod::test
