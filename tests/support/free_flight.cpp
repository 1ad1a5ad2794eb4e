#include "support/free_flight.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::test {

namespace {

double energy(const simulation::PlantOutput& out) {
  return out.energies.total() + out.oil_spring_energy + out.joint_bristles_energy;
}

double pose_difference(const spatial::Pose& a, const spatial::Pose& b) {
  return std::max((a.p_BP - b.p_BP).norm(), (a.R_BP - b.R_BP).norm());
}

}  // namespace

FreeFlight::FreeFlight(model::FlexibleAxes axes, dynamics::ModelKind kind) : kind_(kind) {
  Random random(40713);
  machine_ = random_machine(
      random,
      {.axes = axes, .gravity = Gravity::anywhere, .lowest_load = 0.02, .highest_load = 0.1});
  machine_.damping.modal_ratio = 0.0;
  for (auto& leg : machine_.legs) {
    leg.oil_spring = {.stiffness = machine_.platform.mass * random.uniform(40.0, 90.0)};
    leg.guide_sleeve.damping = 0.0;
    if (leg.piston_ring) leg.piston_ring->damping = 0.0;
    leg.stroke.reset();
  }
  velocity_ << random.vector(0.7), random.vector(0.7);
}

void FreeFlight::damp() {
  Random random(7);
  machine_.damping.rayleigh_mass = 0.07;
  machine_.damping.rayleigh_stiffness = 3e-5;
  for (auto& leg : machine_.legs) {
    leg.oil_spring.damping = *leg.oil_spring.stiffness * random.uniform(0.002, 0.01);
    leg.guide_sleeve.damping = 1e-4 * leg.guide_sleeve.stiffness;
    leg.piston_ring->damping = 1e-4 * leg.piston_ring->stiffness;
    leg.hydraulics.joint_friction = {.viscous = 3.0, .coulomb = 1.7, .smoothing_rate = 0.3};
  }
}

void FreeFlight::stick() {
  Random random(91);
  for (auto& leg : machine_.legs) {
    const double coulomb = machine_.platform.mass * random.uniform(0.02, 0.06);
    leg.hydraulics.joint_friction = {.coulomb = coulomb,
                                     .bristle_stiffness = coulomb * random.uniform(20.0, 60.0),
                                     .bristle_damping = coulomb * random.uniform(0.1, 0.3)};
  }
}

FlightResult FreeFlight::run(double seconds, const simulation::IntegratorOptions& options,
                             double interval) const {
  const simulation::Plant plant(machine_, kind_, {.hydraulics = false});
  auto x = plant.equilibrium(machine_.neutral()).x;
  x.segment<6>(plant.layout().velocity()) = velocity_;
  simulation::Integrator run(plant, options);
  run.start(0.0, x);
  const auto first = plant.outputs(x.data(), {});
  FlightResult result{.first_energy = first.energies.platform + first.energies.legs,
                      .smallest_dissipation = 1e300};
  const int samples = 2 * static_cast<int>(std::lround(seconds / interval / 2.0));
  auto known = first.X_BP;
  double power_sum = first.dissipation;
  for (int k = 1; k <= samples; ++k) {
    run.advance(k * interval, {});
    const auto out = plant.outputs(run.state().data(), {});
    result.energy_drift =
        std::max(result.energy_drift, std::abs(energy(out) - energy(first)) / result.first_energy);
    result.largest_swing = std::max(result.largest_swing, (out.p_BC - first.p_BC).norm());
    result.smallest_dissipation = std::min(result.smallest_dissipation, out.dissipation);
    power_sum += (k == samples ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * out.dissipation;
    if (k % 10 != 0) continue;
    spatial::Vector6 lengths;
    for (int i = 0; i < model::leg_count; ++i) lengths[i] = out.legs[i].length;
    const auto forward = kinematics::forward_kinematics(machine_, lengths, known);
    known = forward.X_BP;
    const spatial::Vector6 difference = lengths - kinematics::leg_lengths(machine_, out.X_BP);
    result.kinematic_error = std::max({result.kinematic_error, pose_difference(known, out.X_BP),
                                       difference.lpNorm<Eigen::Infinity>()});
  }
  result.lost = energy(first) - energy(plant.outputs(run.state().data(), {}));
  result.dissipated = power_sum * interval / 3.0;
  return result;
}

}  // namespace hydrapod::test
