#pragma once
/// Intermediate results of one evaluation of a Plant. Private to it.

#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

struct Plant::Work {
  dynamics::Motion motion{};
  std::array<LegOutput, model::leg_count> legs{};
  Vector6 base_acceleration{Vector6::Zero()};
  double supply_pressure{}, pump_flow{}, supply_flow{}, return_flow{};
};

}  // namespace hydrapod::simulation
