#include "hydrapod/kinematics/legs.hpp"

#include <Eigen/Geometry>

namespace hydrapod::kinematics {

LegGeometries inverse_kinematics(const model::Machine& machine, const Pose& X_BP) {
  LegGeometries legs;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    legs[i].a = X_BP * leg.platform_joint;
    const Vector3 L = legs[i].a - leg.base_joint;
    legs[i].length = L.norm();
    legs[i].n = L / legs[i].length;
  }
  return legs;
}

Vector6 leg_lengths(const model::Machine& machine, const Pose& X_BP) {
  Vector6 lengths;
  for (int i = 0; i < model::leg_count; ++i)
    lengths[i] = (X_BP * machine.legs[i].platform_joint - machine.legs[i].base_joint).norm();
  return lengths;
}

Matrix6 leg_jacobian(const LegGeometries& legs, const Vector3& p_BQ) {
  Matrix6 J;
  for (int i = 0; i < model::leg_count; ++i) {
    J.row(i).head<3>() = legs[i].n;
    J.row(i).tail<3>() = (legs[i].a - p_BQ).cross(legs[i].n);
  }
  return J;
}

}  // namespace hydrapod::kinematics
