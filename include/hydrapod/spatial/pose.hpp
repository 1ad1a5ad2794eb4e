#pragma once
/// Rotations, poses and 6-vectors, thin over Eigen.
///
/// Notation (docs/notation.md): `R_BP` turns vectors from frame P into frame B, `p_BP` is the
/// origin of P seen from the origin of B, in B [m]. A pose `X_BP` is the pair. 6-vectors are linear
/// first: (x, y, z, rx, ry, rz). SI and radians.
///
/// Names of the six directions of a 6-vector, linear ones first.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

namespace hydrapod::spatial {

inline constexpr std::array<const char*, 6> direction_names{"x", "y", "z", "rx", "ry", "rz"};

/// The name of direction 0 … 5.
constexpr const char* direction_name(int direction) {
  return direction_names.at(static_cast<std::size_t>(direction));
}

/// The direction of that name.
constexpr std::optional<int> direction_from_name(std::string_view name) {
  for (int k = 0; k < 6; ++k)
    if (name == direction_name(k)) return k;
  return std::nullopt;
}

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
