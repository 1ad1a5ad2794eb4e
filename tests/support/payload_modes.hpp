#pragma once
/// Payloads that are not rigid, with ugly numbers.

#include "hydrapod/base/units.hpp"
#include "hydrapod/model/machine.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

/// [rad/s]
inline double omega_of(const model::PayloadMode& mode) { return base::two_pi * mode.frequency; }

/// `count` masses on springs above the platform, each of 5 to 12 % of its mass, in odd directions,
/// from `slowest` to `fastest` [rad/s].
inline void put_modes_on(model::Machine& machine, int count, Random& random, double slowest = 23.0,
                         double fastest = 160.0) {
  double size = 0.0;
  for (const auto& leg : machine.legs) size = std::max(size, leg.platform_joint.norm());
  for (int k = 0; k < count; ++k) {
    model::PayloadMode mode{.name = "mass" + std::to_string(k + 1)};
    mode.frequency = random.log_uniform(slowest, fastest) / base::two_pi;
    mode.mass = random.uniform(0.05, 0.12) * machine.platform.mass;
    mode.position = machine.platform.mass_center + random.vector(0.25 * size);
    mode.direction = random.vector(1.7);
    machine.payload_modes.push_back(mode);
  }
}

/// The same mode by numbers instead of a mass.
inline model::PayloadMode by_participation(const model::PayloadMode& mode) {
  const auto L = model::participation(mode);
  model::PayloadMode same{
      .name = mode.name, .frequency = mode.frequency, .damping_ratio = mode.damping_ratio};
  same.participation = L.head<3>();
  same.participation_moment = L.tail<3>();
  return same;
}

}  // namespace hydrapod::test
