#pragma once
/// Outputs that are late against each other, as channels of a multiplexer, of two recorders or
/// behind unlike filters are. Private to the module.
///
/// A delay τ is a factor e^(−sτ) that no modal model of a few poles has. Where modes are real, the
/// ratio of two responses to one input is nearly real at every line, of either sign. So with
///
///     z_k = Σ_i (H_ai H_bi*)²/|H_ai H_bi|²,    C(τ) = |Σ_k z_k e^(2iω_kτ)|/Σ_k |z_k|
///
/// is 1 where τ is what a is later than b, and 0 far from it.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct AlignmentOptions {
  double clear{10.0};  ///< lines with |H|² > clear · variance, of both
  std::size_t least_lines{64};
  /// a is late where C(0) < aligned and C(τ) > late. Of structures with damping ratios of 1 % C is
  /// 0.88 to 0.97 at the delay and 0.3 at most elsewhere; of one with 20 % it is 0.7 at no clear τ.
  double aligned{0.6}, late{0.85};
  double longest{32.0}, step{0.125};  ///< |τ| in samples
  double least{0.5};                  ///< … less than that is not moved: it is no sample
};

/// The responses without delays of outputs against the earliest one, and a warning for each.
void align_outputs(FrequencyResponses& responses, const AlignmentOptions& options = {});

}  // namespace hydrapod::identification
