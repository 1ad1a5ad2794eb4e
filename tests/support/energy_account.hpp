#pragma once
/// Energy of a free motion of the mechanics: what it loses, and what its dampers take.

#include <algorithm>
#include <cmath>

#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::test {

inline double energy_of(const simulation::PlantOutput& out) {
  return out.energies.total() + out.oil_spring_energy + out.base.kinetic_energy +
         out.base.elastic_energy;
}

struct EnergyAccount {
  simulation::PlantOutput first{};
  double drift{};       ///< largest change of the energy
  double lost{};        ///< at the end
  double dissipated{};  ///< by Simpson's rule
};

/// From `x`, without loads, over `samples` intervals, an even number. `each` sees every output.
template <class Each>
EnergyAccount energy_account(const simulation::Plant& plant, const Eigen::VectorXd& x, int samples,
                             double interval, Each each) {
  simulation::Integrator run(plant, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-12});
  run.start(0.0, x);
  EnergyAccount account{.first = plant.outputs(x.data(), {})};
  double power = account.first.dissipation;
  for (int k = 1; k <= samples; ++k) {
    run.advance(k * interval, {});
    const auto now = plant.outputs(run.state().data(), {});
    account.lost = energy_of(account.first) - energy_of(now);
    account.drift = std::max(account.drift, std::abs(account.lost));
    power += (k == samples ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * now.dissipation;
    each(now);
  }
  account.dissipated = power * interval / 3.0;
  return account;
}

}  // namespace hydrapod::test
