#include "payload.hpp"

#include <Eigen/Geometry>

namespace hydrapod::dynamics {

void set_payload(const model::Machine& machine, LinearModel& model) {
  const auto& modes = machine.payload_modes;
  if (modes.empty()) return;
  const auto count = static_cast<Eigen::Index>(modes.size());
  model.payload.resize(6, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& mode = modes[static_cast<std::size_t>(k)];
    const Vector6 L = participation(mode, machine.platform.mass_center);
    model.payload.col(k) << model.X_BP.R_BP * L.head<3>(), model.X_BP.R_BP * L.tail<3>();
    model.payload_names.push_back(mode.name);
    model.payload_omega2[static_cast<std::size_t>(k)] = omega_of(mode) * omega_of(mode);
  }
  model.platform_mass -= model.payload * model.payload.transpose();
}

void add_payload(const model::Machine& machine, LinearModel& model) {
  const Eigen::Index count = model.payload_count(), n = model.M.rows();
  if (count == 0) return;
  BaseColumns weight = BaseColumns::Zero(6, count);  // −(force of ξ on the platform) per ξ
  for (Eigen::Index k = 0; k < count; ++k)
    weight.col(k).tail<3>() = machine.gravity.cross(Vector3(model.payload.col(k).head<3>()));
  for (ModelMatrix* A : {&model.M, &model.K, &model.C}) {
    const ModelMatrix without = *A;
    A->setZero(n + count, n + count);
    A->topLeftCorner(n, n) = without;
  }
  model.M.block(0, n, 6, count) = model.payload;
  model.M.block(n, 0, count, 6) = model.payload.transpose();
  const ModelMatrix coupling = model.against_base.leftCols(n).transpose() * weight;
  model.K.topRightCorner(n, count) = coupling;
  model.K.bottomLeftCorner(count, n) = coupling.transpose();
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& mode = machine.payload_modes[static_cast<std::size_t>(k)];
    model.M(n + k, n + k) = 1.0;
    model.K(n + k, n + k) = omega_of(mode) * omega_of(mode);
    model.C(n + k, n + k) = 2.0 * mode.damping_ratio * omega_of(mode);
  }
}

}  // namespace hydrapod::dynamics
