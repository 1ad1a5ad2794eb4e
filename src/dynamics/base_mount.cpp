#include "base_mount.hpp"

#include <Eigen/LU>

namespace hydrapod::dynamics {

namespace {

using Matrix67 = Eigen::Matrix<double, 6, 7>;

/// Velocity of a point at r per twist at the origin: [I, −r^×].
Eigen::Matrix<double, 3, 6> at_point(const Vector3& r) {
  Eigen::Matrix<double, 3, 6> J;
  J << Matrix3::Identity(), -spatial::skew(r);
  return J;
}

/// A body of the leg: where its mass centre is, and how it moves with x.
struct Body {
  double mass{};
  Matrix3 inertia{};
  Vector3 center{};
  Eigen::Matrix<double, 3, 7> velocity{}, rotation{};
};

/// Case and rod of a straight leg, in B (Eq. 11 with the piston's offset).
std::array<Body, 2> bodies(const model::Leg& leg, const LegElement& element) {
  const Matrix3& R = element.frame.R_BL;
  const Vector3 n = R.col(2);
  const Matrix3 n_cross = spatial::skew(n);
  Eigen::Matrix<double, 3, 7> joint, tilt, offset;
  joint.setZero();
  tilt.setZero();
  offset.setZero();
  joint.leftCols<3>() = R;
  tilt.middleCols<2>(3) = R.leftCols<2>();
  offset.rightCols<2>() = R.leftCols<2>();
  const Eigen::Matrix<double, 3, 7> omega =
      (n_cross * (joint - offset) - leg.rod.length * tilt) / element.l;
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  const auto about = [&](double transverse, double axial) -> Matrix3 {
    return transverse * (Matrix3::Identity() - n * n.transpose()) + axial * n * n.transpose();
  };
  const double r_a = element.l_m + rod.mass_center;
  Body cylinder{tube.mass, about(tube.transverse_inertia, tube.axial_inertia),
                leg.base_joint + tube.mass_center * n};
  cylinder.rotation = omega;
  cylinder.velocity = -tube.mass_center * n_cross * omega;
  Body piston{rod.mass, about(rod.transverse_inertia, rod.axial_inertia), leg.base_joint + r_a * n};
  piston.rotation = omega + tilt;
  piston.velocity = n * (n.transpose() * joint) - r_a * n_cross * omega -
                    rod.mass_center * n_cross * tilt + offset;
  return {cylinder, piston};
}

/// Momentum about the origin of B per x, and inertia about it.
void momentum_and_inertia(const model::Leg& leg, const LegElement& element,
                          model::FlexibleAxes axes, Matrix67& p, Matrix6& inertia) {
  p.setZero();
  inertia.setZero();
  if (axes == model::FlexibleAxes::gimbal) {  // the cross of the lower gimbal turns about a1
    const Vector3& a1 = leg.gimbal_axis;
    const Vector7 omega_t =
        bodies(leg, element)[0].rotation.transpose() * element.frame.R_BL.col(0);
    p.bottomRows<3>() +=
        leg.gimbal_cross_inertia * element.frame.sec_gimbal * a1 * omega_t.transpose();
    inertia.bottomRightCorner<3, 3>() += leg.gimbal_cross_inertia * a1 * a1.transpose();
  }
  for (const auto& body : bodies(leg, element)) {
    const auto J = at_point(body.center);
    p += J.transpose() * body.mass * body.velocity;
    p.bottomRows<3>() += body.inertia * body.rotation;
    inertia += body.mass * J.transpose() * J;
    inertia.bottomRightCorner<3, 3>() += body.inertia;
  }
}

/// K of the platform's coordinates on a base that stands still.
Matrix6 platform_stiffness(const LinearModel& model) {
  Matrix6 K = model.K.topLeftCorner<6, 6>();
  for (int i = 0; i < model::leg_count; ++i)
    K += model.J[i].transpose() * model.legs[i].K.topLeftCorner<3, 3>() * model.J[i];
  return K;
}

}  // namespace

void add_base_mount(const model::Machine& machine, LinearModel& model) {
  const auto& mount = *machine.base_mount;
  Matrix6 T = Matrix6::Identity();
  T.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
  Vector6 give = Vector6::Zero(), stiffness = Vector6::Zero();
  for (int k = 0; k < 6; ++k)
    if (mount.stiffness[static_cast<std::size_t>(k)]) {
      stiffness[k] = *mount.stiffness[static_cast<std::size_t>(k)];
      give[k] = 1.0 / stiffness[k];
    }
  const Matrix6 K_rr = platform_stiffness(model);
  const Matrix6 A = Matrix6::Identity() + give.asDiagonal() * (T.transpose() * K_rr * T);
  const Matrix6 G =
      Eigen::PartialPivLU<Matrix6>(A).solve(Matrix6(give.asDiagonal() * (T.transpose() * K_rr)));
  const Matrix6 against_base = Matrix6::Identity() - T * G;

  model.base_moves = true;
  model.against_base = against_base;
  model.K_mount = G.transpose() * stiffness.asDiagonal() * G;
  const Matrix6 K_platform = model.K.topLeftCorner<6, 6>();  // what turns the joints' forces
  model.K.topLeftCorner<6, 6>() =
      against_base.transpose() * K_platform * against_base + model.K_mount;
  Vector6 base_mass;
  base_mass << Vector3::Constant(mount.mass), mount.inertia;
  Matrix6 carried = base_mass.asDiagonal();
  const int flexible = flexible_per_leg(model.kind);
  for (int i = 0; i < model::leg_count; ++i) {
    Matrix67 p;
    Matrix6 inertia;
    momentum_and_inertia(machine.legs[i], model.legs[i], machine.flexible_axes, p, inertia);
    carried += inertia;
    model.J[i] = model.J[i] * against_base;
    const Matrix6 cross = G.transpose() * p.leftCols<3>() * model.J[i];
    model.M.topLeftCorner<6, 6>() += cross + cross.transpose();
    if (flexible == 0) continue;
    const int at = model.first_of_leg(i);
    const ModelMatrix with_leg = G.transpose() * p.middleCols(3, flexible);
    model.M.block(0, at, 6, flexible) += with_leg;
    model.M.block(at, 0, flexible, 6) += with_leg.transpose();
  }
  model.M.topLeftCorner<6, 6>() += G.transpose() * carried * G;
}

}  // namespace hydrapod::dynamics
