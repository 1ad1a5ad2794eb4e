#pragma once
/// Two things side by side: pairs of modes and tests of their differences. Private to the module.
///
/// A difference d of two numbers with the standard deviation σ, the root of the sum of the
/// variances of the measured ones, is tested with z = d/σ, two-sided. All tests of one comparison
/// share the level: Holm's step-down method (Holm, Scand. J. Statist. 6 (1979) 65) rejects the i-th
/// smallest p of m where p ≤ level/(m − i + 1) and so for all smaller ones. Then the probability
/// that any difference is called significant where none is there is at most the level.

#include <optional>
#include <vector>

#include "hydrapod/observation/pairing.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::tasks {

/// Responses as they were estimated, where a machine can be set beside them.
struct MeasuredResponses {
  data::FrequencyResponses responses{};
  std::optional<spatial::Vector3> p_PQ{};  ///< the point that was measured [m]; none: not known
};

struct Side {
  report::ComparedThing thing{};
  bool calculated{};
  data::ModalResults modal{};  ///< outputs, poles and shapes; calculated ones against the ground
  std::vector<observation::Vector6c> base{};            ///< calculated motions against the base
  std::optional<observation::ComparisonFrame> frame{};  ///< the machine, where it is known
  std::optional<observation::Observed> observed{};      ///< what a measurement is of
  std::optional<MeasuredResponses> responses{};
};

/// Of ω [rad/s]: that of noise, and as for targets (observation/targets.hpp) what a shape whose
/// parts are out of phase and the spacing of lines leave open.
double frequency_deviation(const data::ModalResult& mode, double line_spacing);

report::ThingComparison compare_sides(const Side& first, const Side& second, double level);

}  // namespace hydrapod::tasks
