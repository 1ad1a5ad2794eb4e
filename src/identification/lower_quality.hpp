#pragma once
/// What is known of channels and of the excitation lowers the quality of modes. Private to the
/// module.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct LowerQualityOptions {
  /// Of the power of a mode's channels a share p is in samples that were cut off: `explained` ≤
  /// √(harmless/p). What is missing above the limit is less than what is left: a share of 1 % is an
  /// amplitude of a tenth at most.
  double harmless{0.01};
};

/// Of modes of `responses`, by their warnings.
void lower_quality(const FrequencyResponses& responses, Identification& result,
                   const LowerQualityOptions& options = {});

}  // namespace hydrapod::identification
