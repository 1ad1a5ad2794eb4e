#pragma once
/// From a machine on the rig to modes, judged by the exact poles of its mechanics and hydraulics.
/// Shared by the short and the long test.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"
#include "support/rig_record.hpp"

namespace hydrapod::identification {

struct ExactPole {
  double frequency{}, damping{};  ///< [Hz], ζ
  double platform{};              ///< the platform's share of it
};

/// What can be called a mode, from the valves on.
std::vector<ExactPole> exact_poles(const model::Machine& machine,
                                   const test::RigExperiment& experiment);

struct Tolerance {
  double least_share{};  ///< of the platform in poles that must be found
  double frequency{3e-3}, damping{0.1};
};

/// Every pole that the platform takes part in is found, once each; nothing else is.
void expect_found(const Identification& found, const std::vector<ExactPole>& exact,
                  const Tolerance& tolerance);

}  // namespace hydrapod::identification
