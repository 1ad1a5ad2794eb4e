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
  /// In a loop that rings for longer than a block `explained` ≤ ringing, of all modes: its other
  /// poles come out as modes of the machine.
  double ringing{0.3};
  /// Of a sweep that blocks cut into pieces `explained` ≤ cut_sweep: damping ratios from two to
  /// four blocks were wrong by up to 17 %, with intervals of 2 %.
  double cut_sweep{0.3};
  /// Of outputs alone through which a vibration passes `explained` ≤ run_up: the ends of its way
  /// came out as modes with a quality up to 1.
  double run_up{0.3};
};

/// Of modes of `responses`, by their warnings.
void lower_quality(const FrequencyResponses& responses, Identification& result,
                   const LowerQualityOptions& options = {});

}  // namespace hydrapod::identification
