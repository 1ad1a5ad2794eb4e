#pragma once
/// Inverse kinematics and the leg Jacobian.
///
///     L = a − b,   a = p_BP + R_BP a_P,   l = |L|,   n = L / l
///     l̇ = nᵀ v_a,  v_a = v_Q + ω × (a − Q)                         (Eq. 12)
///
/// so the row of leg i in J_l_q is [nᵀ, ((a − Q) × n)ᵀ] for the platform twist (v_Q; ω) in base
/// axes about a reference point Q.

#include <array>

#include "hydrapod/model/machine.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::kinematics {

using spatial::Matrix6;
using spatial::Pose;
using spatial::Vector3;
using spatial::Vector6;

/// One leg at a pose, in base axes.
struct LegGeometry {
  Vector3 a{};      ///< platform joint [m]
  Vector3 n{};      ///< unit vector from base joint to platform joint; NaN for a leg of no length
  double length{};  ///< l [m]
};

using LegGeometries = std::array<LegGeometry, model::leg_count>;

LegGeometries inverse_kinematics(const model::Machine& machine, const Pose& X_BP);

/// Leg lengths [m] only.
Vector6 leg_lengths(const model::Machine& machine, const Pose& X_BP);

/// J_l_q (6×6, row per leg): l̇ = J_l_q (v_Q; ω). `p_BQ`: the reference point Q in B [m].
Matrix6 leg_jacobian(const LegGeometries& legs, const Vector3& p_BQ);

/// The platform's mass centre C in B [m]: the reference point of all dynamics.
inline Vector3 mass_center(const model::Machine& machine, const Pose& X_BP) {
  return X_BP * machine.platform.mass_center;
}

}  // namespace hydrapod::kinematics
