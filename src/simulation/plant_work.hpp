#pragma once
/// Intermediate results of one evaluation of a Plant, all legs side by side. Private to it.

#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

using numerics::Lanes;

/// As long as any plant's state, without allocation.
constexpr int most_states =
    2 * dynamics::most_velocities + 1 + 4 * model::leg_count + 1 + model::leg_count + 12 +
    4 * model::leg_count + 2 * model::leg_count * 2 * model::most_line_segments +
    2 * (StateLayout::arm_states + StateLayout::softening_states) * model::leg_count;
using StateOnStack = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_states, 1>;

/// The hydraulics of all legs: constants.
struct Plant::OilConstants {
  hydraulics::ServoAxisOf<Lanes> axis{};
  Lanes gimbal_compliance{}, gimbal_force{};
  Lanes stick_stiffness{}, stick_s{};    ///< of seals that stick, and where they are not bent
  bool gimbals{}, bristles{}, sticks{};  ///< any?
};

/// What the pistons do, and the oil in all legs with its valves. Not set to zero before it is
/// filled, which would take a twentieth of the time of a right-hand side; so is OilRates.
struct OilState {
  Lanes s, s_rate;
  Lanes p_cap, p_rod, spool, spool_rate, bristle;
  Lanes cap_port, rod_port;  // at the valve [Pa]
  const double* x;           // where the lines' flows stand
  Lanes command;
  double supply_pressure;
};

/// What follows from it: rates, flows, forces; signs as in LegOutput.
struct OilRates {
  Lanes p_cap, p_rod, spool_rate, bristle;
  Lanes cap_flow, rod_flow, supply_flow, return_flow;
  Lanes cap_inflow, rod_inflow;
  Lanes internal_leakage, external_leakage;
  Lanes piston, piston_rate;
  Lanes oil_force, friction_force, stop_force;
};

template <class Each>
void Plant::for_lines(const Each& each) const {
  if (layout_.line_states == 0) return;
  for (size_t k = 0; k < layout_.lines.size(); ++k) {
    const int first = layout_.lines[k];
    if (first < 0) continue;
    const auto& of_leg = lines_[k / 2];
    std::visit([&](const auto& line) { each(line, k, first); },
               k % 2 == 0 ? of_leg.cap : of_leg.rod);
  }
}

struct Plant::Work {
  dynamics::Motion motion;  ///< braces would set its legs, 6 kB, to zero
  OilState oil_state;
  OilRates oil;
  std::array<LegOutput, model::leg_count> legs{};  ///< without oil
  Vector6 base_acceleration{Vector6::Zero()};
  double supply_pressure{}, pump_flow{}, supply_flow{}, return_flow{};
};

}  // namespace hydrapod::simulation
