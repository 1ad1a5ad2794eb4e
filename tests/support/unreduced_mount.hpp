#pragma once
/// A rigid machine on a base that gives way, with all twelve coordinates: six of the platform's
/// mass centre against the ground, six of the base. Each leg is two bodies whose motion follows
/// from where its ends are. Straight legs, no gravity. Nothing is shared with the library's mounts
/// but the springs.

#include <Eigen/Geometry>

#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::test {

using Matrix12 = Eigen::Matrix<double, 12, 12>;

struct UnreducedMount {
  Matrix12 M{Matrix12::Zero()}, K{Matrix12::Zero()};
  /// Motion of the mass centre against the base, per coordinate.
  Eigen::Matrix<double, 6, 12> against_base{};
};

inline UnreducedMount unreduced_mount(const model::Machine& machine, const spatial::Pose& X_BP) {
  const auto C = kinematics::mass_center(machine, X_BP);
  const auto geometry = kinematics::inverse_kinematics(machine, X_BP);
  UnreducedMount system;
  Matrix12 &M = system.M, &K = system.K;
  auto& against_base = system.against_base;
  M.topLeftCorner<3, 3>().diagonal().setConstant(machine.platform.mass);
  M.block<3, 3>(3, 3) = X_BP.R_BP * machine.platform.inertia * X_BP.R_BP.transpose();
  against_base << Eigen::Matrix<double, 6, 6>::Identity(), -Eigen::Matrix<double, 6, 6>::Identity();
  against_base.topRightCorner<3, 3>() = spatial::skew(C);
  const auto& mount = *machine.base_mount;
  for (int k = 0; k < 6; ++k) {
    K(6 + k, 6 + k) = mount.stiffness[static_cast<std::size_t>(k)].value_or(0.0);
    M(6 + k, 6 + k) = k < 3 ? mount.mass : mount.inertia[k - 3];
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& leg = machine.legs[i];
    const spatial::Vector3 n = geometry[i].n;
    const double l = geometry[i].length;
    Eigen::Matrix<double, 3, 12> top, foot;
    top.setZero();
    foot.setZero();
    top.leftCols<3>().setIdentity();
    top.middleCols<3>(3) = -spatial::skew(geometry[i].a - C);
    foot.middleCols<3>(6).setIdentity();
    foot.rightCols<3>() = -spatial::skew(leg.base_joint);
    // a rod between two moving ends: case hangs on the foot, rod on the top
    const Eigen::Matrix<double, 3, 12> rate = spatial::skew(n) * (top - foot) / l;
    const auto add = [&](double m, const Eigen::Matrix<double, 3, 12>& v, double I) {
      M += m * v.transpose() * v + I * rate.transpose() * rate;
    };
    add(leg.cylinder_case.mass, foot - leg.cylinder_case.mass_center * spatial::skew(n) * rate,
        leg.cylinder_case.transverse_inertia);
    add(leg.rod.mass, top + (leg.rod.length - leg.rod.mass_center) * spatial::skew(n) * rate,
        leg.rod.transverse_inertia);
    const Eigen::Matrix<double, 1, 12> stretch = n.transpose() * (top - foot);
    M += leg.added_axial_inertia * stretch.transpose() * stretch;
    K +=
        hydraulics::axial_spring(leg, l - leg.rod.length).stiffness * stretch.transpose() * stretch;
  }
  return system;
}

}  // namespace hydrapod::test
