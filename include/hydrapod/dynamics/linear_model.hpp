#pragma once
/// The three linear models of a hexapod at any pose: M ÿ + C ẏ + K y = F.
///
///     y = (x, y, z, rx, ry, rz | φ1, φ2 (, u1, u2) of leg 1 | … | of leg 6)
///
/// The platform's six are the motion of its mass centre C [m] and its rotation [rad], both in base
/// axes, against the ground; the flexible coordinates are those of LegElement. Summing T and V of
/// platform and legs gives M and K, symmetric, M positive definite. Without gravity M and K have no
/// preload terms and the upper-left 6×6 of M is the rigid model's M. With gravity everything is
/// linearised about the static equilibrium (statics.hpp) of that very model. Derivation:
/// docs/theory/linear-model.md.

#include <string>
#include <vector>

#include "hydrapod/dynamics/leg_element.hpp"
#include "hydrapod/dynamics/statics.hpp"

namespace hydrapod::dynamics {

inline constexpr int max_dof = degrees_of_freedom(ModelKind::full);
/// Square, 6, 18 or 30 rows, on the stack.
using ModelMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_dof, max_dof>;
using ModelVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_dof, 1>;

struct LinearModel {
  ModelKind kind{};
  spatial::Pose X_BP{};
  Vector3 p_BC{};           ///< the platform's mass centre [m]
  Matrix6 platform_mass{};  ///< diag(m I, R I_C Rᵀ)
  std::array<LegElement, model::leg_count> legs{};
  /// Per leg: motion of its platform joint, seen from its base joint, along (t, a2, n) per platform
  /// motion, 3×6.
  std::array<Eigen::Matrix<double, 3, 6>, model::leg_count> J{};
  StaticEquilibrium statics{};
  bool base_moves{};
  /// I − T G: the motion of C against the base, which leg lengths show, per motion of C against the
  /// ground, which the platform's six of y are. 1 where the base stands still.
  Matrix6 against_base{Matrix6::Identity()};
  Matrix6 K_mount{Matrix6::Zero()};  ///< the mount's share of K_rr; see base_mount.hpp
  ModelMatrix M{}, K{};
  ModelMatrix
      C{};  ///< viscous dampers of the legs and Rayleigh damping; modal ratios are not in it

  [[nodiscard]] int dof() const { return degrees_of_freedom(kind); }
  /// Coordinates of leg i in y: joint rows J[i] times the platform's, then these.
  [[nodiscard]] int first_of_leg(int i) const { return 6 + i * flexible_per_leg(kind); }
};

/// The model `kind` of `machine` at `X_BP`. Throws base::ComputationError when the machine has no
/// static equilibrium there that Newton can find, and std::invalid_argument when ModelKind::full is
/// asked of legs without a piston ring. `start`: a neighbouring equilibrium to begin the search for
/// this one at.
LinearModel linear_model(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                         const StaticEquilibrium* start = nullptr);

/// Names of the coordinates: "x", …, "rz", "leg1.phi1", "leg1.phi2", "leg1.u1", ….
std::vector<std::string> coordinate_names(ModelKind kind);

/// "rigid", "guide", "full".
const char* name(ModelKind kind);

}  // namespace hydrapod::dynamics
