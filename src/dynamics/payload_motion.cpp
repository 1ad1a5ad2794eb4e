#include "payload_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "payload.hpp"

namespace hydrapod::dynamics {

PayloadConstants::PayloadConstants(const model::Machine& machine, const Vector3& weight_at_rest)
    : count(static_cast<int>(machine.payload_modes.size())), weight(weight_at_rest) {
  L.setZero();
  omega2.setOnes();
  damping.setZero();
  for (int k = 0; k < count; ++k) {
    const auto& mode = machine.payload_modes[static_cast<std::size_t>(k)];
    L.col(k) = participation(mode, machine.platform.mass_center);
    omega2[k] = omega_of(mode) * omega_of(mode);
    damping[k] = 2.0 * mode.damping_ratio * omega_of(mode);
  }
}

Vector6 PayloadConstants::at_rest(const Vector3& g_P) const {
  return (L.topRows<3>().transpose() * (g_P - weight)).cwiseQuotient(omega2);
}

StaticEquilibrium rest_with_payload(const model::Machine& machine, const spatial::Pose& X_BP,
                                    ModelKind kind, const PayloadConstants& payload,
                                    const StaticsOptions& options) {
  const Vector3 weight = X_BP.R_BP.transpose() * machine.gravity;
  if (payload.count == 0 || weight == payload.weight)
    return static_equilibrium(machine, X_BP, kind, options);
  auto hanging = machine;
  hanging.platform.mass_center +=
      payload.L.topRows<3>() * payload.at_rest(weight) / machine.platform.mass;
  return static_equilibrium(hanging, X_BP, kind, options);
}

PayloadInMotion::PayloadInMotion(const PayloadConstants& payload, const Motion& motion,
                                 const Vector3& gravity)
    : count(payload.count) {
  if (count == 0) return;
  const Matrix3& R = motion.X_BP.R_BP;
  const Vector3 omega = motion.twist.tail<3>();
  L.resize(6, count);
  L.topRows<3>() = R * payload.L.topLeftCorner(3, count);
  L.bottomRows<3>() = R * payload.L.bottomLeftCorner(3, count);
  const auto xi = motion.payload.head(count), xi_rate = motion.payload_rate.head(count);
  pull = payload.omega2.head(count).cwiseProduct(xi) +
         payload.damping.head(count).cwiseProduct(xi_rate) -
         L.topRows<3>().transpose() * (gravity - R * payload.weight);
  offset = L.topRows<3>() * xi;
  rates = L * xi_rate;
  inertia << -2.0 * omega.cross(Vector3(rates.head<3>())) - omega.cross(omega.cross(offset)),
      -omega.cross(Vector3(rates.tail<3>())) + offset.cross(gravity);
}

void PayloadInMotion::eliminate(Matrix6& M, Vector6& force) const {
  if (count == 0) return;
  M -= L * L.transpose();
  M.bottomLeftCorner<3, 3>() += spatial::skew(offset);
  force += inertia + L * pull;
}

void PayloadInMotion::accelerations(const Vector6& platform, double* to) const {
  if (count == 0) return;
  const Modes xi = -(L.transpose() * platform) - pull;
  std::copy(xi.data(), xi.data() + count, to);
}

void PayloadInMotion::add_mass(Eigen::MatrixXd& M, Eigen::Index first) const {
  if (count == 0) return;
  M.block<3, 3>(3, 0) += spatial::skew(offset);
  M.block<3, 3>(0, 3) -= spatial::skew(offset);
  M.block(0, first, 6, count) = L;
  M.block(first, 0, count, 6) = L.transpose();
  M.block(first, first, count, count).diagonal().setOnes();
}

void add_payload_energies(const PayloadConstants& payload, const Motion& motion,
                          const Vector3& gravity, Energies& energies) {
  if (payload.count == 0) return;
  const PayloadInMotion now(payload, motion, gravity);
  const Vector3 velocity = motion.twist.head<3>(), omega = motion.twist.tail<3>();
  const Vector3 offset_rate = Vector3(now.rates.head<3>()) + omega.cross(now.offset);
  energies.platform += velocity.dot(offset_rate) + omega.dot(now.rates.tail<3>()) +
                       0.5 * motion.payload_rate.squaredNorm();
  energies.payload = 0.5 * motion.payload.dot(payload.omega2.cwiseProduct(motion.payload));
  energies.gravity -= now.offset.dot(gravity - motion.X_BP.R_BP * payload.weight);
}

double payload_dissipation(const PayloadConstants& payload, const Motion& motion) {
  if (payload.count == 0) return 0.0;
  return motion.payload_rate.dot(payload.damping.cwiseProduct(motion.payload_rate));
}

}  // namespace hydrapod::dynamics
