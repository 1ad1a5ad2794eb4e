#pragma once
/// Machines whose loop is near the gain at which it begins to grow. Shared by the short and the
/// long test.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tuple>

#include "hydrapod/simulation/closed_loop.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation {

struct GainLimit {
  const char* machine;
  double gain;  ///< at which the loop with compensation = "load" begins to grow [1/s]
};

/// Limit, compensation, share of the limit.
using NearGainLimit = std::tuple<GainLimit, const char*, double>;

/// Both machines with all compensations.
inline auto near_gain_limits(double low, double middle, double high) {
  return testing::Combine(
      testing::Values(GainLimit{"zhang-jiang-2021", 33.98}, GainLimit{"heavy-platform", 16.195}),
      testing::Values("load", "asymmetry", "none"), testing::Values(low, middle, high));
}

inline model::Machine looped(const NearGainLimit& at) {
  const auto& [limit, compensation, share] = at;
  auto overrides = smooth;
  overrides.push_back(fmt::format("controller.compensation=\"{}\"", compensation));
  overrides.push_back(fmt::format("controller.gain={}", share * limit.gain));
  return machine_of(limit.machine, overrides);
}

inline LoopOptions exact_until(double end) {
  return {.plant = {.friction = Friction::viscous},
          .integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12},
          .until = end,
          .ideal_sensors = true};
}

/// A pulse of 20 ms.
inline signals::Trajectory kick_of(const Vector6& size) {
  return {.times = {0.0, 0.01, 0.02}, .points = {Vector6::Zero(), size, Vector6::Zero()}};
}

}  // namespace hydrapod::simulation
