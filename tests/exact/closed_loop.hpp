#pragma once
/// Records of a system inside a loop: y = P u + v, u = r − k y, v the noise in the loop.

#include "exact/modal_system.hpp"

namespace hydrapod::test {

struct LoopExperiment {
  double gain{};   ///< k
  double noise{};  ///< RMS of v
  int samples{};
  double sample_rate{100.0};
  std::uint64_t seed{1};
  /// r is white, or three times averaged over so many samples: then it has gaps in its spectrum.
  int smoothed_over{1};
};

/// Of a system with as many outputs as inputs, p. Channels: p excitations r (u1 …), p responses y
/// (y1 …), p drives u (d1 …).
data::Record closed_loop_record(const ModalSystem& system, const LoopExperiment& experiment);

}  // namespace hydrapod::test
