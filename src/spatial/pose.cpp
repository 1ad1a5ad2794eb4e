#include "hydrapod/spatial/pose.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace hydrapod::spatial {

Matrix3 skew(const Vector3& v) {
  Matrix3 S;
  S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return S;
}

Matrix3 rotation_from_rpy(const Vector3& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
          Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
      .toRotationMatrix();
}

Vector3 rpy_from_rotation(const Matrix3& R) {
  const double cos_pitch = std::hypot(R(2, 1), R(2, 2));
  constexpr double gimbal_lock = 1e-12;
  const double roll = cos_pitch < gimbal_lock ? 0.0 : std::atan2(R(2, 1), R(2, 2));
  // Near the pole roll alone is uncertain; yaw that fits to it keeps the rotation exact. It is read
  // from R Rx(-roll) = Rz(yaw) Ry(pitch).
  const double s = std::sin(roll), c = std::cos(roll);
  const double yaw = std::atan2(s * R(0, 2) - c * R(0, 1), c * R(1, 1) - s * R(1, 2));
  return {roll, std::atan2(-R(2, 0), cos_pitch), yaw};
}

Matrix3 rotation_from_vector(const Vector3& w) {
  const double angle = w.norm();
  if (angle == 0.0) return Matrix3::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Pose displaced(const Pose& pose, const Vector6& displacement) {
  return {rotation_from_vector(displacement.tail<3>()) * pose.R_BP,
          pose.p_BP + displacement.head<3>()};
}

}  // namespace hydrapod::spatial
