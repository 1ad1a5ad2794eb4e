#include "hydrapod/kinematics/legs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hydrapod::kinematics {

namespace {

/// J D⁻¹ about the mean of the platform joints.
struct ScaledJacobian {
  double length{};  ///< r
  Matrix6 J{};
};

ScaledJacobian scaled_jacobian(const model::Machine& machine, const Pose& X_BP) {
  const auto legs = inverse_kinematics(machine, X_BP);
  Vector3 center = Vector3::Zero();
  for (const auto& leg : legs) center += leg.a / model::leg_count;
  double sum = 0.0;
  for (const auto& leg : legs) sum += (leg.a - center).squaredNorm();
  ScaledJacobian scaled{.length = std::sqrt(sum / model::leg_count),
                        .J = leg_jacobian(legs, center)};
  scaled.J.rightCols<3>() /= scaled.length;
  return scaled;
}

/// No less than the condition, without singular values: 2 (|J|/√6)⁶ / |det J| in the norm of
/// Frobenius (H. W. Guggenheimer, A. S. Edelman, C. R. Johnson, College Mathematics Journal 26
/// (1995) 2).
double largest_condition(const Matrix6& J) {
  const double mean = J.squaredNorm() / 6.0;
  return 2.0 * mean * mean * mean / std::abs(J.partialPivLu().determinant());
}

}  // namespace

PoseQuality pose_quality(const model::Machine& machine, const Pose& X_BP) {
  const auto [length, J] = scaled_jacobian(machine, X_BP);
  PoseQuality quality{.characteristic_length = length};
  if (!J.allFinite()) {  // a leg of no length has no direction, and the pose no singular values
    quality.singular_values.setZero();
    quality.weakest_direction.setZero();
    quality.condition = std::numeric_limits<double>::infinity();
    return quality;
  }
  const Eigen::JacobiSVD<Matrix6> svd(J, Eigen::ComputeFullV);
  quality.singular_values = svd.singularValues();
  const double smallest = quality.singular_values[5];
  quality.condition = smallest > 0.0 ? quality.singular_values[0] / smallest
                                     : std::numeric_limits<double>::infinity();
  quality.weakest_direction = svd.matrixV().col(5);
  Eigen::Index largest = 0;
  quality.weakest_direction.cwiseAbs().maxCoeff(&largest);
  if (quality.weakest_direction[largest] < 0.0) quality.weakest_direction *= -1.0;
  quality.weakest_direction.tail<3>() /= quality.characteristic_length;
  return quality;
}

double pose_condition(const model::Machine& machine, const Pose& X_BP) {
  const Matrix6 J = scaled_jacobian(machine, X_BP).J;
  // Rounding of JᵀJ changes the squares of the smallest singular values by up to a few ε κ².
  constexpr double squares_serve = 100.0;
  if (!(largest_condition(J) < squares_serve)) return pose_quality(machine, X_BP).condition;
  const Matrix6 squares = J.transpose() * J;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(squares, Eigen::EigenvaluesOnly);
  return std::sqrt(eigen.eigenvalues()[5] / eigen.eigenvalues()[0]);
}

bool is_singular(const model::Machine& machine, const Pose& X_BP) {
  if (largest_condition(scaled_jacobian(machine, X_BP).J) < singular_condition) return false;
  return !(pose_quality(machine, X_BP).condition < singular_condition);
}

namespace {

double angle_between(const Vector3& u, const Vector3& v) {
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// The lower gimbal's angles of a leg along n: θ2 tilts out of the plane normal to a1, θ1 turns
/// about a1, measured from the fixed plane through a1 and the neutral direction n0.
std::pair<double, double> gimbal_angles(const Vector3& a1, const Vector3& n0, const Vector3& n) {
  const Vector3 x = (n0 - a1 * a1.dot(n0)).normalized();
  const Vector3 y = a1.cross(x);
  return {std::atan2(y.dot(n), x.dot(n)), std::asin(std::clamp(a1.dot(n), -1.0, 1.0))};
}

}  // namespace

bool has_joint_limits(const model::Machine& machine) {
  return std::ranges::any_of(machine.legs, [](const model::Leg& leg) {
    return leg.joint_limits.base || leg.joint_limits.platform;
  });
}

std::array<JointAngles, model::leg_count> joint_angles(const model::Machine& machine,
                                                       const Pose& X_BP) {
  const Pose& neutral = machine.neutral();
  const auto now = inverse_kinematics(machine, X_BP);
  const auto then = inverse_kinematics(machine, neutral);
  std::array<JointAngles, model::leg_count> angles;
  for (int i = 0; i < model::leg_count; ++i) {
    const Vector3& a1 = machine.legs[i].gimbal_axis;
    const auto [now_1, now_2] = gimbal_angles(a1, then[i].n, now[i].n);
    const auto [then_1, then_2] = gimbal_angles(a1, then[i].n, then[i].n);
    angles[i] = {.gimbal_1 = now_1 - then_1,
                 .gimbal_2 = now_2 - then_2,
                 .base_tilt = angle_between(now[i].n, then[i].n),
                 .platform_tilt = angle_between(X_BP.R_BP.transpose() * now[i].n,
                                                neutral.R_BP.transpose() * then[i].n)};
  }
  return angles;
}

double stroke_left(const model::Machine& machine, const Pose& X_BP) {
  const spatial::Vector6 lengths = leg_lengths(machine, X_BP);
  double least = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[static_cast<std::size_t>(i)];
    if (!leg.stroke) continue;
    const double extended = lengths[i] - leg.rod.length - leg.stroke->retracted;
    least = std::fmin(least, std::min(extended, leg.stroke->length - extended));
  }
  return least;
}

}  // namespace hydrapod::kinematics
