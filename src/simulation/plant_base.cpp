/// The plant's base on its springs; see dynamics/nonlinear.hpp.

#include "plant_work.hpp"

namespace hydrapod::simulation {

/// After everything else in the state.
void Plant::set_base(const Pose& X_reference) {
  if (!machine_.base_mount) return;
  base_ = dynamics::moving_base(mechanics_, mechanics_at_rest(X_reference).data());
  if (base_.count == 0) return;
  layout_.base = layout_.size;
  layout_.size += 2 * base_.count;
}

/// Motion (`first` = layout.base) or rates of the base, all six directions.
Vector6 Plant::base_part(const double* x, int first) const {
  Vector6 all = Vector6::Zero();
  for (int k = 0; k < base_.count; ++k)
    all[base_.directions[static_cast<size_t>(k)]] = x[first + k];
  return all;
}

/// Accelerations of the mechanism and of the base.
void Plant::base_side(const double* x, const dynamics::Loads& loads, double* rate,
                      Work& work) const {
  const int motions = layout_.base, rates = layout_.base + base_.count;
  double* v_rate = rate + layout_.velocity();
  dynamics::BaseResponse per_base;
  mechanics_.accelerations(work.motion, loads, base_.coupling.momentum, v_rate, per_base);
  const Vector6 v_base = base_part(x, rates);
  work.base_acceleration = base_.acceleration(base_part(x, motions), v_base, v_rate, per_base,
                                              loads.wrench, work.motion.p_BC);
  Eigen::Map<Eigen::VectorXd>(v_rate, layout_.velocities) += per_base * work.base_acceleration;
  work.base_acceleration -= machine_.damping.rayleigh_mass * v_base;
  for (int k = 0; k < base_.count; ++k) {
    rate[motions + k] = x[rates + k];
    rate[rates + k] = work.base_acceleration[base_.directions[static_cast<size_t>(k)]];
  }
}

void Plant::base_outputs(const double* x, const Work& work, PlantOutput& out) const {
  if (base_.count == 0) return;
  auto& base = out.base;
  base.motion = base_part(x, layout_.base);
  base.rate = base_part(x, layout_.base + base_.count);
  base.acceleration = work.base_acceleration;
  base.kinetic_energy = base_.kinetic_energy(base.rate, x + layout_.velocity());
  base.elastic_energy = base_.elastic_energy(base.motion);
  out.dissipation += base.rate.dot(base_.damping.cwiseProduct(base.rate));
}

}  // namespace hydrapod::simulation
