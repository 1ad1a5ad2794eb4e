#pragma once
/// Outputs that were measured one after the other, on a machine whose frequencies were others
/// meanwhile: by the mass of a sensor that went along, by temperature. Private to the module.
///
/// Each mode is then found twice, a little apart: once it moves these outputs, once the rest, and
/// the inputs drive both alike. A symmetric machine has two modes of each kind as well, which move
/// outputs of different directions; inputs in these directions do not drive both alike.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct SetUpOptions {
  double apart{0.05};  ///< |Δω| < apart · ω of a pair
  /// Σ |φ_i| |φ_j| < overlap of two shapes of length 1 that move different outputs.
  double overlap{0.3};
  /// All pairs divide the outputs alike: with d = |φ_j| − |φ_i| of the higher and the lower one,
  /// Σ d_p d_q > agree · Σ |d_p d_q|.
  double agree{0.8};
  double alike{0.9};  ///< MAC of participations > alike, where there are several inputs
  std::size_t fewest_pairs{2};
  double least_share{0.5};  ///< of all modes that stand in pairs
  Eigen::Index fewest_outputs{3};
  double quality{0.3};               ///< at most
  double quality_of_one_input{0.5};  ///< which does not tell a symmetric machine
};

/// Names the pairs, and lowers the quality of all modes.
void warn_of_set_ups(Identification& result, const SetUpOptions& options = {});

}  // namespace hydrapod::identification
