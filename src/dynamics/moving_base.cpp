#include "hydrapod/dynamics/nonlinear.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The rigid machine on a base that stands still.
LinearModel rigid_machine(const NonlinearModel& model, const double* y) {
  Motion motion;
  const VectorXd still = VectorXd::Zero(model.velocities());
  model.motion(y, still.data(), motion);
  auto machine = model.machine();
  machine.base_mount.reset();
  machine.payload_modes.clear();
  return linear_model(machine, motion.X_BP, ModelKind::rigid);
}

double highest_frequency(const LinearModel& rigid) {
  const Matrix6 K = rigid.K, M = rigid.M;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(K, M, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues()[5], 0.0));
}

/// Springs of the legs against a motion of the base with the platform held.
Matrix6 legs_on_base(const model::Machine& machine, const LinearModel& rigid) {
  Matrix6 K = Matrix6::Zero();
  for (int i = 0; i < model::leg_count; ++i) {
    const Vector3 n = rigid.legs[i].frame.R_BL.col(2);
    Vector6 row;
    row << n, machine.legs[i].base_joint.cross(n);
    K += rigid.legs[i].k_h * row * row.transpose();
  }
  return K;
}

/// `full` in the directions that give way.
MatrixXd part(const Matrix6& full, const MovingBase& base) {
  MatrixXd A(base.count, base.count);
  for (int i = 0; i < base.count; ++i)
    for (int j = 0; j < base.count; ++j) A(i, j) = full(base.directions[i], base.directions[j]);
  return A;
}

/// Inertia that brings every vibration of (K, S) down to ω_max: of S x = ν K x those with
/// ν < 1/ω_max² get what is missing.
Matrix6 missing_inertia(const Matrix6& S, const Matrix6& K, double omega_max,
                        const MovingBase& base) {
  const MatrixXd K_free = part(K, base);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(part(S, base), K_free);
  MatrixXd missing = MatrixXd::Zero(base.count, base.count);
  for (int k = 0; k < base.count; ++k) {
    const double lack = 1.0 / (omega_max * omega_max) - solver.eigenvalues()[k];
    if (lack <= 0.0) continue;
    const VectorXd force = K_free * solver.eigenvectors().col(k);
    missing += lack * force * force.transpose();
  }
  Matrix6 all = Matrix6::Zero();
  for (int i = 0; i < base.count; ++i)
    for (int j = 0; j < base.count; ++j)
      all(base.directions[i], base.directions[j]) = missing(i, j);
  return all;
}

/// M_b + P ∂v̇/∂a_b: what the base's springs feel of it with the platform free in its directions.
Matrix6 felt_inertia(const BaseCoupling& coupling, const BaseResponse& per_base) {
  return coupling.inertia + coupling.momentum * per_base;
}

}  // namespace

Vector6 carried(const Vector6& base, const Vector3& r) {
  Vector6 result = base;
  result.head<3>() += Vector3(base.tail<3>()).cross(r);
  return result;
}

double MovingBase::kinetic_energy(const Vector6& rates, const double* v) const {
  const Eigen::Map<const VectorXd> against_base(v, coupling.momentum.cols());
  return rates.dot(0.5 * coupling.inertia * rates + coupling.momentum * against_base);
}

double MovingBase::elastic_energy(const Vector6& motion) const {
  return 0.5 * motion.dot(stiffness.cwiseProduct(motion));
}

Vector6 MovingBase::acceleration(const Vector6& motion, const Vector6& rates, const double* v_rate,
                                 const BaseResponse& per_base, const Vector6& wrench,
                                 const Vector3& p_BC) const {
  const Eigen::Map<const VectorXd> against_base(v_rate, coupling.momentum.cols());
  const Matrix6 S = felt_inertia(coupling, per_base);
  Vector6 force = wrench;
  force.tail<3>() += p_BC.cross(Vector3(wrench.head<3>()));
  force -= stiffness.cwiseProduct(motion) + damping.cwiseProduct(rates);
  force.noalias() -= coupling.momentum * against_base;
  Matrix6 free = Matrix6::Identity();
  Vector6 right = Vector6::Zero();
  for (int i = 0; i < count; ++i) {
    right[directions[i]] = force[directions[i]];
    for (int j = 0; j < count; ++j)
      free(directions[i], directions[j]) = S(directions[i], directions[j]);
  }
  return Eigen::LLT<Matrix6>(free).solve(right);
}

MovingBase moving_base(const NonlinearModel& model, const double* y) {
  const auto& machine = model.machine();
  const auto& mount = *machine.base_mount;
  MovingBase base;
  for (int k = 0; k < 6; ++k) {
    const auto& stiffness = mount.stiffness[static_cast<std::size_t>(k)];
    if (!stiffness) continue;
    base.stiffness[k] = *stiffness;
    base.directions[static_cast<std::size_t>(base.count++)] = k;
  }
  base.coupling = model.base_coupling(y);
  base.coupling.inertia.diagonal().head<3>().array() += mount.mass;
  base.coupling.inertia.diagonal().tail<3>() += mount.inertia;
  if (base.count == 0) return base;

  Motion motion;
  const VectorXd still = VectorXd::Zero(model.velocities());
  VectorXd v_rate(model.velocities());
  BaseResponse per_base;
  model.motion(y, still.data(), motion);
  model.accelerations(motion, {}, base.coupling.momentum, v_rate.data(), per_base);
  const auto rigid = rigid_machine(model, y);
  Matrix6 K = legs_on_base(machine, rigid);
  K.diagonal() += base.stiffness;
  base.added_inertia = missing_inertia(felt_inertia(base.coupling, per_base), K,
                                       MovingBase::fastest * highest_frequency(rigid), base);
  base.coupling.inertia += base.added_inertia;

  const double ratio = model::seal_ratio(machine).value;
  base.damping =
      2.0 * ratio * base.stiffness.cwiseProduct(base.coupling.inertia.diagonal()).cwiseSqrt() +
      machine.damping.rayleigh_stiffness * base.stiffness;
  return base;
}

}  // namespace hydrapod::dynamics
