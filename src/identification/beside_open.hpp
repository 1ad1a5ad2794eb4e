#pragma once
/// Modes beside a pole that the responses show but do not determine. Private to the module.
///
/// A mode with much damping may stand above the noise while its own frequency or damping stays
/// open; then it is left out. What it explained goes to the modes that it overlaps, whose poles
/// move by more than the noise alone would move them. The model is fitted once more with such a
/// pole; the standard deviation of an overlapped mode becomes √(σ² + Δ²), Δ being the difference
/// between both fits: its interval holds the answers of both.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct BesideOpenOptions {
  /// Poles with |λ_a − λ_b| < overlap · (|Re λ_a| + |Re λ_b|) overlap: one half-power band reaches
  /// into the other.
  double overlap{1.0};
  /// Of several poles that were left out the first ones, at most; each is one more fit.
  std::size_t most{3};
};

/// Of the final model of `result`, before its modes are listed.
void widen_beside_open_poles(const IdentifyOptions& options, Identification& result,
                             const BesideOpenOptions& rules = {});

}  // namespace hydrapod::identification
