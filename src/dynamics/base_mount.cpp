#include "base_mount.hpp"

#include <Eigen/LU>

namespace hydrapod::dynamics {

namespace {

/// K of the platform's coordinates on a base that stands still.
Matrix6 platform_stiffness(const LinearModel& model) {
  Matrix6 K = model.K.topLeftCorner<6, 6>();
  for (int i = 0; i < model::leg_count; ++i)
    K += model.J[i].transpose() * model.legs[i].K.topLeftCorner<3, 3>() * model.J[i];
  return K;
}

/// Motion of the platform's mass centre per motion of the base with all legs held.
Matrix6 carried_by_base(const LinearModel& model) {
  Matrix6 T = Matrix6::Identity();
  T.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
  return T;
}

/// Of the mount, 0 where the base does not give way.
Vector6 springs(const model::BaseMount& mount) {
  Vector6 stiffness;
  for (int k = 0; k < 6; ++k)
    stiffness[k] = mount.stiffness[static_cast<std::size_t>(k)].value_or(0.0);
  return stiffness;
}

Vector6 own_inertia(const model::BaseMount& mount) {
  Vector6 inertia;
  inertia << Vector3::Constant(mount.mass), mount.inertia;
  return inertia;
}

/// Σ p_i per motion y of the machine against its base.
PlatformRows momentum(const LegsOnBase& legs, const LinearModel& model) {
  const int flexible = flexible_per_leg(model.kind);
  PlatformRows P = PlatformRows::Zero(6, degrees_of_freedom(model.kind));
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& p = legs[i].momentum;
    P.leftCols<6>() += p.leftCols<3>() * model.J[i];
    P.middleCols(model.first_of_leg(i), flexible) += p.middleCols(3, flexible);
  }
  return P;
}

/// The directions that give way have coordinates of their own.
struct Border {
  ModelMatrix with_rest{};  ///< rows: all other coordinates
  ModelMatrix own{};
};

/// Puts the base's rows and columns behind those of A.
void extend(const Border& base, ModelMatrix& A) {
  const auto n = A.rows(), count = base.own.rows();
  ModelMatrix all(n + count, n + count);
  all.topLeftCorner(n, n) = A;
  all.topRightCorner(n, count) = base.with_rest;
  all.bottomLeftCorner(count, n) = base.with_rest.transpose();
  all.bottomRightCorner(count, count) = base.own;
  A = all;
}

/// What the base feels of a matrix of the motion against it: y_rel = y − T q_b.
Border carried(const ModelMatrix& A, const BaseColumns& T) {
  const ModelMatrix A_T = A.leftCols<6>() * T;
  return {-A_T, T.transpose() * A_T.topRows<6>()};
}

}  // namespace

void condense_base(const model::BaseMount& mount, LinearModel& model) {
  const Matrix6 T = carried_by_base(model);
  const Vector6 stiffness = springs(mount);
  Vector6 give = Vector6::Zero();
  for (int k = 0; k < 6; ++k)
    if (stiffness[k] != 0.0) give[k] = 1.0 / stiffness[k];
  const Matrix6 K_rr = platform_stiffness(model);
  const Matrix6 A = Matrix6::Identity() + give.asDiagonal() * (T.transpose() * K_rr * T);
  const Matrix6 G =
      Eigen::PartialPivLU<Matrix6>(A).solve(Matrix6(give.asDiagonal() * (T.transpose() * K_rr)));
  const Matrix6 against_base = Matrix6::Identity() - T * G;

  model.base_moves = true;
  model.against_base.leftCols<6>() = against_base;
  model.K_mount = G.transpose() * stiffness.asDiagonal() * G;
  const Matrix6 K_platform = model.K.topLeftCorner<6, 6>();  // what turns the joints' forces
  model.K.topLeftCorner<6, 6>() =
      against_base.transpose() * K_platform * against_base + model.K_mount;
  for (auto& J : model.J) J = J * against_base;
}

void add_base_coordinates(const model::BaseMount& mount, const LegsOnBase& legs,
                          const ModelMatrix& M_legs, LinearModel& model) {
  const auto& directions = model.base_directions;
  const BaseColumns T = carried_by_base(model)(Eigen::all, directions);
  model.base_moves = true;
  model.legs_on_base = legs;
  model.base_inertia = own_inertia(mount);
  model.k_mount = springs(mount);
  model.carried_by_base = T;
  model.against_base.middleCols(model.first_of_base(), T.cols()) = -T;

  Border K = carried(model.K, T);
  K.own.diagonal() += model.k_mount(directions);
  extend(K, model.K);
  extend(carried(model.C, T), model.C);

  Matrix6 inertia = model.base_inertia.asDiagonal();
  for (const auto& leg : legs) inertia += leg.inertia;
  const ModelMatrix P = momentum(legs, model)(directions, Eigen::all);
  const ModelMatrix P_T = P.leftCols<6>() * T;
  Border M = carried(M_legs, T);
  M.with_rest += P.transpose();
  M.own += inertia(directions, directions) - P_T - P_T.transpose();
  extend(M, model.M);
}

}  // namespace hydrapod::dynamics
