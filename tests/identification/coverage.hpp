#pragma once
/// How often the 95 % intervals of identified modes hold the truth. Shared by the short and the
/// long test.

#include <gtest/gtest.h>

#include <cmath>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct Coverage {
  int runs{}, all_found{};
  double frequency{}, damping{};  ///< share of intervals that hold the truth
  /// Mean square of errors over their deviations, of frequencies and dampings together: 1 where
  /// intervals are neither too narrow nor too wide.
  double square{};
};

/// A chain of three masses sampled 14 times faster than its highest mode (the modal model is one in
/// continuous time, and what sampling folds back must stay below the noise), its records with noise
/// of `noise` times the outputs' RMS.
Coverage coverage_of(int seeds, double noise, double damping_ratio);

}  // namespace hydrapod::identification
