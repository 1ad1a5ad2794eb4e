#pragma once
/// Rotations, poses and 6-vectors, thin over Eigen.
///
/// Notation (docs/notation.md): `R_BP` turns vectors from frame P into frame B, `p_BP` is the
/// origin of P seen from the origin of B, in B [m]. A pose `X_BP` is the pair. 6-vectors are linear
/// first: (x, y, z, rx, ry, rz). SI and radians.

#include <Eigen/Core>

namespace hydrapod::spatial {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Where the platform frame P stands in the base frame B.
struct Pose {
  Matrix3 R_BP{Matrix3::Identity()};  ///< orthonormal, right-handed
  Vector3 p_BP{Vector3::Zero()};      ///< [m]

  /// The base-frame position [m] of a point fixed in the platform at `p_PQ` [m].
  [[nodiscard]] Vector3 operator*(const Vector3& p_PQ) const { return R_BP * p_PQ + p_BP; }
};

/// v^× : the matrix with skew(v) w = v × w.
Matrix3 skew(const Vector3& v);

/// R = Rz(yaw) Ry(pitch) Rx(roll), angles [rad] given as (rx, ry, rz).
Matrix3 rotation_from_rpy(const Vector3& rpy);

/// Inverse of rotation_from_rpy with pitch in [-π/2, π/2]. At |pitch| = π/2 roll is set to zero.
Vector3 rpy_from_rotation(const Matrix3& R);

/// Rotation by |w| about w [rad] (exponential map).
Matrix3 rotation_from_vector(const Vector3& w);

/// `pose` moved by a small or large displacement (v, w): p += v, R = exp(w^×) R, both in base axes.
Pose displaced(const Pose& pose, const Vector6& displacement);

}  // namespace hydrapod::spatial
