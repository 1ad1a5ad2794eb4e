#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "payload.hpp"

namespace hydrapod::dynamics {

model::Machine with_seal_dampers(model::Machine machine, ModelKind kind,
                                 const spatial::Pose& X_reference) {
  const double ratio = model::seal_ratio(machine).value;
  // The base mount gets the same ratio; to who asks again, the dampers would be all that is stated.
  if (model::has_chambers(machine)) machine.damping.modal_ratio = ratio;
  const double beta = machine.damping.rayleigh_stiffness;
  for (auto& mode : machine.payload_modes)
    mode.damping_ratio += ratio + 0.5 * beta * omega_of(mode);
  if (kind == ModelKind::rigid) return machine;
  const auto geometry = kinematics::inverse_kinematics(machine, X_reference);
  for (int i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    const auto element = straight_leg(leg, geometry[i], machine.flexible_axes);
    // An elastomer says itself how it damps.
    const auto add = [&](double k, const auto& elastomer, double per_lever, double inertia,
                         double& damping) {
      const double seal_ratio = elastomer ? 0.0 : ratio;
      damping += 2.0 * seal_ratio * std::sqrt(k * inertia) / per_lever + beta * k;
    };
    const double M_phi = 0.5 * (element.M(3, 3) + element.M(4, 4));
    auto& sleeve = leg.guide_sleeve;
    // Rod and case that bend are in series with the seal and have no damper: of the offset d of
    // the chords the seal sees δ, and what damps like c of d is c (d/δ)².
    const double series = 1.0 + element.bending * sleeve.stiffness;
    double of_chords = 0.0;
    if (element.l_mh > 0.0)
      add(sleeve.stiffness / series, sleeve.elastomer, element.l_mh, M_phi, of_chords);
    sleeve.damping += series * series * of_chords;
    if (!leg.piston_ring) continue;
    const double M_u = 0.5 * (element.M(5, 5) + element.M(6, 6));
    add(leg.piston_ring->stiffness, leg.piston_ring->elastomer, 1.0, M_u, leg.piston_ring->damping);
  }
  return machine;
}

}  // namespace hydrapod::dynamics
