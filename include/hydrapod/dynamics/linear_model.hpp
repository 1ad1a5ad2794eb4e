#pragma once
/// The three linear models of a hexapod at any pose: M ÿ + C ẏ + K y = F.
///
///     y = (x, y, z, rx, ry, rz | φ1, φ2 (, u1, u2) of leg 1 | … | of leg 6 | x, …, rz of the base
///     |
///          ξ of the payload's modes)
///
/// The platform's six are the motion of its mass centre C [m] and its rotation [rad], both in base
/// axes, against the ground; the flexible coordinates are those of LegElement. The base's are its
/// motion at the origin of B against the ground, in the directions in which its mount has a spring;
/// a base that stands still has none. Where neither base nor legs have inertia, the base is
/// condensed: its springs are in series with the legs' (src/dynamics/base_mount.hpp). Summing T and
/// V of platform and legs gives M and K, symmetric, M positive definite. Without gravity M and K
/// have no preload terms and the upper-left 6×6 of M is the rigid model's M. With gravity
/// everything is linearised about the static equilibrium (statics.hpp) of that very model.
/// Derivation: docs/theory/linear-model.md.
///
/// What a set of undamped modes is: (K − ω² M) φ = 0. modal/normal_modes.hpp computes them;
/// responses and others that only use them need no more than this.
///
/// The load at which the legs fold: how much payload the machine carries at a pose.
///
/// A payload is mass added at the platform's mass centre. For a load growing from nothing the
/// static equilibrium at the pose is followed until one of two things happens, which is bracketed
/// and bisected:
/// - the lowest stiffness reaches zero (K singular: a seal mode at zero frequency);
/// - a limit point: beyond it no oil forces hold the platform at this pose with legs that are
///   merely bent. Legs that their own weight bends before they are loaded end here, shortly before
///   the mode is at zero, as an imperfect column does; straight ones (vertical, or without weight)
///   end in the first way.
///
/// The linear model of a machine a little beside one whose model is known: for central differences.
///
/// The search for the equilibrium starts at the known one and ends after the first Newton step that
/// leaves less than 1e-6 of the weight. What is left is of second order in the change, and the same
/// on both sides of a central difference.

#include <cmath>
#include <string>
#include <vector>

#include "hydrapod/dynamics/leg.hpp"
#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::dynamics {

inline constexpr int max_dof = degrees_of_freedom(ModelKind::full) + 6 + model::most_payload_modes;
/// Square, 6, 18 or 30 rows, up to six of the base and six of the payload, on the stack.
using ModelMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_dof, max_dof>;
using ModelVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_dof, 1>;
/// Motion of the platform per coordinate of the model.
using PlatformRows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, max_dof>;
/// The same per coordinate of the base.
using BaseColumns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

/// What relaxes: a spring κ in series with a damper κ/λ.
enum class Relaxing {
  oil,     ///< one of the two chambers' springs (hydraulics::RelaxingSpring)
  sleeve,  ///< an arm of the guide sleeve's O-rings along t or a2 (docs/theory/elastomers.md)
  ring     ///< the same of the piston ring's
};

/// A spring in series with a damper, κ of which stands in K as if the damper were rigid. At iω it
/// gives back −κ λ/(iω + λ) s_y s_yᵀ; as a state, η̇ = λ (s_y·y − η) and the force κ s_y η on y.
struct RelaxingArm {
  int leg{};
  double stiffness{};  ///< κ [N/m]
  double rate{};       ///< λ [1/s]
  ModelVector s_y{};   ///< its stretch per y: extension of the piston, offset of a seal
  Relaxing what{Relaxing::oil};
  int axis{};  ///< of a seal: 0 along t, 1 along a2
};

/// Of an arm at the frequency ω, beside C and K: the damper κ λ/(ω² + λ²) [N s/m].
inline double damper_at(const RelaxingArm& arm, double omega) {
  return arm.stiffness * arm.rate / (omega * omega + arm.rate * arm.rate);
}
/// And what K loses there: κ λ²/(ω² + λ²) [N/m].
inline double softening_at(const RelaxingArm& arm, double omega) {
  return damper_at(arm, omega) * arm.rate;
}

struct LinearModel {
  ModelKind kind{};
  model::LegType leg_type{};
  spatial::Pose X_BP{};
  Vector3 p_BC{};  ///< the platform's mass centre [m]
  /// diag(m I, R I_C Rᵀ) less Σ L Lᵀ of the payload's modes: what of the platform does not swing.
  Matrix6 platform_mass{};
  std::array<LegElement, model::leg_count> legs{};
  /// Per leg: motion of its platform joint, seen from its base joint, along (t, a2, n) per platform
  /// motion, 3×6.
  std::array<Eigen::Matrix<double, 3, 6>, model::leg_count> J{};
  StaticEquilibrium statics{};
  bool base_moves{};
  /// Directions 0…5 of the base that are coordinates, the last of y; none where it stands still or
  /// is condensed.
  std::vector<int> base_directions{};
  /// The motion of C against the base, which leg lengths show, per y. (1, 0) where the base stands
  /// still.
  PlatformRows against_base{};
  BaseColumns carried_by_base{};  ///< motion of C per base coordinate with all legs held
  /// Of a base with coordinates:
  std::array<LegOnBase, model::leg_count> legs_on_base{};
  Vector6 base_inertia{Vector6::Zero()};  ///< its own [kg, kg m²], all six directions
  Vector6 k_mount{Vector6::Zero()};       ///< [N/m, N m/rad], 0 where the base is rigid
  /// The mount's share of K_rr; see base_mount.hpp. Of a condensed base only.
  Matrix6 K_mount{Matrix6::Zero()};
  ModelMatrix M{}, K{};
  ModelMatrix
      C{};  ///< viscous dampers of the legs and Rayleigh damping; modal ratios are not in it
  /// With model::has_chambers() two per leg, in the order of the legs; then those of seals
  /// that are elastomers. M ÿ + C ẏ + K y less the arms' forces is F; the undamped modes are those
  /// of closed chambers and of arms with rigid dampers.
  std::vector<RelaxingArm> arms{};

  /// Modes of the payload, the very last of y (src/dynamics/payload.hpp): names, L about C in base
  /// axes (one column each) and ω². In absolute motion, ½ (Lᵀq + ξ̇)² is the kinetic energy of one.
  std::vector<std::string> payload_names{};
  BaseColumns payload{};
  std::array<double, model::most_payload_modes> payload_omega2{};

  [[nodiscard]] int base_count() const { return static_cast<int>(base_directions.size()); }
  [[nodiscard]] int payload_count() const { return static_cast<int>(payload_names.size()); }
  [[nodiscard]] int dof() const {
    return degrees_of_freedom(kind) + base_count() + payload_count();
  }
  /// Coordinates behind those of the legs, which models of every kind have: base and payload.
  [[nodiscard]] int beyond_legs() const { return base_count() + payload_count(); }
  /// Coordinates of leg i in y: joint rows J[i] times the platform's, then these.
  [[nodiscard]] int first_of_leg(int i) const { return 6 + i * flexible_per_leg(kind); }
  [[nodiscard]] int first_of_base() const { return degrees_of_freedom(kind); }
  [[nodiscard]] int first_of_payload() const { return first_of_base() + base_count(); }
};

/// Throws std::invalid_argument where the legs have no such model.
void require_kind(const model::Machine& machine, ModelKind kind);

/// Directions 0…5 of the machine's base that are coordinates of its linear models: those with a
/// spring where the base or a leg has inertia, else none.
std::vector<int> base_directions(const model::Machine& machine);

/// Number of coordinates, and of modes, of the model `kind` of `machine`.
int degrees_of_freedom(const model::Machine& machine, ModelKind kind);

/// The model `kind` of `machine` at `X_BP`. Throws base::ComputationError when the machine has no
/// static equilibrium there that Newton can find, and std::invalid_argument when ModelKind::full is
/// asked of legs without a piston ring, or another one than ModelKind::rigid of struts. `start`: a
/// neighbouring equilibrium to begin the search for this one at.
LinearModel linear_model(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                         const StaticEquilibrium* start = nullptr);

/// The machine with dampers at guide sleeves and piston rings that stand for `[damping]`: 2 ζ k/ω +
/// β k with ζ of model::seal_ratio and ω of the seal at `X_reference` (simulation/plant.hpp).
model::Machine with_seal_dampers(model::Machine machine, ModelKind kind,
                                 const spatial::Pose& X_reference);

/// The machine with the seals as stiff as the oil at rest at `X_BP` makes them
/// (Elastomer::pressure_stiffening): k (1 + c (p − p_a)), p being the pressure of the rod side at
/// guide sleeves, the mean of both sides at piston rings. As it is where no seal knows the pressure
/// or the model has no seals. Throws base::ComputationError where the supply does not hold a leg.
model::Machine with_pressed_seals(model::Machine machine, ModelKind kind,
                                  const spatial::Pose& X_BP);

/// K as slow motions meet it: seals that are elastomers have their `stiffness` alone.
ModelMatrix slow_stiffness(const LinearModel& model);

/// Of something that follows the coordinates of leg `leg` with `per_x`: its rate per y.
ModelVector per_coordinate(const LinearModel& model, int leg, const Vector7& per_x);

/// Names of the coordinates: "x", …, "rz", "leg1.phi1", "leg1.phi2", "leg1.u1", …, "base.x", …,
/// "payload.cabin", ….
std::vector<std::string> coordinate_names(ModelKind kind,
                                          const std::vector<int>& base_directions = {},
                                          const std::vector<std::string>& payload = {});

/// "rigid", "guide", "full".
const char* name(ModelKind kind);

struct NormalModes {
  ModelVector omega2{};      ///< ω² [rad²/s²], ascending; negative: unstable, the legs buckle
  ModelMatrix shapes{};      ///< columns φ [m, rad per √(kg m²)…], φᵀ M φ = 1
  std::vector<int> group{};  ///< same number for modes whose ω² repeat

  [[nodiscard]] int size() const { return static_cast<int>(omega2.size()); }
  /// √ω² [rad/s], 0 when unstable.
  [[nodiscard]] double omega(int k) const { return omega2[k] > 0.0 ? std::sqrt(omega2[k]) : 0.0; }
};

struct BucklingOptions {
  double tolerance{1e-6};      ///< relative to the total mass on the legs
  double largest_factor{100};  ///< search up to this multiple of the platform's mass
};

enum class BucklingStatus {
  found,      ///< the legs buckle at `payload`
  not_found,  ///< no buckling up to the largest payload searched, or no gravity
  buckled     ///< the machine as it stands is unstable; `payload` is negative: what must come off
};

struct Buckling {
  BucklingStatus status{BucklingStatus::not_found};
  double payload{};          ///< [kg] on top of the platform's mass
  bool limit_point{};        ///< ended at a limit point, else with a mode at zero
  StaticEquilibrium last{};  ///< the equilibrium at (just below) that payload
};

Buckling buckling_payload(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                          const BucklingOptions& options = {});

/// Throws as linear_model() does.
LinearModel neighbour_model(const model::Machine& machine, const spatial::Pose& X_BP,
                            const LinearModel& center);

}  // namespace hydrapod::dynamics
